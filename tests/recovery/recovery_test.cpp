/// Recoveries of shapes that are known: from clouds seen in part, with noise and outliers, and from meshes.
#include "verisq/recovery.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "host/prepare/superquadric_fit.hpp"
#include "host/prepare/surface_distance.hpp"
#include "host/prepare/surface_samples.hpp"
#include "host/prepare/union_fit.hpp"
#include "tests/recovery/synthetic_cloud.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"
#include "verisq/mesh_topology.hpp"

namespace verisq::testing {
namespace {

using recovery::Difficulty;
using recovery::DistanceToShape;
using recovery::Family;
using recovery::Shape;
using recovery::Step;

/// Symmetric mean distance of the surfaces, to first order, over the largest semi-axis.
double surface_error(const Shape& found, const Shape& truth) {
  const auto mean = [](const Shape& shape, const Shape& other) {
    std::mt19937_64 random(7);
    const std::vector<Eigen::Vector3d> points = sample_surface(other, 300, random);
    const DistanceToShape distance(shape, Family::plain);
    double sum = 0.0;
    for (const Eigen::Vector3d& point : points) sum += std::abs(distance.value(point));
    return sum / static_cast<double>(points.size());
  };
  return 0.5 * (mean(found, truth) + mean(truth, found)) / truth.axes.maxCoeff();
}

/// How many of the first twenty cases are recovered so closely.
int recovered(Difficulty difficulty, double error) {
  int count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const recovery::SyntheticCloud cloud = synthetic_cloud(difficulty, 4'000'000 + seed);
    count += surface_error(recovery::recover_single(cloud.points, {}).shape, cloud.truth) <= error ? 1 : 0;
  }
  return count;
}

TEST(RecoveryTest, RecoversCleanCloudsExactly) {
  EXPECT_EQ(recovered(Difficulty::whole, 1e-6), 20);
  EXPECT_EQ(recovered(Difficulty::seen_in_part, 1e-6), 20);
}

TEST(RecoveryTest, RecoversMostNoisyCloudsWithOutliers) {
  EXPECT_GE(recovered(Difficulty::noisy, 0.02), 19);
  EXPECT_GE(recovered(Difficulty::with_many_outliers, 0.02), 18);
}

Shape any_shape(std::mt19937_64& random) {
  Shape shape = recovery::random_shape(random);
  shape.exponents = shape.exponents.cwiseMax(0.3).cwiseMin(1.7);
  shape.taper = 0.3;
  return shape;
}

TEST(RecoveryTest, DerivativesAreThoseOfTheDistance) {
  std::mt19937_64 random(11);
  for (int k = 0; k < 50; ++k) {
    const Shape shape = any_shape(random);
    const Eigen::Vector3d point = shape.centre + recovery::random_vector(random, 2.0);
    recovery::SurfaceDistance at{};
    DistanceToShape(shape, Family::tapered).evaluate(point, at);
    EXPECT_DOUBLE_EQ(at.value, DistanceToShape(shape, Family::tapered).value(point));
    for (int i = 0; i < 12; ++i) {
      constexpr double width = 1e-6;
      Step step = Step::Zero();
      step[i] = width;
      const double above = DistanceToShape(moved(shape, step), Family::tapered).value(point);
      const double below = DistanceToShape(moved(shape, -step), Family::tapered).value(point);
      EXPECT_NEAR(at.derivatives[i], (above - below) / (2.0 * width), 1e-5 * (1.0 + std::abs(at.derivatives[i])))
          << "parameter " << i;
    }
  }
}

TEST(RecoveryTest, SamplesLieOnTheSurfaceThatTheModelMeans) {
  std::mt19937_64 random(13);
  Shape shape = any_shape(random);
  shape.curvature = {0.1, -0.05};
  const SignedDistance proven(Model{"", {primitive_of(shape, "bent")}});
  for (const Eigen::Vector3d& point : sample_surface(shape, 20, random)) {
    const Enclosure distance = proven({point[0], point[1], point[2]}, 1e-7);
    EXPECT_NEAR(0.5 * (distance.lo + distance.hi), 0.0, 1e-6);
    EXPECT_NEAR(DistanceToShape(shape, Family::bent_tapered).value(point), 0.0, 1e-12);
    EXPECT_NEAR(DistanceToShape(recovery::shape_of(primitive_of(shape, "bent")), Family::plain).value(point), 0.0,
                1e-12);
  }
}

/// A closed mesh of an ellipsoid, by circles of latitude.
void add_ellipsoid(Mesh& mesh, const Point& centre, const Point& axes) {
  constexpr std::uint32_t rings = 24;
  constexpr std::uint32_t around = 48;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto add = [&](double latitude, double longitude) {
    mesh.vertices.push_back({centre[0] + axes[0] * std::cos(latitude) * std::cos(longitude),
                             centre[1] + axes[1] * std::cos(latitude) * std::sin(longitude),
                             centre[2] + axes[2] * std::sin(latitude)});
  };
  for (std::uint32_t i = 1; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j)
      add(std::numbers::pi * (static_cast<double>(i) / rings - 0.5), 2.0 * std::numbers::pi * j / around);
  const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size());
  add(-0.5 * std::numbers::pi, 0.0);
  add(0.5 * std::numbers::pi, 0.0);
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return first + i * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    mesh.triangles.push_back({bottom, at(0, j + 1), at(0, j)});
    mesh.triangles.push_back({bottom + 1, at(rings - 2, j), at(rings - 2, j + 1)});
    for (std::uint32_t i = 0; i + 2 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
}

Mesh two_ellipsoids() {
  Mesh mesh;
  add_ellipsoid(mesh, {0.0, 0.0, 0.0}, {3.0, 2.0, 1.0});
  add_ellipsoid(mesh, {5.0, 1.0, 0.0}, {1.0, 1.5, 2.5});
  return mesh;
}

TEST(RecoveryTest, RecoversAUnionFromItsMeshAlone) {
  const Recovery found = recover(two_ellipsoids(), {.primitives = 3, .deviation = 0.05});
  ASSERT_EQ(found.model.primitives.size(), 2U);
  ASSERT_EQ(found.stages.back().primitives, 2U);
  EXPECT_LT(found.stages.back().to_model.percentile_95, 0.02);
  ASSERT_TRUE(found.stages.back().to_mesh);
  EXPECT_LT(found.stages.back().to_mesh->largest, 0.05);
  const SignedDistance proven(found.model);
  for (const Point& vertex : {Point{3.0, 0.0, 0.0}, Point{5.0, 2.5, 0.0}, Point{5.0, 1.0, 2.5}})
    EXPECT_LT(std::abs(proven(vertex, 1e-6).hi), 0.05);
}

/// Fits a model of so many primitives, and looks at the mesh's vertices.
void expect_contained(const Mesh& mesh, Containment containment, std::size_t primitives) {
  const ContainedRecovery found =
      recover_contained(mesh, containment, {.primitives = primitives, .deviation = 0.05}, {});
  EXPECT_TRUE(found.proof.proven);
  EXPECT_EQ(found.proof.triangles_proven, mesh.triangles.size());
  ASSERT_EQ(found.recovery.stages.back().containment, containment);
  EXPECT_LT(found.recovery.stages.back().to_model.mean, 0.02);
  const SignedDistance proven(found.recovery.model);
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 97) {
    const Enclosure distance = proven(mesh.vertices[i], 1e-6);
    if (containment == Containment::within)
      EXPECT_GE(distance.hi, 0.0);
    else
      EXPECT_LE(distance.lo, 0.0);
  }
}

TEST(RecoveryTest, FitsAModelWithinAMeshAndAUnionAroundIt) {
  Mesh mesh;
  add_ellipsoid(mesh, {0.0, 0.0, 0.0}, {3.0, 2.0, 1.0});
  expect_contained(mesh, Containment::within, 1);
  expect_contained(two_ellipsoids(), Containment::around, 2);
}

/// Its points and edges are as sharp as those of parts may never be.
TEST(RecoveryTest, RecoversOnePointedSuperquadricFromItsMesh) {
  const Model truth{"",
                    {{.name = "pointed",
                      .superquadric = {.semi_axes = {20.0, 15.0, 40.0}, .exponents = {1.8, 0.7}},
                      .pose = {.translation = {3.0, -2.0, 1.0}, .quaternion = {0.9, 0.1, -0.2, 0.3}}}}};
  const Mesh mesh = model_mesh(truth, {.deviation = 0.02}).mesh;
  const Recovery found = recover(mesh, {.primitives = 1});
  EXPECT_LT(found.stages.back().to_model.largest, 1e-3 * 40.0);
  ASSERT_TRUE(found.stages.back().to_mesh);
  EXPECT_LT(found.stages.back().to_mesh->largest, 1e-3 * 40.0);
}

/// A thin plate that reaches far out of a solid is nowhere deep inside itself.
TEST(RecoveryTest, WhatReachesFarOutCountsForHowFarItIs) {
  const recovery::UnionSamples samples{.surface = {Eigen::Vector3d(1.0, 0.0, 0.0)},
                                       .inside = {Eigen::Vector3d(0.5, 0.0, 0.0)},
                                       .outside = {Eigen::Vector3d(0.0, 0.0, 0.5), Eigen::Vector3d(0.0, 0.9, 0.0)},
                                       .beyond = {0.0, 7.0}};
  Shape ball;
  ball.axes = Eigen::Vector3d::Ones();
  const recovery::UnionFit fit(samples, {.size = 1.0}, {ball});
  EXPECT_EQ(fit.residual(1, -0.5), 0.0);
  EXPECT_EQ(fit.residual(2, -0.5), -0.5);
  EXPECT_EQ(fit.residual(3, -0.1), -7.1);
  EXPECT_EQ(fit.residual(3, 0.1), 0.0);
  EXPECT_GT(fit.cost(), 7.0 * 7.0);
}

TEST(RecoveryTest, TheSameSeedGivesTheSameModel) {
  const recovery::SyntheticCloud cloud = recovery::synthetic_cloud(Difficulty::with_outliers, 5);
  std::vector<Point> points;
  for (const Eigen::Vector3d& point : cloud.points) points.push_back({point[0], point[1], point[2]});
  const Primitive a = recover(points, {}).model.primitives.front();
  const Primitive b = recover(points, {}).model.primitives.front();
  EXPECT_EQ(a.superquadric.semi_axes, b.superquadric.semi_axes);
  EXPECT_EQ(a.superquadric.exponents, b.superquadric.exponents);
  EXPECT_EQ(a.pose.translation, b.pose.translation);
  EXPECT_EQ(a.pose.quaternion, b.pose.quaternion);
}

TEST(RecoveryTest, RefusesWhatNoSolidCanBeMadeOf) {
  const auto refused = [](const std::vector<Point>& points, const RecoveryOptions& options = {}) {
    try {
      (void)recover(points, options);
    } catch (const Error& error) {
      return error.kind() == ErrorKind::input;
    }
    return false;
  };
  std::vector<Point> points;
  points.reserve(100);
  for (int i = 0; i < 100; ++i) points.push_back({std::sin(i), std::cos(3.0 * i), 0.0});
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}));
  EXPECT_TRUE(refused(points));
  for (Point& point : points) point[2] = std::cos(point[0] + point[1]);
  EXPECT_FALSE(refused(points));
  EXPECT_TRUE(refused(points, {.primitives = 0}));
  EXPECT_TRUE(refused(points, {.deviation = 0.0}));
  EXPECT_TRUE(refused(points, {.most_outliers = 1.0}));
  points.front()[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(points));
}

TEST(RecoveryTest, TheSpaceAboutAMeshIsDividedAsItsSolidDividesIt) {
  const Mesh mesh = two_ellipsoids();
  const recovery::GridSample sample = recovery::sample_space(mesh, 2000);
  const auto inside = [](const Eigen::Vector3d& p, double grown) {
    const double first = p.cwiseQuotient(Eigen::Vector3d(3.0, 2.0, 1.0)).norm();
    const double second = (p - Eigen::Vector3d(5.0, 1.0, 0.0)).cwiseQuotient(Eigen::Vector3d(1.0, 1.5, 2.5)).norm();
    return std::min(first, second) < grown;
  };
  EXPECT_GT(sample.inside.size(), 100U);
  EXPECT_GT(sample.outside.size(), 1000U);
  for (const Eigen::Vector3d& point : sample.inside) EXPECT_TRUE(inside(point, 1.0));
  for (const Eigen::Vector3d& point : sample.outside) EXPECT_FALSE(inside(point, 0.97));
}

TEST(RecoveryTest, TheTreeFindsTheNearestTriangle) {
  const Mesh mesh{.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 9}, {1, 0, 9}, {0, 1, 9}},
                  .triangles = {{0, 1, 2}, {3, 4, 5}}};
  const verify::TriangleTree tree(verify::triangles_of(mesh));
  const auto expect_enclosed = [&tree](const Point& point, double distance) {
    const Enclosure found = tree.nearest(point).distance;
    EXPECT_LE(found.lo, distance);
    EXPECT_GE(found.hi, distance);
    EXPECT_LT(found.width(), 1e-12);
  };
  expect_enclosed({1.0, 1.0, 3.0}, 3.0);
  expect_enclosed({-3.0, -4.0, 0.0}, 5.0);
  expect_enclosed({3.0, 3.0, 0.0}, std::sqrt(2.0));
  expect_enclosed({0.25, 0.25, 8.0}, 1.0);
}

}  // namespace
}  // namespace verisq::testing
