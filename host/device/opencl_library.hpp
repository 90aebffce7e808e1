/// The OpenCL library of the machine, opened at the first OpenCL call: the program starts, and proves, without one.
#pragma once

#include <string>

namespace verisq::device {

/// Why there is no OpenCL library, in the loader's words; empty when there is one. Opens it.
[[nodiscard]] std::string missing_opencl_library();

/// From here on `hook` is called before each OpenCL context is made. By then drivers have taken signals for themselves.
void before_each_context(void (*hook)());

}  // namespace verisq::device
