/// The distributions of the random cases.
#include "tests/oracle/random_cases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

namespace {

[[nodiscard]] Point offset(const Point& x, const Point& direction, double distance) {
  return {x[0] + distance * direction[0], x[1] + distance * direction[1], x[2] + distance * direction[2]};
}

[[nodiscard]] Point absolute(const Point& x) {
  return {std::abs(x[0]), std::abs(x[1]), std::abs(x[2])};
}

/// Outward unit normal at a boundary point of any octant.
[[nodiscard]] Point unit_normal(const MixedNorm<double>& norm, const Point& x) {
  const Point magnitude = absolute(x);
  Point n = norm.gradient(magnitude, norm.gauge(magnitude));
  for (std::size_t i = 0; i < 3; ++i) n[i] = std::copysign(n[i], x[i]);
  return scaled(n, 1 / length(n));
}

}  // namespace

std::string_view to_string(PointFamily family) {
  switch (family) {
    case PointFamily::along_normal: return "along a normal";
    case PointFamily::any_direction: return "any direction";
    case PointFamily::deep_inside: return "deep inside";
    case PointFamily::just_inside: return "just inside";
    case PointFamily::on_boundary: return "on the boundary";
    case PointFamily::on_plane: return "on a plane";
    case PointFamily::on_axis: return "on an axis";
    case PointFamily::centre: break;
  }
  return "centre";
}

double RandomCases::uniform(double low, double high) {
  const double unit = std::ldexp(static_cast<double>(engine_() >> 11), -53);
  return low + (high - low) * unit;
}

double RandomCases::log_uniform(double low, double high) {
  return std::exp(uniform(std::log(low), std::log(high)));
}

std::size_t RandomCases::choice(std::size_t count) {
  return static_cast<std::size_t>(engine_() % count);
}

Point RandomCases::direction() {
  const double height = uniform(-1, 1);
  const double angle = uniform(0, 2 * std::numbers::pi);
  const double radius = std::sqrt(1 - height * height);
  return {radius * std::cos(angle), radius * std::sin(angle), height};
}

double RandomCases::exponent() {
  if (choice(20) == 0) return log_uniform(1e-3, 0.05);
  switch (choice(10)) {
    case 0: return 0.05;
    case 1: return std::max(0.05, 0.05 * (1 + log_uniform(1e-16, 1)));
    case 2: return 1.0;
    case 3: return 2.0;
    case 4: return 2.0 - log_uniform(1e-16, 1e-1);
    case 5: return 1.0 + std::copysign(log_uniform(1e-16, 1e-1), uniform(-1, 1));
    default: return uniform(0.05, 2.0);
  }
}

Pose RandomCases::pose(double size) {
  Pose pose;
  const std::size_t kind = choice(3);
  if (kind == 0) return pose;
  if (kind == 1) {
    const std::size_t axis = 1 + choice(3);
    pose.quaternion[axis] = choice(2) == 0 ? 1.0 : -1.0;
    return pose;
  }
  const double length = log_uniform(1e-3, 1e3);
  for (double& component : pose.quaternion) component = length * uniform(-1, 1);
  const double reach = size * (choice(8) == 0 ? 1e3 : 3.0);
  for (double& coordinate : pose.translation) coordinate = reach * uniform(-1, 1);
  return pose;
}

Primitive RandomCases::solid() {
  Superquadric superquadric{{1.0, 1.0, 1.0}, {exponent(), exponent()}};
  const double scale = log_uniform(1e-3, 1e3);
  const double ratio = choice(5) == 0 ? 400.0 : log_uniform(1.0, 400.0);
  for (double& axis : superquadric.semi_axes) axis = scale * std::pow(ratio, -uniform(0, 1));
  superquadric.semi_axes[choice(3)] = scale;
  if (choice(5) == 0) superquadric.semi_axes[1] = superquadric.semi_axes[0];
  return {"solid", superquadric, pose(scale)};
}

Primitive RandomCases::solid(const std::optional<Superquadric>& superquadric) {
  if (!superquadric) return solid();
  const auto& axes = superquadric->semi_axes;
  return {"solid", *superquadric, pose(*std::max_element(axes.begin(), axes.end()))};
}

BoundaryPoint RandomCases::boundary_point(const Superquadric& superquadric) {
  const MixedNorm<double> norm(superquadric);
  Point u = direction();
  if (choice(2) == 0) {
    for (std::size_t i = 0; i < 3; ++i) u[i] *= superquadric.semi_axes[i];
  }
  const Point x = scaled(u, 1 / norm.gauge(u));
  return {x, unit_normal(norm, x)};
}

Point RandomCases::local_point(const Superquadric& superquadric, PointFamily family) {
  const auto [x, normal] = boundary_point(superquadric);
  const double size = *std::max_element(superquadric.semi_axes.begin(), superquadric.semi_axes.end());
  switch (family) {
    case PointFamily::along_normal: return offset(x, normal, size * log_uniform(1e-9, 1e6));
    case PointFamily::any_direction: return scaled(x, 1 + log_uniform(1e-9, 1e6));
    case PointFamily::deep_inside: return scaled(x, uniform(0, 1));
    case PointFamily::just_inside: return offset(x, normal, -size * log_uniform(1e-9, 1e-1));
    case PointFamily::on_boundary: return x;
    case PointFamily::on_plane:
    case PointFamily::on_axis: {
      Point q = choice(2) == 0 ? scaled(x, uniform(0, 1)) : offset(x, normal, size * log_uniform(1e-9, 1e6));
      const std::size_t axis = choice(3);
      if (family == PointFamily::on_plane) {
        q[axis] = 0.0;
      } else {
        q = {axis == 0 ? q[0] : 0.0, axis == 1 ? q[1] : 0.0, axis == 2 ? q[2] : 0.0};
      }
      return q;
    }
    case PointFamily::centre: break;
  }
  return {0.0, 0.0, 0.0};
}

RandomPoint RandomCases::point(const Primitive& solid) {
  // The centre is one point a solid: rarely.
  const std::size_t ticket = choice(4 * (point_families.size() - 1) + 1);
  const PointFamily family = point_families[ticket / 4];
  const Point local = local_point(solid.superquadric, family);
  return {rounded(PosedSolid(solid.superquadric, solid.pose).from_own_frame(widened(local))), family};
}

}  // namespace verisq::oracle
