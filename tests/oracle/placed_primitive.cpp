/// Taper, bend and pose in double, in forms that keep their accuracy for every curvature.
#include "tests/oracle/placed_primitive.hpp"

#include <cmath>
#include <numbers>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

namespace {

/// f(t)/t, by its limit 1 where t is tiny.
template <class Function>
[[nodiscard]] double quotient(const Function& f, double t) {
  return std::abs(t) < 1e-9 ? 1.0 : f(t) / t;
}

[[nodiscard]] double sine_quotient(double t) {
  return quotient([](double x) { return std::sin(x); }, t);
}

}  // namespace

PlacedPrimitive::PlacedPrimitive(const Primitive& primitive)
    : primitive_(primitive),
      norm_(primitive.superquadric),
      taper_((primitive.superquadric.taper - 1) / (primitive.superquadric.taper + 1)) {
  // The exact rotation, rounded: its rows are what turns the three unit vectors back.
  const PosedSolid turned(primitive.superquadric, {{0.0, 0.0, 0.0}, primitive.pose.quaternion});
  for (std::size_t i = 0; i < 3; ++i) {
    Point unit{0.0, 0.0, 0.0};
    unit[i] = 1.0;
    rows_[i] = rounded(turned.to_own_frame(widened(unit)));
  }
  if (!primitive.bend) return;
  const double angle = primitive.bend->angle_degrees * std::numbers::pi / 180;
  curvature_ = primitive.bend->curvature;
  cosine_ = std::cos(angle);
  sine_ = std::sin(angle);
}

Point PlacedPrimitive::placed(const Point& untapered) const {
  const double height = primitive_.superquadric.semi_axes[2];
  const double level = (untapered[2] / height - taper_) / (1 - taper_ * untapered[2] / height);
  const double scale = 1 + taper_ * level;
  const Point local{scale * untapered[0], scale * untapered[1], height * level};
  const double r = local[0] * cosine_ + local[1] * sine_;
  const double s = local[1] * cosine_ - local[0] * sine_;
  const double arc = curvature_ * local[2];
  // 1 - cos = 2 sin^2 of the half angle, over k.
  const double half = std::sin(arc / 2);
  const double R = r * std::cos(arc) + local[2] * half * sine_quotient(arc / 2);
  const double Z = local[2] * sine_quotient(arc) - r * std::sin(arc);
  const Point bent{R * cosine_ - s * sine_, R * sine_ + s * cosine_, Z};
  Point point;
  for (std::size_t i = 0; i < 3; ++i) point[i] = dot(rows_[i], bent) + primitive_.pose.translation[i];
  return point;
}

PlacedPrimitive::Unbent PlacedPrimitive::unbent(const Point& point) const {
  const Point d = difference(point, primitive_.pose.translation);
  Point x{0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) x[i] += rows_[j][i] * d[j];
  }
  if (curvature_ == 0.0) return {x, 1.0};
  const double R = x[0] * cosine_ + x[1] * sine_;
  const double s = x[1] * cosine_ - x[0] * sine_;
  const double m = 1 - curvature_ * R;
  const double n = curvature_ * x[2];
  const double radius = std::hypot(m, n);
  // (1 - radius)/k and atan2/k, each with the factor k taken out.
  const double r = (R * (1 + m) - n * x[2]) / (1 + radius);
  const double arc = std::atan2(n, m);
  const double z = std::abs(arc) < 1e-9 ? x[2] / m : arc / curvature_;
  return {{r * cosine_ - s * sine_, r * sine_ + s * cosine_, z}, radius};
}

Point PlacedPrimitive::untapered(const Point& local) const {
  const double height = primitive_.superquadric.semi_axes[2];
  const double scale = 1 + taper_ * local[2] / height;
  if (!(scale > 1e-3)) return local;
  return {local[0] / scale, local[1] / scale, (local[2] + taper_ * height) / scale};
}

Point PlacedPrimitive::own(const Point& point) const {
  return untapered(unbent(point).local);
}

Membership PlacedPrimitive::membership(const Point& point) const {
  constexpr double margin = 1e-11;
  const double gauge = norm_.gauge(own(point));
  if (gauge > 1 + margin) return Membership::outside;
  return gauge < 1 - margin ? Membership::inside : Membership::boundary;
}

Membership PlacedPrimitive::membership(const Point& centre, double radius) const {
  constexpr double margin = 1e-10;
  const auto [local, scaled_radius] = unbent(centre);
  // The ball seen from the centre of curvature, which lies outside of the solid: behind the cut |z| goes on from pi/|k|
  // downwards, hence neither bound of |z| below is passed.
  const double sine = radius * std::abs(curvature_) / scaled_radius;
  const bool holds_the_centre = !(sine < 1);
  const double arc = radius / scaled_radius * quotient([](double t) { return std::asin(t); }, sine) * (1 + 1e-12);
  const Point nearest{std::max(0.0, std::abs(local[0]) - radius), std::max(0.0, std::abs(local[1]) - radius),
                      holds_the_centre ? 0.0 : std::max(0.0, std::abs(local[2]) - arc)};
  const double height = primitive_.superquadric.semi_axes[2];
  if (nearest[2] > (1 + margin) * height) return Membership::outside;
  // The solid's part of the box has heights up to its ends alone, where the taper's inverse is far from its pole; the
  // scale is affine in z, and the untapered height rises with it.
  // Behind the cut z goes on at the other end.
  const bool at_cut = curvature_ != 0.0 && std::abs(local[2]) + arc >= std::numbers::pi / std::abs(curvature_);
  const bool both_ends = holds_the_centre || (taper_ != 0.0 && at_cut);
  const double bottom = both_ends ? -height : std::max(local[2] - arc, -height);
  const double top = both_ends ? height : std::min(local[2] + arc, height);
  const double scales[] = {1 + taper_ * bottom / height, 1 + taper_ * top / height};
  const double narrow = std::min(scales[0], scales[1]);
  const double wide = std::max(scales[0], scales[1]);
  const double low = (bottom + taper_ * height) / scales[0];
  const double high = (top + taper_ * height) / scales[1];
  const double between = low < 0 && high > 0 ? 0.0 : std::min(std::abs(low), std::abs(high));
  if (norm_.gauge({nearest[0] / wide, nearest[1] / wide, between}) > 1 + margin) return Membership::outside;
  if (holds_the_centre || std::abs(local[2]) + arc >= height) return Membership::boundary;
  const Point farthest{(std::abs(local[0]) + radius) / narrow, (std::abs(local[1]) + radius) / narrow,
                       std::max(std::abs(low), std::abs(high))};
  return norm_.gauge(farthest) < 1 - margin ? Membership::inside : Membership::boundary;
}

double PlacedPrimitive::reach() const {
  const auto& axes = primitive_.superquadric.semi_axes;
  return axes[2] + (1 + std::abs(taper_)) * std::hypot(axes[0], axes[1]);
}

}  // namespace verisq::oracle
