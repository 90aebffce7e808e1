/// Models and poses at random for what moves, and where a pose of a path is at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>
#include <verisq/model.hpp>

#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {

inline Model ball(const Point& centre, double radius) {
  Primitive primitive;
  primitive.superquadric = {.semi_axes = {radius, radius, radius}, .exponents = {1.0, 1.0}};
  primitive.pose.translation = centre;
  Model model;
  model.primitives = {primitive};
  return model;
}

inline Model random_union(RandomCases& random) {
  Model model;
  for (std::size_t i = 0; i < 1 + random.choice(3); ++i) {
    Primitive primitive = random.solid(
        Superquadric{.semi_axes = {random.uniform(0.2, 1.0), random.uniform(0.2, 1.0), random.uniform(0.2, 1.0)},
                     .exponents = {random.uniform(0.1, 1.9), random.uniform(0.1, 1.9)},
                     .taper = random.choice(2) == 0 ? 1.0 : random.uniform(0.3, 3.0)});
    for (double& t : primitive.pose.translation) t = random.uniform(-1.0, 1.0);
    model.primitives.push_back(primitive);
  }
  return model;
}

inline Pose random_pose(RandomCases& random) {
  Pose pose;
  for (double& t : pose.translation) t = random.uniform(-3.5, 3.5);
  for (double& q : pose.quaternion) q = random.uniform(-1.0, 1.0);
  return pose;
}

/// By Shoemake's formula, where RigidPath halves.
inline Pose pose_at(const std::vector<Pose>& path, double time) {
  using Number = long double;
  const auto k = std::min(static_cast<std::size_t>(time), path.size() - 2);
  const Number s = Number(time) - Number(k);
  std::array<Number, 4> a{};
  std::array<Number, 4> b{};
  const auto unit = [](const std::array<double, 4>& q) {
    Number sum = 0;
    for (const double x : q) sum += Number(x) * x;
    std::array<Number, 4> u{};
    for (std::size_t i = 0; i < 4; ++i) u[i] = q[i] / std::sqrt(sum);
    return u;
  };
  a = unit(path[k].quaternion);
  b = unit(path[k + 1].quaternion);
  Number cosine = 0;
  for (std::size_t i = 0; i < 4; ++i) cosine += a[i] * b[i];
  const Number sign = cosine < 0 ? -1 : 1;
  const Number angle = std::acos(std::min(Number(1), sign * cosine));
  Pose pose;
  for (std::size_t i = 0; i < 4; ++i) {
    const Number q = (std::sin((1 - s) * angle) * a[i] + sign * std::sin(s * angle) * b[i]) / std::sin(angle);
    pose.quaternion[i] = static_cast<double>(q);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Number from = path[k].translation[i];
    pose.translation[i] = static_cast<double>(from + s * (path[k + 1].translation[i] - from));
  }
  return pose;
}

}  // namespace verisq::oracle
