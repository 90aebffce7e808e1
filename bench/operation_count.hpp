/// The numerator of `peak_fraction`: how many FP64 operations one point costs the point_distance kernel.
#pragma once

#include <string_view>

namespace verisq::bench {

/// Counted along kernels/projection.clh and kernels/superquadric.clh: + - * / sqrt are one operation, fma two;
/// comparisons, min, max, selections and integer work are none. Change these when the kernels change.
namespace operations {
inline constexpr double a_newton_step = 400;  ///< 5 log-sum-exp of 57 (of which exp 30), 115 for the linear system
inline constexpr double start_and_end = 633;  ///< pose, logarithms, radial start, the normal from its shares
inline constexpr double proof = 704;          ///< both bounds, every operation rounded outward
}  // namespace operations

/// Steps that one point needs, on average over points_outside(); a vector runs as many as its slowest lane (of
/// eight: 4.9, 7.1, 7.0), which counts as loss, not as achievement.
[[nodiscard]] constexpr double mean_newton_steps(std::string_view object) {
  if (object == "capsule") return 4.26;
  if (object == "gem") return 6.01;
  return 6.03;  // soap
}

[[nodiscard]] constexpr double solver_operations(std::string_view object) {
  return operations::start_and_end + operations::a_newton_step * mean_newton_steps(object);
}

[[nodiscard]] constexpr double verified_operations(std::string_view object) {
  return solver_operations(object) + operations::proof;
}

}  // namespace verisq::bench
