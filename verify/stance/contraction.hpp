/// Contracting linear maps of boxes: what proves that there is one solution, and encloses it (docs/stance.md §3).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "verify/analysis/interval_matrix.hpp"

namespace verisq::stance {

using IntervalMatrix = Eigen::Matrix<verify::Interval, Eigen::Dynamic, Eigen::Dynamic>;
using IntervalVector = Eigen::Matrix<verify::Interval, Eigen::Dynamic, 1>;

/// Of the number of largest magnitude, from above.
[[nodiscard]] double magnitude(const verify::Interval& a);

[[nodiscard]] IntervalVector product(const Eigen::MatrixXd& m, const IntervalVector& v);
[[nodiscard]] IntervalVector product(const IntervalMatrix& m, const IntervalVector& v);
[[nodiscard]] IntervalMatrix product(const Eigen::MatrixXd& m, const IntervalMatrix& n);

[[nodiscard]] bool in_interior(const IntervalVector& inner, const IntervalVector& outer);

/// Weights w > 0 and a factor q < 1.
struct WeightedContraction {
  Eigen::VectorXd weights;
  double factor;
};

/// Proven: sizes w <= q diagonal w, component by component. Nothing where no such w is found, as where there is none.
/// Preconditions: sizes >= 0, diagonal > 0.
[[nodiscard]] std::optional<WeightedContraction> weighted_contraction(const Eigen::MatrixXd& sizes,
                                                                      const Eigen::VectorXd& diagonal);

/// Symmetric about 0, and so much wider than `errors` that a contraction shows.
[[nodiscard]] IntervalVector inflated(const IntervalVector& errors);

/// Contains the errors e that satisfy e = z + C e for some z and C within the intervals. K(E) = z + C E contains every
/// such e of E. If K(E) lies in the interior of E, which is symmetric, then |C| is a contraction in the norm scaled by
/// E's radii: there is exactly one e for each z and C, and it lies in E, in K(E), in K(K(E)) and so on (Rump 1983).
/// Nothing where no such E is found.
[[nodiscard]] std::optional<IntervalVector> fixed_points(const IntervalVector& z, const IntervalMatrix& c);

}  // namespace verisq::stance
