/// The OpenCL library of the machine, opened at the first OpenCL call: the program starts, and proves, without one.
#pragma once

#include <string>

namespace verisq::device {

/// Why there is no OpenCL library, in the loader's words; empty when there is one. Opens it.
[[nodiscard]] std::string missing_opencl_library();

}  // namespace verisq::device
