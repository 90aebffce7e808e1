/// The compilers that tell without a graphics processor what kernels take there: clang with libclc, and ptxas.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bench/gpu_fitness/kernel_programs.hpp"
#include "bench/gpu_fitness/kernel_resources.hpp"

namespace verisq::bench {

/// Debian 12's, which PoCL brings along, and the library of OpenCL's functions that belongs to it.
inline constexpr std::string_view clang_program = "clang-15";
inline constexpr std::string_view libclc_package = "libclc-15";

struct GpuTarget {
  std::string name;  ///< of the processor: gfx90a, gfx1030, sm_90
  bool nvidia;
};

/// Instinct MI200 (waves of 64), Radeon RX 6000 (waves of 32), and Hopper.
[[nodiscard]] const std::vector<GpuTarget>& gpu_targets();

/// The release of ptxas on the path, "13.0" for instance; empty where there is none.
[[nodiscard]] std::string ptxas_release();

/// Compiles the program for the target. Throws std::runtime_error with the compiler's words where it does not compile
/// or a compiler is missing.
[[nodiscard]] std::vector<KernelResources> compiled(const KernelProgram& program, const GpuTarget& target);

/// What of the program's arithmetic would not be rounded as proofs assume: nothing, or one line a defect. Needs no
/// ptxas.
[[nodiscard]] std::vector<std::string> defects_of_arithmetic(const KernelProgram& program);

}  // namespace verisq::bench
