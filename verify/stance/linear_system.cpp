/// Krawczyk's operator with the inverse of the midpoint matrix, applied to each derivative before the deviation.
#include "verify/stance/linear_system.hpp"

#include <Eigen/LU>

#include "verify/stance/contraction.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;
using Variation = ParametricLinearSystem::Variation;

/// Near the middle; any number would be sound.
double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

Eigen::VectorXd widths(const IntervalVector& v) {
  return v.unaryExpr([](const Interval& a) { return a.upper() - a.lower(); });
}

Eigen::MatrixXd approximate_inverse(const IntervalMatrix& matrix) {
  return matrix.unaryExpr([](const Interval& a) { return middle(a); }).partialPivLu().inverse();
}

}  // namespace

// For the solution x + e and any R, R A(p) (x + e) = R b(p) is e = R (b(p) - A(p) x) + (I - R A(p)) e. By the mean
// value theorem, entry by entry, the residual b(p) - A(p) x and A(p) are their values at the centre and the sum over
// the parameters of derivative times deviation. R goes to each derivative before the deviation does: the entries of a
// derivative change together, and R cancels much of them.
std::optional<ParametricSolution> solve(const ParametricLinearSystem& system) {
  const Eigen::MatrixXd inverse = approximate_inverse(system.matrix);
  if (!inverse.allFinite() || !system.approximation.allFinite()) return std::nullopt;
  IntervalVector z = product(inverse, system.residual);
  IntervalMatrix c = IntervalMatrix::Identity(z.size(), z.size()) - product(inverse, system.matrix);
  std::vector<IntervalVector> slopes_of_z;
  std::vector<IntervalMatrix> changes_of_c;
  for (const Variation& by : system.variations) {
    slopes_of_z.push_back(product(inverse, by.residual));
    changes_of_c.emplace_back(product(inverse, by.matrix) * by.deviation);
    z += slopes_of_z.back() * by.deviation;
    c -= changes_of_c.back();
  }
  const std::optional<IntervalVector> errors = fixed_points(z, c);
  if (!errors) return std::nullopt;

  ParametricSolution result{*errors, {}};
  for (Eigen::Index i = 0; i < errors->size(); ++i) result.solution[i] += Interval(system.approximation[i]);
  for (std::size_t k = 0; k < system.variations.size(); ++k) {
    result.overestimation.emplace_back(magnitude(system.variations[k].deviation) * widths(slopes_of_z[k]) +
                                       widths(product(changes_of_c[k], *errors)));
  }
  return result;
}

}  // namespace verisq::stance
