/// OpenCL devices: which there are, and whether their arithmetic passed the self-test.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace verisq {

/// One row of `verisq devices`.
struct DeviceReport {
  std::size_t index;  ///< what `--device` accepts
  std::string name;
  std::string platform;
  std::string driver;
  int vector_width;     ///< points a work-item: 16, 8, 4 or 1
  bool passed;          ///< self-test
  std::string failure;  ///< the failing operation and operands; empty when passed
};

/// Runs (or takes from the cache) the self-test of every device. Empty when there is no OpenCL device.
[[nodiscard]] std::vector<DeviceReport> test_devices();

/// How tight one directed operation is: the largest distance of a bound from the tightest binary64 bound, in units of
/// the exact value's last place (at least 2^-1022, the slack of the kernels near zero). NaN where nothing was measured.
struct FunctionAccuracy {
  std::string function;
  double down, up;  ///< lower and upper bounds
  std::uint64_t samples;
  std::uint64_t unsound;  ///< bounds that lie inside the exact value, or none where there must be one: 0, or a defect
};

/// Every directed operation and interval operation of the host's trusted core on `samples` adversarial and random
/// operands each, the same at every call, against MPFR. `progress` is called with the finished part in [0, 1].
[[nodiscard]] std::vector<FunctionAccuracy> host_accuracy(std::size_t samples,
                                                          const std::function<void(double)>& progress = {});

/// The same of the kernels on the device of this index in `test_devices`. Throws Error(input) when there is none or it
/// failed its self-test, Error(failure) for errors of the device. Rows are those of `host_accuracy`, in its order.
[[nodiscard]] std::vector<FunctionAccuracy> device_accuracy(std::size_t index, std::size_t samples,
                                                            const std::function<void(double)>& progress = {});

}  // namespace verisq
