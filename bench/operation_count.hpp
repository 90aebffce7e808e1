/// The numerator of `peak_fraction`: how many FP64 operations one point costs the point_distance kernel.
#pragma once

#include <string_view>

namespace verisq::bench {

/// Counted along kernels/proposal.clh and superquadric.clh: + - * / sqrt are one operation, fma two; those
/// of binary32 count half, because a register holds twice as many; comparisons, min, max, selections and integer work
/// are none. Change these when the kernels change.
namespace operations {
inline constexpr double a_newton_step = 150;  ///< in binary32: 5 log-sum-exp of 34 (of which exp 15), the linear system
/// Pose 60, start in binary32 105, the contact 358 (11 exp of 30), its residuals 38, its move by the last step 122.
inline constexpr double start_and_end = 683;
inline constexpr double proof = 175;  ///< of both bounds what the contact does not tell: lengths, products, a division
}  // namespace operations

/// Steps that one point needs, on average over points_outside(); a vector runs as many as its slowest lane (of sixteen:
/// 3.0, 5.9, 4.5), which counts as loss, not as achievement.
[[nodiscard]] constexpr double mean_newton_steps(std::string_view object) {
  if (object == "capsule") return 2.96;
  if (object == "gem") return 4.34;
  return 3.19;  // soap
}

[[nodiscard]] constexpr double solver_operations(std::string_view object) {
  return operations::start_and_end + operations::a_newton_step * mean_newton_steps(object);
}

[[nodiscard]] constexpr double verified_operations(std::string_view object) {
  return solver_operations(object) + operations::proof;
}

}  // namespace verisq::bench
