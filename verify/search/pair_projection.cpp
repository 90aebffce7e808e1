/// This file implements pair_projection.hpp.
#include "verify/search/pair_projection.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr int kMostEllipsoids =
    600;                         // each shrinks the volume by exp(-1/8) at least: 1e-9 of the size in each direction
constexpr int kExtraSteps = 40;  // after the first common point, for one that is not too close to a surface
constexpr double kDeep = 0.95;   // a gauge that leaves room for every rounding

/// g(x) and its gradient.
struct Slope {
  double gauge;
  Eigen::Vector3d gradient;
};

class GaugeSlope {
 public:
  explicit GaugeSlope(const Superquadric& solid) : boundary_(solid), tapered_(is_tapered(solid)) {}

  [[nodiscard]] Slope operator()(const Eigen::Vector3d& x) const {
    const Boundary<double>::Vector octant{std::fabs(x[0]), std::fabs(x[1]), tapered_ ? x[2] : std::fabs(x[2])};
    const double gauge = boundary_.gauge(octant);
    if (!(gauge > 0.0)) return {gauge, Eigen::Vector3d::UnitX()};
    const auto n = boundary_.normal(octant);
    const Eigen::Vector3d normal(std::copysign(n[0], x[0]), std::copysign(n[1], x[1]),
                                 tapered_ ? n[2] : std::copysign(n[2], x[2]));
    // The gradient of a gauge has gradient·x = g(x).
    return {gauge, normal * (gauge / normal.dot(x))};
  }

 private:
  Boundary<double> boundary_;
  bool tapered_;
};

/// An ellipsoid with axes along those of the frame.
struct Ellipsoid {
  Eigen::Vector3d centre;
  Eigen::Vector3d squared_semi_axes;
};

/// Through the corners of a box that contains the solid. A taper makes no section larger than 1 + |k| times the middle
/// one, and moves the middle to k a3 from the origin.
Ellipsoid ellipsoid_about(const Superquadric& solid) {
  const auto k = taper_coefficient<double>(solid.taper);
  const auto& [x, y, z] = solid.semi_axes;
  const double widest = 1.0 + std::fabs(k);
  return {{0.0, 0.0, k * z}, {3.0 * std::pow(x * widest, 2), 3.0 * std::pow(y * widest, 2), 3.0 * std::pow(z, 2)}};
}

/// The slope of one solid, in the frame where it is placed.
class PlacedSlope {
 public:
  explicit PlacedSlope(const PlacedSuperquadric& placed)
      : slope_(placed.solid), rotation_(placed.rotation), offset_(placed.offset) {}

  [[nodiscard]] Slope operator()(const Eigen::Vector3d& x) const {
    Slope slope = slope_(rotation_.transpose() * (x - offset_));
    slope.gradient = rotation_ * slope.gradient;
    return slope;
  }

 private:
  GaugeSlope slope_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d offset_;
};

/// The first of the slopes with the largest gauge.
Slope worst(const std::vector<PlacedSlope>& slopes, const Eigen::Vector3d& x) {
  Slope worst = slopes[0](x);
  for (std::size_t i = 1; i < slopes.size(); ++i) {
    const Slope slope = slopes[i](x);
    if (slope.gauge > worst.gauge) worst = slope;
  }
  return worst;
}

}  // namespace

std::optional<Eigen::Vector3d> common_point(std::span<const PlacedSuperquadric> solids) {
  const std::vector<PlacedSlope> slopes(solids.begin(), solids.end());
  const PlacedSuperquadric& first = solids[0];
  const Ellipsoid about_first = ellipsoid_about(first.solid);
  Eigen::Vector3d x = first.rotation * about_first.centre + first.offset;
  Eigen::Matrix3d shape = first.rotation * about_first.squared_semi_axes.asDiagonal() * first.rotation.transpose();
  std::optional<Eigen::Vector3d> best;
  double least = 1.0;
  for (int step = 0, extra = 0; step < kMostEllipsoids && extra < kExtraSteps; ++step) {
    const Slope worse = worst(slopes, x);
    if (worse.gauge < least) {
      least = worse.gauge;
      best = x;
    }
    if (worse.gauge <= kDeep) break;
    if (best) ++extra;
    const Eigen::Vector3d image = shape * worse.gradient;
    const double reach = std::sqrt(worse.gradient.dot(image));
    const double depth = (worse.gauge - least) / reach;
    if (!(depth < 1.0) || !std::isfinite(depth)) break;
    const Eigen::Vector3d axis = image / reach;
    x -= (1.0 + 3.0 * depth) / 4.0 * axis;
    shape = 9.0 / 8.0 * (1.0 - depth * depth) *
            (shape - (1.0 + 3.0 * depth) / (2.0 * (1.0 + depth)) * axis * axis.transpose());
  }
  return best;
}

std::optional<Eigen::Vector3d> common_point(const Superquadric& a, const Superquadric& b,
                                            const Eigen::Matrix3d& rotation, const Eigen::Vector3d& offset) {
  return common_point(std::array<PlacedSuperquadric, 2>{
      {{a, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()}, {b, rotation, offset}}});
}

namespace {

using Eigen::Array3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSmallest = std::numeric_limits<double>::min();
/// A margin of log g: below it, rounding hardly distinguishes a point from the surface.
constexpr double kSurfaceMargin = 1e-13;
/// Keeps p finite; the logarithms of such solids have no digits left, and Newton's method does not converge.
constexpr double kSmallestExponent = 1e-9;
/// A lower limit of derivatives, which vanish for p = 1.
constexpr double kSmallestDerivative = 1e-12;
/// A coordinate whose inverse is finite, and and that hardly changes other numbers.
constexpr double kSmallestCoordinate = 1e-150;
/// Damping: no logarithm rises by more in a step, and r and λ fall no faster.
constexpr double kLargestStep = 8.0;
/// The next error is about the square of the last step.
constexpr double kConvergedStep = 1e-8;
constexpr int kMostNewtonSteps = 32;

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
  Array3d shares;        ///< shares of the terms with λ
  Array3d inverses;      ///< inverses of the derivatives of the coordinates' equations by their own unknowns
  double section_x;      ///< derivative of ln r by the residual of x
  double section_y;      ///< and derivative by the residual of y
  double section_share;  ///< derivative of ln r by ln λ but for the sign
  double surface_r;      ///< derivative of ln g by ln r
  double surface_z;      ///< and derivative by the residual of z
  double by_r, by_lambda;
  double inverse_determinant;
  double section_residual, surface_residual;
};

struct PairProjection::Step {
  LogUnknowns unknowns;
  Array3d odds;  ///< change of the logarithm of each share's odds
};

/// Logarithms of |q| in units of the semi-axes. A point inside, or too close to the surface, is moved outward on its
/// ray.
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
  // If p is near 1, a coordinate that the normal crowds out lies of the order 1 / (p - 1) below the others.
  const Array3d lowest = -kLargestStep * (p_ - 1.0).max(1e-3).min(1.0).inverse();
  Equations e;
  Step step;
  bool converged = false;
  for (int i = 0; i < kMostNewtonSteps && !converged; ++i) {
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

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMostRounds = 64;
/// Converged when the vectors cancel but for this part of their length.
constexpr double kCancelled = 1e-11;
/// The depth to which every other step aims inside the solids, as a part of the distance: it does not stop at a
/// surface.
constexpr double kOvershoot = 0.25;
/// Values closer than this differ by rounding errors.
constexpr double kSameValue = 1e-13;
constexpr double kSmallestBlend = 1e-13;
/// The squared step, as a part of the value, up to which linear extrapolation helps.
constexpr double kShortStep = 1e-4;

/// Gradient and Hessian of half the square of (distance + depth) instead of the distance: the minima are the same.
struct NewtonTerms {
  Vector3d gradient;
  Matrix3d hessian;
};

NewtonTerms aimed_inside(const DistanceExpansion& at, double depth) {
  if (at.inside) return {Vector3d::Zero(), Matrix3d::Zero()};
  const double squared = 2.0 * at.value;
  const double part = squared > 0.0 ? depth / std::sqrt(squared) : 0.0;
  const Vector3d& v = at.gradient;
  const Matrix3d along = squared > 0.0 ? Matrix3d(v * v.transpose() / squared) : Matrix3d(Matrix3d::Zero());
  return {(1.0 + part) * v, (1.0 + part) * at.hessian - part * along};
}

class MidpointSearch {
 public:
  MidpointSearch(const Superquadric& a, const Superquadric& b, const Matrix3d& rotation, const Vector3d& offset)
      : a_(a), b_(b), rotation_(rotation), offset_(offset) {}

  [[nodiscard]] std::optional<MidpointContact> operator()(const Vector3d& start) const {
    Probe best = complete(start, a_(start), b_(in_b(start)));
    double blend = kSmallestBlend;
    for (int round = 0; round < kMostRounds; ++round) {
      if (best.a.inside && best.b.inside) return std::nullopt;
      if (imbalance(best) <= kCancelled * std::sqrt(best.value())) return contact(best);
      const bool aimed = round % 2 == 1;  // far from the minimum such a step may gain nothing
      const double distance = std::sqrt(2.0 * best.a.value) + std::sqrt(2.0 * best.b.value);
      const Vector3d m = best.point - step(best, aimed ? kOvershoot * distance : 0.0, blend);
      if (!m.allFinite()) return std::nullopt;
      const Probe next = complete(m, a_(m, best.a.closest), b_(in_b(m), best.b.closest));
      if (better(next, best)) {
        best = next;
        blend = std::max(0.1 * blend, kSmallestBlend);
      } else if (!aimed) {
        blend = std::min(std::max(4.0 * blend, 0.05), 1.0);
      }
    }
    return std::nullopt;
  }

 private:
  /// The expansions of both solids at one point, in A's frame.
  struct Probe {
    Vector3d point;
    DistanceExpansion a, b;

    [[nodiscard]] double value() const { return a.value + b.value; }
  };

  [[nodiscard]] Vector3d in_b(const Vector3d& x) const { return rotation_.transpose() * (x - offset_); }

  [[nodiscard]] Probe complete(const Vector3d& point, const DistanceExpansion& a, DistanceExpansion b) const {
    b.gradient = rotation_ * b.gradient;
    b.hessian = rotation_ * b.hessian * rotation_.transpose();
    return {point, a, b};
  }

  [[nodiscard]] static double imbalance(const Probe& p) { return (p.a.gradient + p.b.gradient).norm(); }

  [[nodiscard]] static bool better(const Probe& next, const Probe& best) {
    return next.value() < best.value() ||
           (next.value() <= best.value() * (1.0 + kSameValue) && imbalance(next) < imbalance(best));
  }

  /// The Hessian blended by `blend` towards the bound 2 of that of the sum.
  [[nodiscard]] static Vector3d step(const Probe& at, double depth, double blend) {
    const NewtonTerms a = aimed_inside(at.a, depth);
    const NewtonTerms b = aimed_inside(at.b, depth);
    const Matrix3d hessian = (1.0 - blend) * (a.hessian + b.hessian) + 2.0 * blend * Matrix3d::Identity();
    return hessian.inverse() * (a.gradient + b.gradient);
  }

  /// The vector is extrapolated by the remaining step. Each solid's own vector then stays one of its normals, which
  /// matters where the solid is nearly flat.
  [[nodiscard]] MidpointContact contact(const Probe& p) const {
    const Vector3d left = step(p, 0.0, kSmallestBlend);
    const bool usable = left.allFinite() && left.squaredNorm() <= kShortStep * p.value();
    const Vector3d plain = p.a.gradient - p.b.gradient;
    const Vector3d vector = usable ? Vector3d(plain - (p.a.hessian - p.b.hessian) * left) : plain;
    return {vector, p.point - p.a.gradient, in_b(p.point - p.b.gradient)};
  }

  PairProjection a_;
  PairProjection b_;
  Matrix3d rotation_;
  Vector3d offset_;
};

}  // namespace

std::optional<MidpointContact> midpoint_contact(const Superquadric& a, const Superquadric& b, const Matrix3d& rotation,
                                                const Vector3d& offset, const Vector3d& start) {
  return MidpointSearch(a, b, rotation, offset)(start);
}

}  // namespace verisq::verify
