/// OpenCL devices: which there are, and whether their arithmetic passed the self-test.
#pragma once

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

}  // namespace verisq
