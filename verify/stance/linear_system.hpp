/// Enclosures of the solutions of linear systems A(p) x = b(p) over a box of parameters p, and of their derivatives by
/// p, by Krawczyk's operator with an approximate inverse at the box's centre (docs/stance.md §3; for parametric systems
/// Rump 1994).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "verify/stance/contraction.hpp"

namespace verisq::stance {

/// A and the residual b - A x of one x, at a point c of the box, and how they change.
struct ParametricLinearSystem {
  /// By one of the parameters.
  struct Variation {
    verify::Interval deviation;  ///< contains p_k - c_k, and 0
    IntervalMatrix matrix;       ///< contains the partial derivatives of A at all points of the box
    IntervalVector residual;     ///< of the residual
  };
  Eigen::VectorXd approximation;  ///< x, near the solution at c; any x is sound
  IntervalMatrix matrix;
  IntervalVector residual;
  std::vector<Variation> variations;
};

struct ParametricSolution {
  /// Contains the solution for every p of the box; the overestimation is of second order in the box's widths.
  IntervalVector solution;
  /// By variation: contains the solution's partial derivatives by that parameter at all points of the box.
  std::vector<IntervalVector> derivatives;
};

/// Nothing where it is not proven that A(p) is regular for every p. Precondition: the box is convex and contains c.
/// Throws std::domain_error for numbers beyond binary64.
[[nodiscard]] std::optional<ParametricSolution> solve(const ParametricLinearSystem& system);

/// By variation: how much it keeps `solve` from a proof. To compare with each other.
[[nodiscard]] std::vector<double> obstructions(const ParametricLinearSystem& system);

}  // namespace verisq::stance
