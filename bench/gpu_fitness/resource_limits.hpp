/// Committed limits of what kernels may take of a graphics processor, so that none takes more unnoticed and none less
/// without the gain being kept.
#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "bench/gpu_fitness/kernel_resources.hpp"

namespace verisq::bench {

/// A kernel compiled for a target.
struct MeasuredKernel {
  std::string target;
  KernelResources resources;
};

/// Lines `target,kernel,registers,spilled_bytes,stack_bytes`; those that begin with # say more. Throws
/// std::runtime_error with the line that is none of them.
[[nodiscard]] std::vector<MeasuredKernel> read_limits(std::istream& file);

void write_limits(std::ostream& file, std::span<const MeasuredKernel> kernels);

/// One line a kernel that takes more than its limit, has none, or stays so far below it that the limit is to be
/// lowered; and one a limit that no kernel of a measured target has.
[[nodiscard]] std::vector<std::string> contradictions(std::span<const MeasuredKernel> measured,
                                                      std::span<const MeasuredKernel> limits);

}  // namespace verisq::bench
