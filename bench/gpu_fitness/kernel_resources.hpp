/// What compilers say that a kernel takes of a graphics processor, read from what they write.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace verisq::bench {

struct KernelResources {
  std::string kernel;
  unsigned registers = 0;      ///< of 32 bits, a work-item
  unsigned spilled_bytes = 0;  ///< that are stored where registers do not suffice, a work-item
  unsigned stack_bytes = 0;    ///< of a work-item, in memory; what is spilled is part of it
  double occupancy = 0.0;      ///< part of the threads that a processor could hold at a time
};

/// From clang's assembly for amdgcn, whose comments and metadata say all. `most_waves` of a SIMD make it full.
[[nodiscard]] std::vector<KernelResources> resources_in_amdgcn_assembly(std::string_view assembly, unsigned most_waves);

/// From what `ptxas -v` says, for processors with 65,536 registers and 64 warps.
[[nodiscard]] std::vector<KernelResources> resources_in_ptxas_report(std::string_view report);

/// Instructions of PTX on floating point that are not rounded correctly to nearest, or that `ptxas` may contract: none
/// may be there (docs/rounding.md §1).
[[nodiscard]] std::vector<std::string> unrounded_instructions(std::string_view ptx);

/// How many fused operations there are: as many as the source has, if nothing was contracted.
[[nodiscard]] std::size_t fused_operations(std::string_view ptx);

}  // namespace verisq::bench
