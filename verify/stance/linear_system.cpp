/// Krawczyk's operator with the inverse of the midpoint matrix, applied to each derivative before the deviation.
#include "verify/stance/linear_system.hpp"

#include <Eigen/LU>
#include <cmath>

namespace verisq::stance {
namespace {

using verify::Interval;
using Variation = ParametricLinearSystem::Variation;

/// Near the middle; any number would be sound.
double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

double magnitude(const Interval& a) {
  return abs(a).upper();
}

bool is_zero(double a) {
  return a == 0.0;
}

bool is_zero(const Interval& a) {
  return is_zero(a.lower()) && is_zero(a.upper());
}

/// m v, leaving out the zeros of trees: most of a product's time.
template <class Matrix>
IntervalVector product(const Matrix& m, const IntervalVector& v) {
  IntervalVector result = IntervalVector::Zero(m.rows());
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    if (is_zero(v[j])) continue;
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      if (!is_zero(m(i, j))) result[i] += Interval(m(i, j)) * v[j];
    }
  }
  return result;
}

template <class Matrix>
IntervalMatrix matrix_product(const Matrix& m, const IntervalMatrix& n) {
  IntervalMatrix result(m.rows(), n.cols());
  for (Eigen::Index j = 0; j < n.cols(); ++j) result.col(j) = product(m, IntervalVector(n.col(j)));
  return result;
}

Eigen::VectorXd widths(const IntervalVector& v) {
  return v.unaryExpr([](const Interval& a) { return a.upper() - a.lower(); });
}

bool in_interior(const IntervalVector& inner, const IntervalVector& outer) {
  for (Eigen::Index i = 0; i < inner.size(); ++i) {
    if (!(inner[i].lower() > outer[i].lower() && inner[i].upper() < outer[i].upper())) return false;
  }
  return true;
}

/// Symmetric about 0, and so much wider than `errors` that a contraction shows.
IntervalVector inflated(const IntervalVector& errors) {
  constexpr double factor = 1.25;
  constexpr double least = 0x1p-1000;
  // An error of one component reaches others: the share of the largest keeps those from starting at nothing.
  constexpr double share_of_largest = 0x1p-40;
  double largest = 0.0;
  for (const Interval& error : errors) largest = std::fmax(largest, magnitude(error));
  IntervalVector wide(errors.size());
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    const double radius = factor * magnitude(errors[i]) + share_of_largest * largest + least;
    wide[i] = Interval(-radius, radius);
  }
  return wide;
}

/// Contains the errors e that satisfy e = z + C e for some z and C within the intervals. K(E) = z + C E contains every
/// such e of E. If K(E) lies in the interior of E, which is symmetric, then |C| is a contraction in the norm scaled by
/// E's radii: there is exactly one e for each z and C, and it lies in E, in K(E), in K(K(E)) and so on (Rump 1983).
std::optional<IntervalVector> fixed_points(const IntervalVector& z, const IntervalMatrix& c) {
  constexpr int most_inflations = 12;
  constexpr int refinements = 3;
  IntervalVector errors = z;
  for (int i = 0; i < most_inflations; ++i) {
    const IntervalVector box = inflated(errors);
    errors = z + product(c, box);
    if (!in_interior(errors, box)) continue;
    for (int k = 0; k < refinements; ++k) errors = z + product(c, errors);
    return errors;
  }
  return std::nullopt;
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
  IntervalMatrix c = IntervalMatrix::Identity(z.size(), z.size()) - matrix_product(inverse, system.matrix);
  std::vector<IntervalVector> slopes_of_z;
  std::vector<IntervalMatrix> changes_of_c;
  for (const Variation& by : system.variations) {
    slopes_of_z.push_back(product(inverse, by.residual));
    changes_of_c.emplace_back(matrix_product(inverse, by.matrix) * by.deviation);
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
