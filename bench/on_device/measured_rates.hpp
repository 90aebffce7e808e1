/// How many queries of each kind a second a device answers through the library.
#pragma once

#include <string>
#include <vector>

namespace verisq::bench {

struct MeasuredRate {
  std::string what;          ///< "points_outside", "points_inside", "points_of_union", "triangles", "pairs", ...
  std::string object;        ///< of the paper's tables, or a file in examples
  double queries;            ///< of the run that was measured
  double per_second;         ///< by the clock: everything between two arrays in memory
  double per_device_second;  ///< while kernels ran
  double verified_fraction;  ///< by the device itself; 1 where there is nothing to prove
  double largest_width;      ///< of enclosures, in model units; 0 where there are none
};

/// `device` as MapOptions take it; `examples` is the folder of the example models.
[[nodiscard]] std::vector<MeasuredRate> measured_rates(const std::string& device, const std::string& examples);

}  // namespace verisq::bench
