/// Fixed points propose the slope and the farthest point.
#include "verify/proposals/section_mapping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace verisq::verify {

namespace {

constexpr int most_fixed_points = 6;

Superquadric without_taper(Superquadric solid) {
  solid.taper = 1.0;
  return solid;
}

/// (1 - |z|^p)^(1/p)
double profile(double z, double p) {
  return std::pow(std::max(0.0, 1.0 - std::pow(std::fabs(z), p)), 1.0 / p);
}

double slope_of_profile(double z, double p) {
  return -std::copysign(std::pow(std::fabs(z) / profile(z, p), p - 1.0), z);
}

double sine_quotient_of(double angle) {
  return angle == 0.0 ? 1.0 : std::sin(angle) / angle;
}

double radians(double degrees) {
  return degrees * (std::numbers::pi / 180.0);
}

}  // namespace

SectionMapping::SectionMapping(const Primitive& primitive)
    : superquadric_(primitive.superquadric),
      is_bent_(primitive.bend && primitive.bend->curvature != 0.0),
      taper_((primitive.superquadric.taper - 1.0) / (primitive.superquadric.taper + 1.0)),
      unbent_(primitive.superquadric),
      untapered_(without_taper(primitive.superquadric)) {
  if (!is_bent_) return;
  curvature_ = primitive.bend->curvature;
  cosine_ = std::cos(radians(primitive.bend->angle_degrees));
  sine_ = std::sin(radians(primitive.bend->angle_degrees));
}

SectionMapping::End SectionMapping::end_at(double height) const {
  const double angle = curvature_ * height;
  return {height, std::cos(angle), std::sin(angle), height * std::sin(angle / 2) * sine_quotient_of(angle / 2),
          height * sine_quotient_of(angle)};
}

SectionMapping::Plain SectionMapping::turned(const Plain& v) const {
  return {v[0] * cosine_ + v[1] * sine_, v[1] * cosine_ - v[0] * sine_, v[2]};
}

SectionMapping::Plain SectionMapping::turned_back(const Plain& v) const {
  return {v[0] * cosine_ - v[1] * sine_, v[0] * sine_ + v[1] * cosine_, v[2]};
}

/// In the frame of the bend.
SectionMapping::Plain SectionMapping::bent(const Plain& unbent) const {
  const double angle = curvature_ * unbent[2];
  return {unbent[0] * std::cos(angle) + unbent[2] * std::sin(angle / 2) * sine_quotient_of(angle / 2), unbent[1],
          (1.0 - curvature_ * unbent[0]) * unbent[2] * sine_quotient_of(angle)};
}

SectionMapping::Plain SectionMapping::unbent(const Plain& x) const {
  if (!is_bent_) return x;
  const Plain t = turned(x);
  const double m = 1.0 - curvature_ * t[0];
  const double w = std::hypot(m, curvature_ * t[2]);
  const double r = (2.0 * t[0] - curvature_ * (t[0] * t[0] + t[2] * t[2])) / (1.0 + w);
  return turned_back({r, t[1], std::atan2(curvature_ * t[2], m) / curvature_});
}

SectionMapping::Plain SectionMapping::bent_normal(const Plain& normal, const Plain& unbent_point) const {
  if (!is_bent_) return normal;
  const Plain n = turned(normal);
  const double angle = curvature_ * unbent_point[2];
  const double along_axis = n[2] / (1.0 - curvature_ * turned(unbent_point)[0]);
  return turned_back({n[0] * std::cos(angle) + along_axis * std::sin(angle), n[1],
                      along_axis * std::cos(angle) - n[0] * std::sin(angle)});
}

/// Of the unbent solid towards (c, across, slope), in the frame of the bend.
SectionMapping::Plain SectionMapping::farthest(double c, double across, double slope) const {
  Plain x = turned(unbent_(turned_back({c, across, slope})));
  x[2] -= taper_ * superquadric_.semi_axes[2];
  return x;
}

/// The same within the section at a height.
SectionMapping::Plain SectionMapping::farthest_at(double height, double c, double across) const {
  const Plain x = turned(untapered_(turned_back({c, across, 0.0})));
  const double scale = scale_at(height);
  return {scale * x[0], scale * x[1], height};
}

/// How large the section at a height is, for one of the solid without a taper's middle (docs/mathematics.md §18).
double SectionMapping::scale_at(double height) const {
  const double z = std::clamp(height / superquadric_.semi_axes[2], -1.0, 1.0);
  const double s = 1.0 + taper_ * z;
  return s * profile((z + taper_) / s, 2.0 / superquadric_.exponents[0]);
}

double SectionMapping::scale_slope_at(double height) const {
  const double z = height / superquadric_.semi_axes[2];
  const double s = 1.0 + taper_ * z;
  const double unbent = (z + taper_) / s;
  const double p = 2.0 / superquadric_.exponents[0];
  const double slope = taper_ * profile(unbent, p) + slope_of_profile(unbent, p) * (1.0 - taper_ * taper_) / s;
  return slope / superquadric_.semi_axes[2];
}

/// The ends have the same value, unless the height where H - v z is attained would leave the section.
double SectionMapping::slope(const Plain& direction, const Section& section) const {
  if (!is_bent_) return 0.0;
  const Plain n = turned(direction);
  const auto& [lower, upper] = section;
  const auto axis = [&](const End& end) { return n[0] * end.along + n[2] * end.up; };
  const auto along = [&](const End& end) { return n[0] * end.cosine - n[2] * end.sine; };
  const double rise = axis(upper) - axis(lower);
  const double between = upper.height - lower.height;
  const double c_lower = along(lower);
  const double c_upper = along(upper);
  double v = rise / between;
  double height = 0.0;
  for (int i = 0; i < 2; ++i) {
    const Plain x = farthest(0.5 * (c_lower + c_upper), n[1], v);
    height = x[2];
    v = (rise + (c_upper - c_lower) * x[0]) / between;
  }
  if (height >= lower.height && height <= upper.height) return v;
  const End& end = height < lower.height ? lower : upper;
  const Plain x = turned(untapered_(turned_back({along(end), n[1], 0.0})));
  const double at_end = -scale_slope_at(end.height) * (along(end) * x[0] + n[1] * x[1]);
  return std::isfinite(at_end) ? at_end : v;  // at a pole, which no height is beyond
}

Coordinates<double> SectionMapping::support_point(const Plain& direction, const Section& section) const {
  const Plain n = turned(direction);
  if (!is_bent_) return turned_back(farthest(n[0], n[1], n[2]));
  Plain best{};
  double reach = -std::numeric_limits<double>::infinity();
  const auto try_point = [&](const Plain& unbent) {
    const Plain image = bent(unbent);
    const double found = dot(n, image);
    if (found > reach) best = image;
    reach = std::max(reach, found);
  };
  double height = 0.5 * section.lower.height + 0.5 * section.upper.height;
  double before = height;
  double r = 0.0;
  for (int i = 0; i < most_fixed_points; ++i) {
    const double cosine = std::cos(curvature_ * height);
    const double sine = std::sin(curvature_ * height);
    const double c = n[0] * cosine - n[2] * sine;
    Plain x = farthest(c, n[1], (n[0] * sine + n[2] * cosine) * (1.0 - curvature_ * r));
    const double next = std::clamp(x[2], section.lower.height, section.upper.height);
    if (next != x[2]) x = farthest_at(next, c, n[1]);
    try_point(x);
    r = x[0];
    before = std::exchange(height, next);
    if (std::fabs(height - before) <= 0x1p-50 * superquadric_.semi_axes[2]) return turned_back(best);
  }
  // Between two corners, perhaps, which take turns.
  const double between = 0.5 * (height + before);
  const double c = n[0] * std::cos(curvature_ * between) - n[2] * std::sin(curvature_ * between);
  try_point(farthest_at(between, c, n[1]));
  return turned_back(best);
}

}  // namespace verisq::verify
