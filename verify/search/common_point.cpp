/// The ellipsoid method with deep cuts (Groetschel, Lovasz, Schrijver) on the largest of the gauges, which is to be at
/// most 1.
#include "verify/search/common_point.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "verify/proof/superquadric.hpp"
#include "verify/proposals/boundary.hpp"

namespace verisq::verify {

namespace {

constexpr int kMostSteps = 600;  // each shrinks the volume by exp(-1/8) at least: 1e-9 of the size in each direction
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

/// Through the corners of a box that contains the solid: a taper makes no section larger than 1 + |k| times the middle
/// one, and moves the middle to k a3 from the origin.
Ellipsoid ellipsoid_about(const Superquadric& solid) {
  const auto k = taper_coefficient<double>(solid.taper);
  const auto& [x, y, z] = solid.semi_axes;
  const double widest = 1.0 + std::fabs(k);
  return {{0.0, 0.0, k * z}, {3.0 * std::pow(x * widest, 2), 3.0 * std::pow(y * widest, 2), 3.0 * std::pow(z, 2)}};
}

/// Of one solid, in the frame where it is placed.
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

/// The first of those with the largest gauge.
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
  for (int step = 0, extra = 0; step < kMostSteps && extra < kExtraSteps; ++step) {
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

}  // namespace verisq::verify
