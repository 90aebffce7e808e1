/// Smallest distances along paths: balls against capsules and arcs, any model against distances at many times.
#include "verisq/insertion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::oracle {
namespace {

using verify::RigidPath;
using verisq::testing::expect_error;

constexpr double rounding = 1e-12;  // of closed forms in double, sizes about 10

Primitive ball(const Point& centre, double radius) {
  return {"ball", {{radius, radius, radius}, {1.0, 1.0}}, {centre}, {}};
}

/// A stem of two solids that overlap, one of them turned.
const Model stem{"mm",
                 {{"shaft", {{1.0, 1.4, 6.0}, {0.7, 0.9}}, {{0.0, 0.0, -3.0}, {1.0, 0.1, 0.0, 0.0}}, {}},
                  {"neck", {{0.8, 0.8, 3.0}, {0.4, 1.0}}, {{1.0, 0.5, 3.0}, {0.9, 0.3, -0.2, 0.1}}, {}}},
                 {}};

std::vector<Point> random_points(std::uint64_t seed, std::size_t count, double farthest) {
  RandomCases random(seed);
  std::vector<Point> points(count);
  for (Point& point : points) {
    for (double& coordinate : point) coordinate = random.uniform(-farthest, farthest);
  }
  return points;
}

Pose turned_about_z(double angle, const Point& translation = {}) {
  return {translation, {std::cos(angle / 2), 0.0, 0.0, std::sin(angle / 2)}};
}

std::vector<Pose> curved_path(std::size_t legs) {
  std::vector<Pose> path;
  for (std::size_t k = 0; k <= legs; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(legs);
    path.push_back({{6.0 * (1.0 - s), 2.0 * std::sin(2.0 * s), 9.0 * (1.0 - s)},
                    {1.0, 0.3 * (1.0 - s), -0.2 * s * s, 0.4 - 0.4 * s}});
  }
  return path;
}

Insertion along(std::span<const Pose> path, const Model& model, std::span<const Point> bone, double tolerance) {
  return smallest_distance_along(path, model, bone, {.tolerance = tolerance, .device = "host"});
}

double length(double x, double y, double z) {
  return std::hypot(x, y, z);
}

TEST(Insertion, OfABallAlongALineIsTheDistanceToACapsule) {
  // From (0, 0, -10) to (1, 2, -1), in legs of different lengths.
  std::vector<Pose> path;
  for (const double s : {0.0, 0.1, 0.15, 0.6, 1.0}) path.push_back({{s, 2.0 * s, -10.0 + 9.0 * s}});
  const std::vector<Point> bone = random_points(1, 60, 8.0);
  const Insertion found = along(path, {"", {ball({}, 2.0)}, {}}, bone, 1e-2);
  ASSERT_EQ(found.rows.size(), bone.size());
  for (std::size_t n = 0; n < bone.size(); ++n) {
    const auto& [x, y, z] = bone[n];
    const double s = std::clamp((x + 2.0 * y + 9.0 * (z + 10.0)) / 86.0, 0.0, 1.0);
    const double exact = length(x - s, y - 2.0 * s, z + 10.0 - 9.0 * s) - 2.0;
    EXPECT_LE(found.rows[n].distance.lo, exact + rounding);
    EXPECT_GE(found.rows[n].distance.hi, exact - rounding);
    EXPECT_LE(found.rows[n].distance.width(), 1e-2);
    EXPECT_EQ(found.rows[n].status, Status::host_verified);
  }
  EXPECT_EQ(found.summary.points, bone.size());
  EXPECT_EQ(found.summary.host_verified, bone.size());
  EXPECT_EQ(found.summary.wide, 0U);
  EXPECT_EQ(found.summary.device, "host");
  EXPECT_LE(found.summary.largest_width, 1e-2);
  EXPECT_FALSE(found.summary.interrupted);
}

TEST(Insertion, OfABallThatCirclesIsTheDistanceToAnArc) {
  const double angle = 2.0;
  const std::vector<Pose> path{turned_about_z(0.0), turned_about_z(0.4), turned_about_z(angle)};
  const std::vector<Point> bone = random_points(2, 60, 8.0);
  const Insertion found = along(path, {"", {ball({5.0, 0.0, 0.0}, 1.5)}, {}}, bone, 1e-2);
  for (std::size_t n = 0; n < bone.size(); ++n) {
    const auto& [x, y, z] = bone[n];
    const double polar = std::atan2(y, x);
    const double at_ends =
        std::min(length(x - 5.0, y, z), length(x - 5.0 * std::cos(angle), y - 5.0 * std::sin(angle), z));
    const double exact = (polar >= 0.0 && polar <= angle ? std::hypot(std::hypot(x, y) - 5.0, z) : at_ends) - 1.5;
    EXPECT_LE(found.rows[n].distance.lo, exact + rounding);
    EXPECT_GE(found.rows[n].distance.hi, exact - rounding);
    EXPECT_LE(found.rows[n].distance.width(), 1e-2);
  }
}

/// What the rows claim, against distances of the resting implant at many times.
void expect_contains_the_smallest(const Insertion& found, const std::vector<Pose>& path, const Model& model,
                                  const std::vector<Point>& bone, int times) {
  const RigidPath rigid_path(path);
  const SignedDistance distance(model);
  for (std::size_t n = 0; n < bone.size(); ++n) {
    double smallest = infinity;
    double step = 0.0;  // of the point, half-way to the next time looked at
    for (int k = 0; k <= times; ++k) {
      const double time = rigid_path.last_time() * k / times;
      const double next = rigid_path.last_time() * std::min(k + 1, times) / times;
      const Point local = RigidPath::local_point(rigid_path.nearest_pose(time), bone[n]).centre;
      const Enclosure here = distance(local, 1e-3);
      EXPECT_LE(found.rows[n].distance.lo, here.hi + rounding) << "point " << n << ", time " << time;
      smallest = std::min(smallest, here.lo);
      step = std::max(step, rigid_path.length_up(bone[n], time, next) / 2);
    }
    EXPECT_GE(found.rows[n].distance.hi, smallest - step - rounding);
  }
}

TEST(Insertion, IsNeverAboveTheDistanceOfAPoseOnTheWay) {
  const std::vector<Pose> path = curved_path(7);
  const std::vector<Point> bone = random_points(3, 12, 6.0);
  const Insertion found = along(path, stem, bone, 0.05);
  expect_contains_the_smallest(found, path, stem, bone, 100);
  for (const MapResult& row : found.rows) EXPECT_LE(row.distance.width(), 0.05);
  EXPECT_TRUE(std::ranges::any_of(found.rows, [](const MapResult& row) { return row.distance.hi < 0.0; }));
  EXPECT_TRUE(std::ranges::any_of(found.rows, [](const MapResult& row) { return row.distance.lo > 0.0; }));
}

TEST(Insertion, OfASetOperationIsEnclosedToo) {
  Model bored = stem;
  bored.csg = SetExpression{.operands = {{.primitive = 0}, {.primitive = 1}}, .operation = SetOperation::subtract};
  bored.primitives[0].bend = Bend{0.03, 20.0};
  const std::vector<Pose> path = curved_path(2);
  const std::vector<Point> bone = random_points(4, 5, 5.0);
  const Insertion found = along(path, bored, bone, 0.3);
  expect_contains_the_smallest(found, path, bored, bone, 20);
  for (const MapResult& row : found.rows) EXPECT_LE(row.distance.width(), 0.3);
}

/// The stem's shaft as a mesh of triangles, inscribed.
TEST(Insertion, OfAMeshIsThatOfTheSolidItTessellates) {
  const Mesh ball = verisq::testing::sphere_mesh(4);
  const Point semi_axes{1.0, 1.4, 6.0};
  const Pose pose{{0.0, 0.0, -3.0}, {1.0, 0.1, 0.0, 0.0}};
  const Model solid{"", {{"shaft", {semi_axes, {1.0, 1.0}}, pose}}};
  const Model mesh{"", {mesh_primitive("shaft", verisq::testing::stretched(ball, semi_axes), pose)}};
  const double off = 6.0 * (1.0 + SignedDistance(Model{"", {mesh_primitive("", ball)}})({}, 1e-9).hi);
  const std::vector<Point> points = random_points(9, 150, 5.0);
  const std::vector<Pose> path = curved_path(3);
  const double tolerance = 1e-3;
  const Insertion of_solid = along(path, solid, points, tolerance);
  const Insertion of_mesh = along(path, mesh, points, tolerance);
  EXPECT_EQ(of_mesh.summary.wide, 0U);
  std::size_t cut = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const Enclosure& distance = of_mesh.rows[n].distance;
    EXPECT_LE(distance.width(), tolerance);
    EXPECT_GE(distance.hi, of_solid.rows[n].distance.lo);
    EXPECT_LE(distance.lo, of_solid.rows[n].distance.hi + off);
    if (distance.hi < 0.0) ++cut;
  }
  EXPECT_GT(cut, 5U);
}

TEST(Insertion, IsOfTheMovedModel) {
  // At one pose there is nothing to search: a map of the moved model.
  const Pose pose{{3.0, -2.0, 1.0}, {0.4, -1.0, 2.0, 0.3}};
  const std::vector<Point> bone = random_points(5, 100, 8.0);
  const Insertion found = along(std::vector{pose}, stem, bone, 1e-4);
  const FinishedMap map = map_in_memory(posed(stem, pose), bone, {.tolerance = 1e-4, .device = "host"});
  for (std::size_t n = 0; n < bone.size(); ++n) {
    EXPECT_LE(found.rows[n].distance.lo, map.rows[n].distance.hi + rounding);
    EXPECT_GE(found.rows[n].distance.hi, map.rows[n].distance.lo - rounding);
    EXPECT_LE(found.rows[n].distance.width(), 1e-4 + rounding);
  }
}

TEST(Insertion, AtRestIsTheMap) {
  const std::vector<Point> bone = random_points(6, 100, 8.0);
  const FinishedMap map = map_in_memory(stem, bone, {.tolerance = 1e-3, .device = "host"});
  const Insertion found = along(std::vector<Pose>(1), stem, bone, 1e-3);
  for (std::size_t n = 0; n < bone.size(); ++n) {
    EXPECT_NEAR(found.rows[n].distance.lo, map.rows[n].distance.lo, rounding);
    EXPECT_NEAR(found.rows[n].distance.hi, map.rows[n].distance.hi, rounding);
    EXPECT_LE(found.rows[n].distance.lo, map.rows[n].distance.lo);
    EXPECT_GE(found.rows[n].distance.hi, map.rows[n].distance.hi);
  }
}

TEST(Insertion, OfMoreOfAPathIsNoLarger) {
  const std::vector<Pose> path = curved_path(6);
  const std::vector<Point> bone = random_points(7, 20, 6.0);
  const Insertion whole = along(path, stem, bone, 0.1);
  const Insertion part = along(std::span(path).first(4), stem, bone, 0.1);
  for (std::size_t n = 0; n < bone.size(); ++n) EXPECT_LE(whole.rows[n].distance.lo, part.rows[n].distance.hi);
}

/// On whatever computes here, of which a row may depend on its block.
TEST(Insertion, IsThatOfItsBlocks) {
  const std::vector<Pose> path = curved_path(2);
  const std::vector<Point> bone = random_points(12, 2 * points_per_insertion_block + 100, 9.0);
  const InsertionOptions options{.tolerance = 0.5};
  const Insertion whole = smallest_distance_along(path, stem, bone, options);
  InsertionMapper blocks(path, stem, bone, options);
  for (const std::size_t first : {2 * points_per_insertion_block, std::size_t{0}, points_per_insertion_block}) {
    const std::size_t count = std::min(points_per_insertion_block, bone.size() - first);
    const Insertion part = blocks(first, count);
    ASSERT_EQ(part.rows.size(), count);
    EXPECT_EQ(part.summary.points, count);
    for (std::size_t n = 0; n < count; ++n) {
      EXPECT_EQ(part.rows[n].distance, whole.rows[first + n].distance);
      EXPECT_EQ(part.rows[n].status, whole.rows[first + n].status);
    }
  }
}

TEST(Insertion, TellsHowFarItIs) {
  std::vector<double> told;
  const std::vector<Point> bone = random_points(8, 20, 6.0);
  (void)smallest_distance_along(
      curved_path(4), stem, bone,
      {.tolerance = 0.2, .device = "host", .progress = [&](double done) { told.push_back(done); }});
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(std::ranges::is_sorted(told));
  EXPECT_EQ(told.back(), 1.0);
}

TEST(Insertion, IsValidWhereverItIsInterrupted) {
  const std::vector<Pose> path{{{0.0, 0.0, -10.0}}, {{0.0, 0.0, 0.0}}};
  const std::vector<Point> bone = random_points(9, 300, 8.0);
  bool any_wide = false;
  for (int polls = 0; polls < 24; polls += 3) {
    int polled = 0;
    const Insertion found = smallest_distance_along(
        path, {"", {ball({}, 2.0)}, {}}, bone,
        {.tolerance = 1e-3, .device = "host", .interrupted = [&] { return polled++ >= polls; }});
    EXPECT_TRUE(found.summary.interrupted);
    ASSERT_EQ(found.rows.size(), bone.size());
    for (std::size_t n = 0; n < bone.size(); ++n) {
      const auto& [x, y, z] = bone[n];
      const double exact = length(x, y, z - std::clamp(z, -10.0, 0.0)) - 2.0;
      EXPECT_LE(found.rows[n].distance.lo, exact + rounding);
      EXPECT_GE(found.rows[n].distance.hi, exact - rounding);
      any_wide = any_wide || found.rows[n].status == Status::wide;
    }
    if (polls == 0) {
      EXPECT_EQ(found.rows.front().distance, (Enclosure{-infinity, infinity}));
    }
  }
  EXPECT_TRUE(any_wide);
}

TEST(Insertion, RefusesPathsThatAreNone) {
  const std::vector<Point> bone{{1.0, 2.0, 3.0}};
  const auto message = [&](const std::vector<Pose>& path, const std::string& text) {
    expect_error([&] { (void)along(path, stem, bone, 0.1); }, ErrorKind::input, text, "");
  };
  message({}, "the path has no pose");
  message({{}, {{0.0, infinity, 0.0}}}, "pose 1 of the path, (0, inf, 0), quaternion (1, 0, 0, 0), is not finite");
  message({{{}, {0.0, 0.0, 0.0, 0.0}}},
          "pose 0 of the path, (0, 0, 0), quaternion (0, 0, 0, 0), has a zero quaternion");
}

TEST(Insertion, RefusesWhatTheMapRefuses) {
  const std::vector<Point> bone{{1.0, infinity, 3.0}};
  EXPECT_THROW((void)along(curved_path(1), stem, bone, 0.1), Error);
  EXPECT_THROW((void)smallest_distance_along(curved_path(1), stem, {}, {.tolerance = 0.1, .device = "no such one"}),
               Error);
}

TEST(StraightPath, EndsInTheLastPoseAlongTheDirection) {
  const Pose last{{1.0, 2.0, 3.0}, {0.5, 0.5, 0.5, 0.5}};
  const std::vector<Pose> path = straight_path(last, {0.0, 3.0, 4.0}, 10.0, 4);
  ASSERT_EQ(path.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    const double before = 10.0 - 2.5 * static_cast<double>(k);
    EXPECT_EQ(path[k].quaternion, last.quaternion);
    EXPECT_NEAR(path[k].translation[0], 1.0, 1e-15);
    EXPECT_NEAR(path[k].translation[1], 2.0 - 0.6 * before, 1e-14);
    EXPECT_NEAR(path[k].translation[2], 3.0 - 0.8 * before, 1e-14);
  }
  EXPECT_EQ(path.back().translation, last.translation);
}

TEST(StraightPath, IsAsLongAlongHugeAndTinyDirections) {
  for (const double size : {1e-320, 1e-200, 1e200, 1e308}) {
    const std::vector<Pose> path = straight_path({}, {size, -size, size}, 10.0, 1);
    for (const double t : path.front().translation) EXPECT_NEAR(std::abs(t), 10.0 / std::sqrt(3.0), 1e-14);
  }
}

}  // namespace
}  // namespace verisq::oracle
