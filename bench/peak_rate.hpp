/// The denominator of `peak_fraction`: how many FP64 operations a second a device reaches with nothing but FMAs.
#pragma once

#include <string_view>

namespace verisq::bench {

/// Measures the OpenCL device of exactly this name; a fused multiply-add counts as two operations.
/// Throws std::runtime_error when there is no such device.
[[nodiscard]] double measured_peak_rate(std::string_view device_name);

}  // namespace verisq::bench
