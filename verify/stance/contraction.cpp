/// Krawczyk's iteration with epsilon-inflation, and products that leave out zeros.
#include "verify/stance/contraction.hpp"

#include <Eigen/LU>
#include <cmath>

namespace verisq::stance {
namespace {

using verify::Interval;

bool is_zero(double a) {
  return a == 0.0;
}

bool is_zero(const Interval& a) {
  return is_zero(a.lower()) && is_zero(a.upper());
}

/// m v, leaving out the zeros of trees: most of a product's time.
template <class Matrix>
IntervalVector product_with_zeros(const Matrix& m, const IntervalVector& v) {
  IntervalVector result = IntervalVector::Zero(m.rows());
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    if (is_zero(v[j])) continue;
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      if (!is_zero(m(i, j))) result[i] += Interval(m(i, j)) * v[j];
    }
  }
  return result;
}

}  // namespace

double magnitude(const Interval& a) {
  return abs(a).upper();
}

IntervalVector product(const Eigen::MatrixXd& m, const IntervalVector& v) {
  return product_with_zeros(m, v);
}

IntervalVector product(const IntervalMatrix& m, const IntervalVector& v) {
  return product_with_zeros(m, v);
}

IntervalMatrix product(const Eigen::MatrixXd& m, const IntervalMatrix& n) {
  IntervalMatrix result(m.rows(), n.cols());
  for (Eigen::Index j = 0; j < n.cols(); ++j) result.col(j) = product(m, IntervalVector(n.col(j)));
  return result;
}

bool in_interior(const IntervalVector& inner, const IntervalVector& outer) {
  for (Eigen::Index i = 0; i < inner.size(); ++i) {
    if (!(inner[i].lower() > outer[i].lower() && inner[i].upper() < outer[i].upper())) return false;
  }
  return true;
}

std::optional<WeightedContraction> weighted_contraction(const Eigen::MatrixXd& sizes, const Eigen::VectorXd& diagonal) {
  // diagonal - sizes is an M-matrix where there are such weights, and its inverse positive: any guess is checked below.
  const Eigen::MatrixXd comparison = Eigen::MatrixXd(diagonal.asDiagonal()) - sizes;
  WeightedContraction result{comparison.partialPivLu().solve(Eigen::VectorXd::Ones(sizes.rows())), 0.0};
  const Eigen::VectorXd& weights = result.weights;
  if (!weights.allFinite() || !(weights.minCoeff() > 0.0)) return std::nullopt;
  for (Eigen::Index i = 0; i < sizes.rows(); ++i) {
    Interval reached(0);
    for (Eigen::Index j = 0; j < sizes.cols(); ++j) reached += Interval(sizes(i, j)) * Interval(weights[j]);
    const Interval share = reached / (Interval(diagonal[i]) * Interval(weights[i]));
    if (!(share.upper() < 1.0)) return std::nullopt;
    result.factor = std::fmax(result.factor, share.upper());
  }
  return result;
}

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

}  // namespace verisq::stance
