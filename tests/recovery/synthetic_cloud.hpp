/// Clouds of random superquadrics whose shape is known, as recoveries are counted on: seen in part, noisy, with
/// outliers.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "host/prepare/surface_distance.hpp"
#include "host/prepare/surface_samples.hpp"

namespace verisq::recovery {

/// Each level has all that those before it have.
enum class Difficulty : std::uint8_t { whole, seen_in_part, noisy, with_outliers, with_many_outliers };

struct SyntheticCloud {
  Shape truth;
  std::vector<Eigen::Vector3d> points;
};

inline double within(std::mt19937_64& random, double bound) {
  return bound * (2.0 * fraction(random) - 1.0);
}

inline Eigen::Vector3d random_vector(std::mt19937_64& random, double bound) {
  const double x = within(random, bound);
  const double y = within(random, bound);
  return {x, y, within(random, bound)};
}

/// Uniform in the unit ball, away from its centre.
inline Eigen::Vector4d random_in_ball(std::mt19937_64& random) {
  Eigen::Vector4d v;
  do {
    for (int i = 0; i < 4; ++i) v[i] = within(random, 1.0);
  } while (v.norm() > 1.0 || v.norm() < 0.1);
  return v;
}

/// Exponents 0.004 to 2, semi-axes 0.5 to 2.5, any pose (Liu et al., CVPR 2022).
inline Shape random_shape(std::mt19937_64& random) {
  Shape shape;
  for (int i = 0; i < 2; ++i) shape.exponents[i] = 0.004 + 1.996 * fraction(random);
  for (int i = 0; i < 3; ++i) shape.axes[i] = 0.5 + 2.0 * fraction(random);
  const Eigen::Vector4d q = random_in_ball(random);
  shape.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  shape.centre = random_vector(random, 1.0);
  return shape;
}

/// A plane leaves 600 of 1,000 points; each coordinate moves by up to 5 % of the mean semi-axis; outliers lie in the
/// box of the points, doubled: 0.4 times the points, or two thirds, which are 40 % of the whole cloud.
inline SyntheticCloud synthetic_cloud(Difficulty difficulty, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  SyntheticCloud cloud{random_shape(random), {}};
  std::vector<Eigen::Vector3d>& points = cloud.points;
  points = sample_surface(cloud.truth, 1000, random);
  if (difficulty >= Difficulty::seen_in_part) {
    const Eigen::Vector3d side = random_in_ball(random).head<3>();
    std::ranges::sort(points, {}, [&side](const Eigen::Vector3d& point) { return side.dot(point); });
    points.resize(600);
  }
  if (difficulty >= Difficulty::noisy)
    for (Eigen::Vector3d& point : points) point += random_vector(random, 0.05 * cloud.truth.axes.mean());
  if (difficulty < Difficulty::with_outliers) return cloud;
  Eigen::Vector3d lowest = points.front();
  Eigen::Vector3d highest = lowest;
  for (const Eigen::Vector3d& point : points) {
    lowest = lowest.cwiseMin(point);
    highest = highest.cwiseMax(point);
  }
  const std::size_t outliers = difficulty == Difficulty::with_outliers ? 240 : 400;
  for (std::size_t i = 0; i < outliers; ++i)
    points.emplace_back(0.5 * (lowest + highest) + random_vector(random, 1.0).cwiseProduct(highest - lowest));
  return cloud;
}

}  // namespace verisq::recovery
