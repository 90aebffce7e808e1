/// Krawczyk's operator with the inverse of the midpoint matrix, applied to each derivative before the deviation.
#include "verify/stance/linear_system.hpp"

#include <Eigen/LU>
#include <utility>

#include "verify/stance/contraction.hpp"
#include "verify/stance/scalar.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;
using Variation = ParametricLinearSystem::Variation;

/// Near the middle; any number would be sound.
double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

Eigen::MatrixXd approximate_inverse(const IntervalMatrix& matrix) {
  return matrix.unaryExpr([](const Interval& a) { return middle(a); }).partialPivLu().inverse();
}

/// Precondition: one point lies in both.
IntervalVector intersection(const IntervalVector& a, const IntervalVector& b) {
  IntervalVector result(a.size());
  for (Eigen::Index i = 0; i < a.size(); ++i) result[i] = stance::intersection(a[i], b[i]);
  return result;
}

/// The system times R: for the solution x + e and any R, R A(p) (x + e) = R b(p) is e = z + C e with z = R (b(p) - A(p)
/// x) and C = I - R A(p). By the mean value theorem, entry by entry, both are their values at the centre and the sum
/// over the parameters of derivative times deviation. R goes to each derivative before the deviation does: the entries
/// of a derivative change together, and R cancels much of them.
struct Preconditioned {
  IntervalVector z;                      ///< at the centre
  IntervalMatrix c;                      ///< at the centre
  std::vector<IntervalVector> slopes;    ///< of z, by variation
  std::vector<IntervalMatrix> matrices;  ///< R times the derivative of A: minus the slope of C
};

std::optional<Preconditioned> preconditioned(const ParametricLinearSystem& system) {
  const Eigen::MatrixXd inverse = approximate_inverse(system.matrix);
  if (!inverse.allFinite() || !system.approximation.allFinite()) return std::nullopt;
  Preconditioned result;
  result.z = product(inverse, system.residual);
  result.c = IntervalMatrix::Identity(inverse.rows(), inverse.cols()) - product(inverse, system.matrix);
  for (const Variation& by : system.variations) {
    result.slopes.push_back(product(inverse, by.residual));
    result.matrices.push_back(product(inverse, by.matrix));
  }
  return result;
}

}  // namespace

std::optional<ParametricSolution> solve(const ParametricLinearSystem& system) {
  const std::optional<Preconditioned> at = preconditioned(system);
  if (!at) return std::nullopt;
  const std::size_t count = system.variations.size();
  IntervalVector z = at->z;
  IntervalMatrix c = at->c;
  for (std::size_t k = 0; k < count; ++k) {
    z += at->slopes[k] * system.variations[k].deviation;
    c -= at->matrices[k] * system.variations[k].deviation;
  }
  const std::optional<IntervalVector> errors = fixed_points(z, c);
  const std::optional<IntervalVector> errors_at_centre = fixed_points(at->z, at->c);
  if (!errors || !errors_at_centre) return std::nullopt;

  // The derivatives d of x + e = A^-1 b satisfy A d = b' - A' (x + e), where b' - A' x is the residual's derivative:
  // multiplied by R, d = R (b' - A' x) - R A' e + (I - R A) d.
  ParametricSolution result;
  IntervalVector by_mean_value = *errors_at_centre;
  for (std::size_t k = 0; k < count; ++k) {
    std::optional<IntervalVector> derivative = fixed_points(at->slopes[k] - product(at->matrices[k], *errors), c);
    if (!derivative) return std::nullopt;
    by_mean_value += *derivative * system.variations[k].deviation;
    result.derivatives.push_back(std::move(*derivative));
  }
  result.solution = intersection(*errors, by_mean_value);
  for (Eigen::Index i = 0; i < z.size(); ++i) result.solution[i] += Interval(system.approximation[i]);
  return result;
}

// A proof needs a spectral radius of |C| below 1. The trace of |C|^2 stands for its square: like the radius, it does
// not depend on the unknowns' units, and what C does not lead back to itself has no part in it.
std::vector<double> obstructions(const ParametricLinearSystem& system) {
  const std::optional<Preconditioned> at = preconditioned(system);
  std::vector<double> result(system.variations.size(), 0.0);
  for (std::size_t k = 0; at && k < result.size(); ++k) {
    const Interval& deviation = system.variations[k].deviation;
    const Eigen::MatrixXd change =
        at->matrices[k].unaryExpr([&](const Interval& a) { return magnitude(a * deviation); });
    result[k] = change.cwiseProduct(change.transpose()).sum();
  }
  return result;
}

}  // namespace verisq::stance
