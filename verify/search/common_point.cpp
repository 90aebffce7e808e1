/// The ellipsoid method with deep cuts (Groetschel, Lovasz, Schrijver) on max(g_A, g_B) <= 1.
#include "verify/search/common_point.hpp"

#include <cmath>

#include "verify/proof/boundary.hpp"

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
  explicit GaugeSlope(const Superquadric& solid) : boundary_(solid) {}

  [[nodiscard]] Slope operator()(const Eigen::Vector3d& x) const {
    const Boundary<double>::Vector octant{std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])};
    const double gauge = boundary_.gauge(octant);
    if (!(gauge > 0.0)) return {gauge, Eigen::Vector3d::UnitX()};
    const auto n = boundary_.normal(octant);
    const Eigen::Vector3d normal(std::copysign(n[0], x[0]), std::copysign(n[1], x[1]), std::copysign(n[2], x[2]));
    // The gradient of a norm has gradient·x = g(x).
    return {gauge, normal * (gauge / normal.dot(x))};
  }

 private:
  Boundary<double> boundary_;
};

}  // namespace

std::optional<Eigen::Vector3d> common_point(const Superquadric& a, const Superquadric& b,
                                            const Eigen::Matrix3d& rotation, const Eigen::Vector3d& offset) {
  const GaugeSlope slope_a(a);
  const GaugeSlope slope_b(b);
  // The ellipsoid through the corners of A's box contains A.
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d shape = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) shape(i, i) = 3.0 * std::pow(a.semi_axes[static_cast<std::size_t>(i)], 2);
  std::optional<Eigen::Vector3d> best;
  double least = 1.0;
  for (int step = 0, extra = 0; step < kMostSteps && extra < kExtraSteps; ++step) {
    const Slope on_a = slope_a(x);
    Slope on_b = slope_b(rotation.transpose() * (x - offset));
    on_b.gradient = rotation * on_b.gradient;
    const Slope& worse = on_a.gauge >= on_b.gauge ? on_a : on_b;
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

}  // namespace verisq::verify
