/// This file implements displaced_point.hpp.
#include "verify/search/displaced_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {
namespace {

double turn_factor(const PoseUncertainty& bounds) {
  return std::min(bounds.rotation, 2.0);
}

Vector3<double> exact(const Point& p) {
  return {p[0], p[1], p[2]};
}

/// |a - b|, whose squares have digits of any size.
Interval distance(const Point& a, const Point& b) {
  return in_binary64(length<Real>(PreciseVector(precise(a) - precise(b))));
}

/// Two unit vectors across u and across each other, to a few roundings; of 0 any.
std::array<Point, 2> across(const Point& u) {
  if (u == Point{}) return {Point{1.0, 0.0, 0.0}, Point{0.0, 1.0, 0.0}};
  const Point along = near_one(u);
  const auto [x, y, z] = along;
  const bool about_z = std::max(std::abs(x), std::abs(y)) <= 1e-12 * std::abs(z);
  const double share = 1.0 / std::sqrt(about_z ? y * y + z * z : x * x + y * y);
  const Point first = about_z ? Point{0.0, -z * share, y * share} : Point{-y * share, x * share, 0.0};
  Point second = cross(along, first);
  const double length = std::sqrt(dot(second, second));
  for (double& coordinate : second) coordinate /= length;
  return {first, second};
}

}  // namespace

DisplacedPoint::DisplacedPoint(const PoseUncertainty& bounds, const Point& point)
    : point_(exact(point)),
      translation_(bounds.translation),
      arm_(point_ - exact(bounds.centre)),
      turn_(turn_factor(bounds)),
      arm_length_(distance(point, bounds.centre)),
      shift_length_(distance(bounds.translation, {})),
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
  // The ways out of a box of translations, out of a disc across the arm, and out of both.
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

/// The turned arm moves by sin θ (a × u) and by a vector of at most κ²/2 |u|. The former lies in a disc across the arm,
/// which a polygon of twelve corners contains. The box of translations is enlarged for the latter.
void DisplacedPoint::append_cover(std::vector<Point>& points) const {
  constexpr unsigned corners = cover_size / 8;
  const double turn = turn_.upper();
  const double arm = arm_length_.upper();
  const double radius = turn * arm / std::cos(std::numbers::pi / corners);
  const double more = turn * (shift_length_.upper() + turn * arm / 2);
  const auto [first, second] = across({arm_[0].lower(), arm_[1].lower(), arm_[2].lower()});
  for (unsigned k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    const double cosine = std::cos(angle);
    const double sine = std::sin(angle);
    for (unsigned octant = 0; octant < 8; ++octant) {
      Point corner;
      for (std::size_t i = 0; i < 3; ++i) {
        const double half = translation_[i] + more;
        const double turned = radius * (cosine * first[i] + sine * second[i]);
        corner[i] = point_[i].lower() + turned + ((octant >> i & 1U) != 0 ? half : -half);
      }
      points.push_back(corner);
    }
  }
}

/// A corner's coordinate results from fewer than 64 operations on numbers that are at most 4 (|p| + |u| + reach) large.
/// Each rounds by 2⁻⁵³ of its result: together less than 2⁻⁴⁵ of that sum a coordinate. Directions have a length of
/// about 1 and result from numbers of about 1. A result below 2⁻¹⁰²² rounds by at most 2⁻¹⁰⁷⁵ instead, and later
/// operations make that at most 16 times as large: together less than 2⁻¹⁰⁶⁵, far below the smallest normal number.
double DisplacedPoint::cover_error() const {
  const Interval from_origin = distance({point_[0].lower(), point_[1].lower(), point_[2].lower()}, {});
  const Interval size = from_origin + arm_length_ + Interval(reach_);
  return (size * Interval(0x1p-44) + Interval(std::numeric_limits<double>::min())).upper();
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
