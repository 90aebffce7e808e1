/// Rump's product of interval matrices, with the rounding errors of dot products bounded beforehand.
#include "verify/stance/midpoint_radius.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace verisq::stance {
namespace {

using verify::Interval;

constexpr double unit_roundoff = 0x1p-53;

/// Rounded up: at least the exact sum of two numbers whose rounded sum is `sum`.
double above(double sum) {
  return std::nextafter(sum, std::numeric_limits<double>::infinity());
}

}  // namespace

MidpointRadius::MidpointRadius(const Eigen::MatrixXd& exact)
    : midpoint(exact), radius(Eigen::MatrixXd::Zero(exact.rows(), exact.cols())) {}

MidpointRadius::MidpointRadius(const IntervalMatrix& intervals)
    : midpoint(intervals.rows(), intervals.cols()), radius(intervals.rows(), intervals.cols()) {
  for (Eigen::Index i = 0; i < intervals.rows(); ++i) {
    for (Eigen::Index j = 0; j < intervals.cols(); ++j) {
      const Interval& a = intervals(i, j);
      const bool thin = a.lower() == a.upper();  // halves of the least numbers are rounded
      const double middle = thin ? a.lower() : 0.5 * a.lower() + 0.5 * a.upper();
      midpoint(i, j) = middle;
      radius(i, j) = thin ? 0.0 : above(std::fmax(a.upper() - middle, middle - a.lower()));
    }
  }
}

MidpointRadius::MidpointRadius(Eigen::MatrixXd midpoint_of_all, Eigen::MatrixXd radius_of_all)
    : midpoint(std::move(midpoint_of_all)), radius(std::move(radius_of_all)) {}

IntervalMatrix MidpointRadius::intervals() const {
  IntervalMatrix result(midpoint.rows(), midpoint.cols());
  for (Eigen::Index i = 0; i < midpoint.rows(); ++i) {
    for (Eigen::Index j = 0; j < midpoint.cols(); ++j)
      result(i, j) = Interval(midpoint(i, j)) + Interval(radius(i, j)) * Interval(-1.0, 1.0);
  }
  return result;
}

/// For |A - a| <= r, |B - b| <= s: |A B - fl(a b)| <= |a b - fl(a b)| + |a| s + r (|b| + s).
///
/// A dot product of n numbers, in any order, with or without fused operations, differs from the exact one by at most
/// g = n u/(1 - n u) times that of the magnitudes, u = 2^-53, and n 2^-1074 where products underflow (Higham, Accuracy
/// and Stability of Numerical Algorithms, section 3.1). Let P be any rounded product of nonnegative matrices here: the
/// exact one is at most P/(1 - g) + n 2^-1074/(1 - g), which is below (1 + 2 g) P + n 2^-1073 for g <= 1/2. The
/// magnitudes' product, times g, and the two products above sum to the radius, each rounded a few times more: (1 + 4 g)
/// on all of it covers the factor (1 + 2 g) and up to ten further roundings, for n >= 8, for which g >= 8 u.
MidpointRadius operator*(const MidpointRadius& a, const MidpointRadius& b) {
  const auto n = static_cast<double>(std::max<Eigen::Index>(a.midpoint.cols(), 8));
  if (!(n <= 0x1p40)) throw std::domain_error("interval matrices: too large");
  const double g = above(n * unit_roundoff / (1.0 - n * unit_roundoff)) * (1.0 + 0x1p-20);
  const double underflow = n * 0x1p-1070;
  const Eigen::MatrixXd magnitude_a = a.midpoint.cwiseAbs();
  const Eigen::MatrixXd magnitude_b = b.midpoint.cwiseAbs();
  const Eigen::MatrixXd reach_b = (magnitude_b + b.radius).unaryExpr(&above);
  Eigen::MatrixXd radius = g * (magnitude_a * magnitude_b) + magnitude_a * b.radius + a.radius * reach_b;
  radius = (((1.0 + 4.0 * g) * radius).array() + underflow).matrix().unaryExpr(&above);
  Eigen::MatrixXd midpoint = a.midpoint * b.midpoint;
  if (!midpoint.allFinite() || !radius.allFinite()) throw std::domain_error("interval matrices: beyond binary64");
  return {std::move(midpoint), std::move(radius)};
}

}  // namespace verisq::stance
