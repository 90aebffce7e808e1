/// Maps of models at uncertain poses against samples of the poses. VERISQ_UNCERTAIN_POSES sets how many are tried of
/// each model.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/uncertain_scenes.hpp"
#include "tests/maps/summary_of_rows.hpp"
#include "tests/oracle/in_parallel.hpp"

namespace verisq::oracle {
namespace {

constexpr double half_a_degree = std::numbers::pi / 360;
constexpr double rounding = 1e-11;  // of the samples, which binary64 computes

struct Motion {
  Eigen::AngleAxisd turn;
  Eigen::Vector3d shift;
};

/// Half of them at the ends of all bounds, where distances are most often the smallest and the largest.
[[nodiscard]] std::vector<Motion> motions(const PoseUncertainty& bounds, std::size_t count, std::uint64_t seed) {
  RandomCases random(seed);
  std::vector<Motion> result;
  for (std::size_t n = 0; n < count; ++n) {
    const bool extreme = n % 2 == 0;
    const auto part = [&] { return extreme ? (random.choice(2) == 0 ? -1.0 : 1.0) : random.uniform(-1, 1); };
    const Point axis = random.direction();
    Motion motion{Eigen::AngleAxisd((extreme ? 1.0 : random.uniform(0, 1)) * bounds.rotation,
                                    Eigen::Vector3d(axis[0], axis[1], axis[2])),
                  {}};
    for (Eigen::Index i = 0; i < 3; ++i) motion.shift[i] = part() * bounds.translation[static_cast<std::size_t>(i)];
    result.push_back(motion);
  }
  return result;
}

[[nodiscard]] Eigen::Vector3d vector(const Point& p) {
  return {p[0], p[1], p[2]};
}

/// The point as the moved model sees it.
[[nodiscard]] Point seen(const Motion& motion, const Point& centre, const Point& point) {
  const Eigen::Vector3d at = motion.turn.inverse() * (vector(point) - vector(centre) - motion.shift) + vector(centre);
  return {at.x(), at.y(), at.z()};
}

struct Scene {
  std::string name;
  Model model;
  PoseUncertainty bounds;
  unsigned divisions;
  double point_radius = 0.0;
  std::string device = "auto";

  [[nodiscard]] FinishedMap map(std::span<const Point> points) const {
    return map_in_memory(model, points,
                         {.tolerance = 1.0,
                          .device = device,
                          .point_radius = point_radius,
                          .pose_uncertainty = bounds,
                          .pose_divisions = divisions});
  }
};

void PrintTo(const Scene& scene, std::ostream* stream) {
  *stream << scene.name;
}

[[nodiscard]] Model of(std::vector<Primitive> primitives) {
  Model model;
  model.primitives = std::move(primitives);
  return model;
}

[[nodiscard]] Model bent() {
  Model model = of({table_objects()[0]});
  model.primitives[0].bend = Bend{0.2, 0.5};
  return model;
}

[[nodiscard]] std::vector<Scene> scenes() {
  const PoseUncertainty small{{0.01, 0.02, 0.005}, half_a_degree, {0.3, -0.2, 1.0}};
  const PoseUncertainty turned{{}, 0.2, {2.0, 0.0, -1.0}};
  const PoseUncertainty any_turn{{0.1, 0.0, 0.0}, 4.0, {0.1, 0.0, 0.0}};
  return {{"shiftAndTurn", of({table_objects()[0]}), small, 16},
          {"shiftAndTurnByHost", of({table_objects()[1]}), small, 8, 0.0, "host"},
          {"widenedAlone", of({table_objects()[2]}), small, 1},
          {"turnAlone", of({table_objects()[1]}), turned, 8},
          {"anyTurn", of({table_objects()[0]}), any_turn, 4},
          {"union", of(three_in_a_row()), small, 8},
          {"unionOfBalls", of(three_in_a_row()), small, 4, 0.02},
          {"bent", bent(), small, 4},
          {"bentWidenedAlone", bent(), small, 1}};
}

class UncertainPoseMapTest : public testing::TestWithParam<Scene> {};

TEST_P(UncertainPoseMapTest, EnclosesTheDistancesAtEveryPose) {
  const Scene& scene = GetParam();
  const std::vector<Point> points = points_about(scene.model.primitives, 4);
  const FinishedMap found = scene.map(points);
  ASSERT_EQ(found.rows.size(), points.size());
  expect_summary_of_rows(found.summary, found.rows);
  const SignedDistance distance(scene.model);
  const auto tried = motions(scene.bounds, requested_count("VERISQ_UNCERTAIN_POSES", 40), 3);
  std::vector<std::string> failures(points.size());
  in_parallel(points.size(), [&](std::size_t i) {
    RandomCases random(i);
    const Enclosure& e = found.rows[i].distance;
    for (const Motion& motion : tried) {
      Point place = seen(motion, scene.bounds.centre, points[i]);
      const Point towards = random.direction();
      for (std::size_t k = 0; k < 3; ++k) place[k] += scene.point_radius * towards[k];
      const Enclosure exact = distance(place, 1e-4);
      if (exact.hi < e.lo - rounding || exact.lo > e.hi + rounding) {
        failures[i] = fmt::format("{}: [{}, {}] leaves out [{}, {}]", points[i], e.lo, e.hi, exact.lo, exact.hi);
      }
    }
  });
  for (const std::string& failure : failures) EXPECT_EQ(failure, "");
}

INSTANTIATE_TEST_SUITE_P(All, UncertainPoseMapTest, testing::ValuesIn(scenes()),
                         [](const auto& scene) { return scene.param.name; });

/// A flat solid and a point next to it that a turn takes from its surface, whose squares underflow. The oracle's
/// distance at a place that is allowed was found by MPFR.
TEST(UncertainPoseMap, HoldsForSolidsOfAnySize) {
  for (const int exponent : {0, 537, 1037}) {
    const auto sized = [exponent](double x) { return std::ldexp(x, exponent); };
    const Primitive flat{"flat", {{sized(1e-161), sized(1e-161), sized(1e-163)}, {1.0, 1.0}}, {}, {}};
    const Scene scene{"", of({flat}), {{}, radians_up(0.05), {}}, 1, 0.0, "host"};
    const FinishedMap found = scene.map(std::vector<Point>{{sized(1.7e-162), 0.0, 0.0}});
    ASSERT_EQ(found.rows.size(), 1U);
    const Enclosure& e = found.rows[0].distance;
    EXPECT_GE(e.hi, sized(-9.70607333819580953e-164)) << exponent;
    EXPECT_LE(e.hi, sized(-9.6e-164)) << exponent;
    EXPECT_LE(e.lo, sized(-9.85e-164)) << exponent;
    EXPECT_GE(e.lo, sized(-1.02e-163)) << exponent;
  }
}

TEST(UncertainPoseMap, KnowsPointsNextToTheCentreOfRotation) {
  const Primitive ball{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}, {}};
  const Scene scene{"", of({ball}), {{}, radians_up(1.0), {}}, 1, 0.0, "host"};
  const std::vector<Point> points{{1e-200, 2e-200, 0.0}, {0.0, 0.0, 1e-162}, {0.0, 5e-324, 0.0}, {0.0, 0.0, 0.0}};
  for (const MapResult& row : scene.map(points).rows) {
    EXPECT_TRUE(row.distance.contains(-1.0));
    EXPECT_LE(row.distance.width(), 1e-9);
  }
}

/// The smallest and the largest of the distances at sampled poses.
[[nodiscard]] Enclosure hull_of_samples(const SignedDistance& distance, const PoseUncertainty& bounds,
                                        std::span<const Motion> tried, const Point& point) {
  Enclosure hull{infinity, -infinity};
  for (const Motion& motion : tried) {
    const Enclosure at = distance(seen(motion, bounds.centre, point), 1e-4);
    hull = {std::min(hull.lo, at.hi), std::max(hull.hi, at.lo)};
  }
  return hull;
}

/// A stem's sizes in millimetres: half a millimetre and half a degree.
TEST(UncertainPoseMap, IsLittleWiderThanTheDistancesDiffer) {
  const Model model = of({{"stem", {{7.0, 5.0, 50.0}, {0.8, 0.7}}, {{0.0, 0.0, 0.0}, {0.9, 0.1, -0.2, 0.3}}}});
  const Scene scene{"stem", model, {{0.5, 0.5, 0.5}, half_a_degree, {0.0, 0.0, 40.0}}, 16};
  const std::vector<Point> points = points_about(model.primitives, 3);
  const FinishedMap found = scene.map(points);
  const SignedDistance distance(model);
  const auto tried = motions(scene.bounds, 800, 4);
  std::vector<double> ratios(points.size());
  in_parallel(points.size(), [&](std::size_t i) {
    const Enclosure hull = hull_of_samples(distance, scene.bounds, tried, points[i]);
    EXPECT_TRUE(found.rows[i].distance.lo <= hull.lo && hull.hi <= found.rows[i].distance.hi);
    ratios[i] = found.rows[i].distance.width() / hull.width();
  });
  EXPECT_LE(std::ranges::max(ratios), 1.2);
}

TEST(UncertainPoseMap, EnclosesTheDistancesOfTrianglesAndOfPairs) {
  const PoseUncertainty bounds{{0.01, 0.02, 0.005}, half_a_degree, {0.3, -0.2, 1.0}};
  const Model model = of(three_in_a_row());
  const std::vector<Triangle> triangles{{{{0, 2, 0}, {4, 2, 0}, {2, 2, 1}}}, {{{0, 0, 0.7}, {0, 0, 2}, {1, 1, 2}}}};
  std::vector<MapResult> rows(triangles.size());
  TriangleMapper(model, {.tolerance = 1.0, .device = "host", .pose_uncertainty = bounds}).map(triangles, rows);
  const auto tried = motions(bounds, 40, 5);
  std::vector<MapResult> moved(1);
  TriangleMapper exact(model, {.tolerance = 1e-9, .device = "host"});
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const Motion& motion : tried) {
      Triangle place;
      for (std::size_t k = 0; k < 3; ++k) place[k] = seen(motion, bounds.centre, triangles[i][k]);
      exact.map(std::vector<Triangle>{place}, moved);
      EXPECT_LE(rows[i].distance.lo, moved[0].distance.hi + rounding);
      EXPECT_GE(rows[i].distance.hi, moved[0].distance.lo - rounding);
    }
  }

  const Pose pose{{0.0, 4.0, 0.5}, {0.9, 0.1, -0.2, 0.3}};
  const Model b = of({table_objects()[1]});
  std::vector<MapResult> row(1);
  PoseMapper(model, b, {.tolerance = 1.0, .device = "host", .pose_uncertainty = bounds})
      .map(std::vector<Pose>{pose}, row);
  const PairDistance pair(model, b);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]).normalized();
  const Eigen::Vector3d centre = turn * vector(bounds.centre) + vector(pose.translation);
  for (const Motion& motion : tried) {
    const Eigen::Quaterniond turned = motion.turn * turn;
    const Eigen::Vector3d at = motion.turn * (vector(pose.translation) - centre) + centre + motion.shift;
    const Enclosure e = pair({{at.x(), at.y(), at.z()}, {turned.w(), turned.x(), turned.y(), turned.z()}}).distance;
    EXPECT_LE(row[0].distance.lo, e.lo + rounding);
    EXPECT_GE(row[0].distance.hi, e.hi - rounding);
  }
}

TEST(UncertainPoseMap, RefusesWhatItCannotKeep) {
  const Model model = of({table_objects()[0]});
  const PoseUncertainty bounds{{0.1, 0.1, 0.1}, 0.0, {}};
  const auto make = [&](const MapOptions& options) { return PointMapper(model, options); };
  EXPECT_THROW(make({.tolerance = 0.0, .device = "host", .pose_uncertainty = bounds}), Error);
  EXPECT_THROW(make({.tolerance = 1.0, .device = "host", .certificates = true, .pose_uncertainty = bounds}), Error);
  EXPECT_THROW(make({.tolerance = 1.0, .device = "host", .pose_uncertainty = bounds, .pose_divisions = 0}), Error);
  EXPECT_THROW(
      TriangleMapper(model, {.tolerance = 1.0, .device = "host", .pose_uncertainty = bounds, .pose_divisions = 2}),
      Error);
}

}  // namespace
}  // namespace verisq::oracle
