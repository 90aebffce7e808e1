/// Five log-sum-exp equations, solved with their derivatives at hand.
#include "verify/search/pair_projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Eigen::Array3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSmallest = std::numeric_limits<double>::min();
/// Of log g: below, rounding hardly tells a point from the surface.
constexpr double kSurfaceMargin = 1e-13;
/// Keeps p finite; the logarithms of such solids have no digits left, and Newton's method does not converge.
constexpr double kSmallestExponent = 1e-9;
/// They vanish for p = 1.
constexpr double kSmallestDerivative = 1e-12;
/// Its inverse is finite, and what it moves vanishes against other numbers.
constexpr double kSmallestCoordinate = 1e-150;
/// Damping: no logarithm rises by more in a step, and r and λ fall no faster.
constexpr double kLargestStep = 8.0;
/// The next error is about the square of the last step.
constexpr double kConvergedStep = 1e-8;
constexpr int kMostSteps = 32;

/// log(e^a + e^b) and the share of e^b in the sum.
struct LogSum {
  double value;
  double share;
};

LogSum log_sum(double a, double b) {
  const double smaller = std::exp(-std::fabs(a - b));
  const double larger_share = 1.0 / (1.0 + smaller);
  return {std::max(a, b) + std::log1p(smaller), b > a ? larger_share : smaller * larger_share};
}

double log_or_lowest(double x) {
  return std::log(std::max(x, kSmallest));
}

Array3d logs_or_lowest(const Array3d& x) {
  return {log_or_lowest(x[0]), log_or_lowest(x[1]), log_or_lowest(x[2])};
}

/// Squares of e^+-300 are normal numbers.
Array3d bounded_exp(const Array3d& x) {
  return {std::exp(std::clamp(x[0], -300.0, 300.0)), std::exp(std::clamp(x[1], -300.0, 300.0)),
          std::exp(std::clamp(x[2], -300.0, 300.0))};
}

}  // namespace

/// Residuals and derivatives at one set of unknowns, the coordinates eliminated.
struct PairProjection::Equations {
  Array3d values;        ///< logarithms of the left sides, in units of length
  Array3d shares;        ///< of the terms with λ
  Array3d inverses;      ///< of the derivatives of the coordinates' equations by their own unknowns
  double section_x;      ///< derivative of ln r by the residual of x
  double section_y;      ///< and by that of y
  double section_share;  ///< derivative of ln r by ln λ but for the sign
  double surface_r;      ///< derivative of ln g by ln r
  double surface_z;      ///< and by the residual of z
  double by_r, by_lambda;
  double inverse_determinant;
  double section_residual, surface_residual;
};

struct PairProjection::Step {
  LogUnknowns unknowns;
  Array3d odds;  ///< change of the logarithm of each share's odds
};

/// Of |q| in units of the semi-axes. A point inside, or too close to the surface, is moved outward on its ray.
struct PairProjection::OutsideLogarithms {
  Array3d log_x;
  bool inside;
};

PairProjection::PairProjection(const Superquadric& solid)
    : axes_(solid.semi_axes[0], solid.semi_axes[1], solid.semi_axes[2]),
      log_axes_(axes_.log()),
      p1_(2.0 / std::max(solid.exponents[0], kSmallestExponent)),
      p2_(2.0 / std::max(solid.exponents[1], kSmallestExponent)),
      p_(p2_, p2_, p1_) {}

double PairProjection::log_gauge(const Array3d& log_x) const {
  const double log_r = log_sum(p2_ * log_x[0], p2_ * log_x[1]).value / p2_;
  return log_sum(p1_ * log_r, p1_ * log_x[2]).value / p1_;
}

PairProjection::OutsideLogarithms PairProjection::outside_logarithms(const Vector3d& q) const {
  const Array3d log_x = logs_or_lowest(q.array().abs()) - log_axes_;
  const double gauge = log_gauge(log_x);
  const bool inside = gauge <= -kSurfaceMargin;
  const double wanted = inside ? 1.0 : std::max(gauge, kSurfaceMargin);
  return {log_x + (wanted - gauge), inside};
}

/// x = q / g(q), and λ by least squares of x + λ n = q with the gradient n of g^p1 / p1.
LogUnknowns PairProjection::radial_start(const Array3d& log_x) const {
  const double gauge = log_gauge(log_x);
  LogUnknowns u{log_x - gauge, 0.0, 0.0};
  u.r = log_sum(p2_ * u.coordinates[0], p2_ * u.coordinates[1]).value / p2_;
  const double in_section = (p1_ - p2_) * u.r;
  const Array3d normal = bounded_exp(Array3d(in_section, in_section, 0.0) + (p_ - 1.0) * u.coordinates - log_axes_);
  const Array3d boundary = bounded_exp(u.coordinates + log_axes_);
  // q - x = (g - 1) x
  u.lambda = log_or_lowest(std::expm1(std::min(gauge, 300.0))) + log_or_lowest((normal * boundary).sum()) -
             log_or_lowest(normal.square().sum());
  return u;
}

PairProjection::Equations PairProjection::equations_at(const LogUnknowns& u) const {
  Equations e;
  const double in_section = u.lambda + (p1_ - p2_) * u.r;
  const Array3d own = u.coordinates + log_axes_;
  const Array3d normal = Array3d(in_section, in_section, u.lambda) + (p_ - 1.0) * u.coordinates - log_axes_;
  for (int i = 0; i < 3; ++i) {
    const LogSum sum = log_sum(own[i], normal[i]);
    e.values[i] = sum.value;
    e.shares[i] = sum.share;
  }
  const LogSum section = log_sum(p2_ * u.coordinates[0], p2_ * u.coordinates[1]);
  const LogSum surface = log_sum(p1_ * u.r, p1_ * u.coordinates[2]);
  e.section_residual = section.value / p2_ - u.r;
  e.surface_residual = surface.value / p1_;
  e.inverses = (1.0 + e.shares * (p_ - 2.0)).max(kSmallestDerivative).inverse();
  e.section_x = (1.0 - section.share) * e.inverses[0];
  e.section_y = section.share * e.inverses[1];
  e.section_share = e.section_x * e.shares[0] + e.section_y * e.shares[1];
  e.surface_r = 1.0 - surface.share;
  e.surface_z = surface.share * e.inverses[2];
  e.by_r = 1.0 + (p1_ - p2_) * e.section_share;
  e.by_lambda = e.surface_z * e.shares[2];
  e.inverse_determinant = 1.0 / (e.by_r * e.by_lambda + e.section_share * e.surface_r);
  return e;
}

/// The change of the unknowns that makes up for residuals of the coordinates' equations, of r's and of the surface's.
PairProjection::Step PairProjection::solve(const Equations& e, const Array3d& of_coordinates, double of_section,
                                           double of_surface) const {
  const double first = of_section - (e.section_x * of_coordinates[0] + e.section_y * of_coordinates[1]);
  const double second = e.surface_z * of_coordinates[2] - of_surface;
  Step step;
  step.unknowns.r = (first * e.by_lambda + e.section_share * second) * e.inverse_determinant;
  step.unknowns.lambda = (e.surface_r * first - e.by_r * second) * e.inverse_determinant;
  const double coupled = step.unknowns.lambda + (p1_ - p2_) * step.unknowns.r;
  const Array3d multipliers(coupled, coupled, step.unknowns.lambda);
  step.unknowns.coordinates = -(of_coordinates + e.shares * multipliers) * e.inverses;
  step.odds = multipliers + (p_ - 2.0) * step.unknowns.coordinates;
  return step;
}

DistanceExpansion PairProjection::operator()(const Vector3d& q) const {
  const OutsideLogarithms at = outside_logarithms(q);
  return expand(q, at, radial_start(at.log_x));
}

DistanceExpansion PairProjection::operator()(const Vector3d& q, const LogUnknowns& start) const {
  return expand(q, outside_logarithms(q), start);
}

DistanceExpansion PairProjection::expand(const Vector3d& q, const OutsideLogarithms& at,
                                         const LogUnknowns& start) const {
  DistanceExpansion result{0.0, Vector3d::Zero(), Matrix3d::Zero(), at.inside, start};
  if (at.inside) return result;
  LogUnknowns& u = result.closest;
  const Array3d log_q = at.log_x + log_axes_;
  // Where p is near 1, a coordinate that the normal crowds out lies of the order 1 / (p - 1) below the others.
  const Array3d lowest = -kLargestStep * (p_ - 1.0).max(1e-3).min(1.0).inverse();
  Equations e;
  Step step;
  bool converged = false;
  for (int i = 0; i < kMostSteps && !converged; ++i) {
    e = equations_at(u);
    step = solve(e, e.values - log_q, e.section_residual, e.surface_residual);
    const double of_both = std::max(std::fabs(step.unknowns.r), std::fabs(step.unknowns.lambda));
    const double damping = std::min(1.0, kLargestStep / of_both);
    u.coordinates += (damping * step.unknowns.coordinates).max(lowest).min(kLargestStep);
    u.r += damping * step.unknowns.r;
    u.lambda += damping * step.unknowns.lambda;
    converged = std::max(of_both, step.unknowns.coordinates.abs().maxCoeff()) <= kConvergedStep;
  }
  // (share of the second term) q = λ n has relative accuracy also where the closest point is near q. The shares are
  // those before the last step; s' = s (1 - s) by the odds.
  const Array3d& s = e.shares;
  result.gradient = (s + s * (1.0 - s) * step.odds.max(-1e-3).min(1e-3)).matrix().cwiseProduct(q);
  result.value = converged ? result.gradient.squaredNorm() / 2.0 : infinity;
  const Array3d magnitudes = q.array().abs().max(kSmallestCoordinate);
  for (int j = 0; j < 3; ++j) {
    Array3d moved = Array3d::Zero();
    moved[j] = -1.0 / magnitudes[j];
    Array3d column = s * magnitudes * (1.0 - s) * solve(e, moved, 0.0, 0.0).odds;
    column[j] += s[j];
    for (int i = 0; i < 3; ++i)
      result.hessian(i, j) = std::signbit(q[i]) == std::signbit(q[j]) ? column[i] : -column[i];
  }
  return result;
}

}  // namespace verisq::verify
