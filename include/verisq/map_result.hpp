/// One row of a map: an enclosure and who proved it.
#pragma once

#include <cstdint>
#include <string_view>
#include <verisq/enclosure.hpp>

namespace verisq {

enum class Status : std::uint8_t {
  device_verified = 0,  ///< at most the tolerance wide, proven by the device's kernels
  host_verified = 1,    ///< left open by the device, proven by the host
  wide = 2,             ///< valid, but wider than the tolerance
};

/// The word used in `.csv` and `.json`: "device-verified", "host-verified", "wide".
[[nodiscard]] constexpr std::string_view to_string(Status status) {
  switch (status) {
    case Status::device_verified: return "device-verified";
    case Status::host_verified: return "host-verified";
    case Status::wide: break;
  }
  return "wide";
}

struct MapResult {
  Enclosure distance;
  Status status;
};

}  // namespace verisq
