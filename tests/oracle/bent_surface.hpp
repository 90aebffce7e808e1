/// Random bent superquadrics and points of their surfaces, by the formulas of verisq/model.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {

inline Superquadric random_long_solid(RandomCases& cases) {
  Superquadric solid{{cases.uniform(0.3, 1.5), cases.uniform(0.3, 1.5), cases.uniform(0.5, 3.0)},
                     {cases.uniform(0.1, 2.0), cases.uniform(0.1, 2.0)}};
  if (cases.choice(3) == 0) solid.taper = cases.log_uniform(0.2, 5.0);
  return solid;
}

/// Admissible, whatever the taper, which makes sections up to twice as large.
inline Bend random_bend(RandomCases& cases, const Superquadric& solid) {
  const auto& [a1, a2, a3] = solid.semi_axes;
  const double most = std::min(0.45 / std::hypot(a1, a2), 3.0 / a3);
  return {cases.uniform(-most, most), cases.uniform(-180.0, 180.0)};
}

/// But for rounding: the boundary point of Eq. (1), tapered and bent, and its height before the bend.
struct BentSurfacePoint {
  Point bent;
  double height;
};

inline BentSurfacePoint bent_surface_point(const Superquadric& solid, const Bend& bend, double polar, double azimuth) {
  const auto power = [](double x, double e) { return std::copysign(std::pow(std::fabs(x), e), x); };
  const auto [e1, e2] = solid.exponents;
  const double ring = power(std::cos(polar), e1);
  const double k = (solid.taper - 1.0) / (solid.taper + 1.0);
  const double z = power(std::sin(polar), e1);
  const double height = (z - k) / (1.0 - k * z);
  const double scale = 1.0 + k * height;
  const double x = scale * solid.semi_axes[0] * ring * power(std::cos(azimuth), e2);
  const double y = scale * solid.semi_axes[1] * ring * power(std::sin(azimuth), e2);
  const double along = solid.semi_axes[2] * height;
  const double angle = bend.angle_degrees * std::numbers::pi / 180.0;
  const double r = x * std::cos(angle) + y * std::sin(angle);
  const double s = y * std::cos(angle) - x * std::sin(angle);
  const double c = bend.curvature;
  const double bent_r = 1.0 / c - (1.0 / c - r) * std::cos(c * along);
  const double bent_z = (1.0 / c - r) * std::sin(c * along);
  return {{bent_r * std::cos(angle) - s * std::sin(angle), bent_r * std::sin(angle) + s * std::cos(angle), bent_z},
          along};
}

inline BentSurfacePoint random_surface_point(RandomCases& cases, const Superquadric& solid, const Bend& bend) {
  const double polar = cases.uniform(-1.0, 1.0) * std::numbers::pi / 2;
  return bent_surface_point(solid, bend, polar, cases.uniform(-1.0, 1.0) * std::numbers::pi);
}

inline std::vector<BentSurfacePoint> random_surface_points(RandomCases& cases, const Superquadric& solid,
                                                           const Bend& bend, std::size_t count) {
  std::vector<BentSurfacePoint> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) points.push_back(random_surface_point(cases, solid, bend));
  return points;
}

/// How far a point lies along n, but for rounding.
inline double dot_of(const Point& n, const Point& point) {
  return n[0] * point[0] + n[1] * point[1] + n[2] * point[2];
}

}  // namespace verisq::oracle
