/// What a map says of all of its rows.
#pragma once

#include <cstdint>
#include <string>

namespace verisq {

struct MapSummary {
  std::string device;        ///< name of the device used, or "host"
  std::uint64_t points = 0;  ///< rows delivered to the sink
  std::uint64_t device_verified = 0;
  std::uint64_t host_verified = 0;
  std::uint64_t wide = 0;
  std::uint64_t wide_inside = 0;  ///< of those, rows with a lower end below 0
  double minimum_lo = 0.0;        ///< enclosure of the smallest distance of all rows
  double minimum_hi = 0.0;
  double largest_width = 0.0;
  double device_seconds = 0.0;  ///< during which kernels ran, those of two chunks at once counted once
  double host_seconds = 0.0;    ///< wall time of the host's proofs
  bool interrupted = false;
  bool out_of_time = false;  ///< the limit came while rows were wide
  std::string notice;        ///< why a device was passed over; empty when nothing to say
};

}  // namespace verisq
