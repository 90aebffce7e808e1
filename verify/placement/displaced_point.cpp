/// With u = p − c the place is p + y, y = (E⁻¹u − u) − E⁻¹d. κ = min(ρ, 2) is at least 2 sin(θ/2) and sin θ for every
/// angle θ <= ρ, κ²/2 at least 1 − cos θ. By Rodrigues E⁻¹u − u = sin θ (a × u) + (1 − cos θ) a × (a × u), a the unit
/// axis, and E⁻¹d lies within κ|d| of d. So for every n, with |n·(a × u)| = |a·(u × n)| <= |u × n|,
///
///   n·y <= κ |u × n| + κ²/2 |n| |u| + Σ |n_i| τ_i + κ |n| |τ|.
#include "verify/placement/displaced_point.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "verify/analysis/cross_product.hpp"
#include "verify/sets/bounding_box.hpp"

namespace verisq::verify {
namespace {

double turn_factor(const PoseUncertainty& bounds) {
  return std::min(bounds.rotation, 2.0);
}

Vector3<double> exact(const Point& p) {
  return {p[0], p[1], p[2]};
}

}  // namespace

DisplacedPoint::DisplacedPoint(const PoseUncertainty& bounds, const Point& point)
    : point_(exact(point)),
      translation_(bounds.translation),
      arm_(point_ - exact(bounds.centre)),
      turn_(turn_factor(bounds)),
      arm_length_(length(arm_)),
      shift_length_(length(exact(bounds.translation))),
      reach_((turn_ * arm_length_ + shift_length_).upper()) {
  for (std::size_t i = 0; i < 3; ++i) {
    Vector3<double> axis;
    axis[i] = 1;
    half_extent_[i] = std::min(reach_, support(axis));
  }
}

double DisplacedPoint::support(const Vector3<double>& n) const {
  const Interval n_length = length(n);
  Interval most = turn_ * (length(cross(arm_, n)) + n_length * (turn_ * arm_length_ / Interval(2) + shift_length_));
  for (std::size_t i = 0; i < 3; ++i) most += abs(n[i]) * Interval(translation_[i]);
  return most.upper();
}

bool DisplacedPoint::avoids(const Point& centre, double radius) const {
  const Vector3<double> from_point = exact(centre) - point_;
  // Of a box of translations and of a disc across the arm: the ways out of each, and of both.
  Vector3<double> out_of_box;
  Vector3<double> along_arm = arm_;
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = from_point[i].lower();
    out_of_box[i] = x - std::clamp(x, -translation_[i], translation_[i]);
    along_arm[i] = arm_[i].lower();
  }
  if (arm_.dot(from_point).upper() < 0.0) along_arm = -along_arm;
  return separates(out_of_box, from_point, radius) || separates(along_arm, from_point, radius) ||
         separates(from_point, from_point, radius);
}

/// The turned arm moves by sin θ (a × u), in a disc across the arm, which a polygon of twelve corners contains, and by
/// a vector of at most κ²/2 |u|, for which the box of translations is enlarged.
void DisplacedPoint::append_cover(std::vector<Point>& points) const {
  constexpr unsigned corners = cover_size / 8;
  const double turn = turn_.upper();
  const double arm = arm_length_.upper();
  const double radius = turn * arm / std::cos(std::numbers::pi / corners);
  const double more = turn * (shift_length_.upper() + turn * arm / 2);
  const Eigen::Vector3d u(arm_[0].lower(), arm_[1].lower(), arm_[2].lower());
  const Eigen::Vector3d across = u.isZero(0.0) ? Eigen::Vector3d::UnitX() : u.unitOrthogonal();
  const Eigen::Vector3d other = u.isZero(0.0) ? Eigen::Vector3d::UnitY() : u.cross(across).normalized();
  for (unsigned k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    const Eigen::Vector3d at = radius * (std::cos(angle) * across + std::sin(angle) * other);
    for (unsigned octant = 0; octant < 8; ++octant) {
      Point corner;
      for (std::size_t i = 0; i < 3; ++i) {
        const double half = translation_[i] + more;
        corner[i] = point_[i].lower() + at[static_cast<Eigen::Index>(i)] + ((octant >> i & 1U) != 0 ? half : -half);
      }
      points.push_back(corner);
    }
  }
}

/// A corner's coordinate is made of fewer than 64 operations on numbers that are at most 4 (|p| + |u| + reach) large,
/// each of which rounds by 2⁻⁵³ of its result: together less than 2⁻⁴⁵ of that sum a coordinate.
double DisplacedPoint::cover_error() const {
  const Interval size = length(point_) + arm_length_ + Interval(reach_);
  return (size * Interval(0x1p-44)).upper();
}

bool DisplacedPoint::separates(const Vector3<double>& n, const Vector3<double>& from_point, double radius) const {
  return (n.dot(from_point) - Interval(radius) * length(n)).lower() > support(n);
}

double reach_of(const PoseUncertainty& bounds, const Model& model) {
  const Box box = bounding_box(model);
  Vector3<double> farthest;
  for (std::size_t i = 0; i < 3; ++i) {
    const Interval centre(bounds.centre[i]);
    farthest[i] = std::max(abs(Interval(box.lower[i]) - centre).upper(), abs(Interval(box.upper[i]) - centre).upper());
  }
  return (Interval(turn_factor(bounds)) * length(farthest) + length(exact(bounds.translation))).upper();
}

}  // namespace verisq::verify
