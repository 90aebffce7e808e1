/// This file implements the compilation of kernels for their judges.
#include "tests/mutation/compiled_kernels.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {

CompiledKernels compiled(const device::Device& device, const std::string& sources, int width) {
  // Speed does not matter, and inlined kernels take twice as long to compile.
  const Mutant calls{"calls", "static __attribute__((always_inline))", "static __attribute__((noinline))"};
  cl::Program program(device.context, mutated(sources, calls));
  program.build({device.device}, (fmt::format("-cl-std=CL1.2 -DVECTOR_WIDTH={}", width) +
                                  (std::getenv("VQ_OPT") ? std::getenv("VQ_OPT") : ""))
                                     .c_str());
  CompiledKernels kernels{device, program};
  kernels.vector_width = width;
  return kernels;
}

}  // namespace verisq::mutation
