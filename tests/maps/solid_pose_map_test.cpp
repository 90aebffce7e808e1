/// Distances of bent solids and set operations for many poses: those of single searches, in order, interrupted or not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/maps/summary_of_rows.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {
namespace {

SetExpression leaf(std::uint32_t primitive) {
  return {.primitive = primitive};
}

Model bent_rod() {
  return {"", {{"rod", {{0.5, 0.7, 3.0}, {0.6, 0.8}}, {{0.2, -0.1, 0.3}, {0.9, 0.1, 0.3, 0.2}}, Bend{0.3, 40.0}}}};
}

/// A ball less a larger part of another one: its centre is not in it.
Model bowl() {
  return {"",
          {{"ball", {{2.0, 2.0, 2.0}, {1.0, 1.0}}, {}}, {"hollow", {{1.7, 1.7, 1.7}, {1.0, 1.0}}, {{0.0, 0.0, 0.6}}}},
          SetExpression{{leaf(0), leaf(1)}, SetOperation::subtract}};
}

Model ball() {
  return {"", {{"ball", {{0.5, 0.5, 0.5}, {1.0, 1.0}}, {}}}};
}

std::vector<Pose> poses_around(std::size_t count, double farthest) {
  RandomCases random(7);
  std::vector<Pose> poses;
  for (std::size_t n = 0; n < count; ++n) {
    const Point u = random.direction();
    const double r = farthest * static_cast<double>(n) / static_cast<double>(count);
    Pose pose{{r * u[0], r * u[1], r * u[2]}, {}};
    for (double& q : pose.quaternion) q = random.uniform(-2, 2);
    poses.push_back(pose);
  }
  return poses;
}

struct Mapped {
  std::vector<MapResult> rows;
  MapSummary summary;
};

Mapped map(PoseMapper& mapper, std::span<const Pose> poses) {
  Mapped result;
  const auto source = [&poses](std::span<Pose> chunk) {
    const std::size_t count = std::min(chunk.size(), poses.size());
    std::ranges::copy(poses.first(count), chunk.begin());
    poses = poses.subspan(count);
    return count;
  };
  const auto sink = [&result](std::span<const Pose> mapped, std::span<const MapResult> rows,
                              std::span<const Certificate> certificates) {
    EXPECT_EQ(mapped.size(), rows.size());
    EXPECT_TRUE(certificates.empty());
    result.rows.insert(result.rows.end(), rows.begin(), rows.end());
  };
  result.summary = mapper.map(source, sink);
  return result;
}

class SolidPoseMapTest : public ::testing::TestWithParam<std::pair<Model, Model>> {};

TEST_P(SolidPoseMapTest, RowsAreThoseOfSingleSearches) {
  const auto& [a, b] = GetParam();
  const std::vector<Pose> poses = poses_around(12, 8.0);  // some take seconds: those beside the bowl's rim
  constexpr double tolerance = 1e-4;
  PoseMapper mapper(a, b, {.tolerance = tolerance});
  const Mapped found = map(mapper, poses);
  ASSERT_EQ(found.rows.size(), poses.size());
  expect_summary_of_rows(found.summary, found.rows);
  EXPECT_EQ(found.summary.device, "host");
  EXPECT_EQ(found.summary.notice, "") << "nothing was asked for that it cannot do";
  // Where the ball is as near to all of the bowl's rim, searches end with what they have.
  EXPECT_LE(found.summary.wide, poses.size() / 3);
  const ModelSearch search(a, b);
  std::size_t apart = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Enclosure& row = found.rows[i].distance;
    EXPECT_EQ(verified(row, tolerance), found.rows[i].status == Status::host_verified);
    if (row.lo > 0.0) ++apart;
    if (i % 3 != 0) continue;
    const Enclosure one = search(poses[i], {.tolerance = 1e-6}).distance;
    EXPECT_LE(row.lo, one.hi) << i;
    EXPECT_GE(row.hi, one.lo) << i;
  }
  EXPECT_GT(apart, 4U);
}

TEST_P(SolidPoseMapTest, WidensRowsOfUncertainPoses) {
  const auto& [a, b] = GetParam();
  std::vector<Pose> poses = poses_around(4, 24.0);
  poses.erase(poses.begin());  // there searches take long
  constexpr double moved = 0.05;
  PoseMapper mapper(a, b,
                    {.tolerance = 0.2, .pose_uncertainty = PoseUncertainty{.translation = {moved, moved, moved}}});
  const Mapped found = map(mapper, poses);
  const ModelSearch search(a, b);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const double step : {-moved, moved}) {
      Pose there = poses[i];
      there.translation[i % 3] += step;
      const Enclosure one = search(there, {.tolerance = 1e-5}).distance;
      EXPECT_LE(found.rows[i].distance.lo, one.lo + 1e-12);
      EXPECT_GE(found.rows[i].distance.hi, one.hi - 1e-5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pairs, SolidPoseMapTest,
                         ::testing::Values(std::pair(bent_rod(), ball()), std::pair(ball(), bent_rod()),
                                           std::pair(bowl(), ball()), std::pair(ball(), bowl())));

/// A search ends where it is, and its row and those after it are not told; the mapper serves again.
TEST(SolidPoseMap, EndsWithinAChunk) {
  const std::vector<Pose> poses = poses_around(200, 8.0);
  std::atomic<int> polls = 0;
  std::atomic<bool> ends = true;
  PoseMapper mapper(bowl(), bent_rod(), {.tolerance = 1e-9, .interrupted = [&] { return ends && ++polls > 20; }});
  const Mapped found = map(mapper, poses);
  EXPECT_TRUE(found.summary.interrupted);
  EXPECT_LT(found.rows.size(), poses.size());
  for (const MapResult& row : found.rows) EXPECT_NE(row.status, Status::wide);
  ends = false;
  const std::vector<Pose> far(20, Pose{{9.0, 0.0, 0.6}, {1.0, 0.0, 0.0, 0.0}});
  EXPECT_EQ(map(mapper, far).rows.size(), far.size());
}

TEST(SolidPoseMap, TellsWhatIsKnownWhenTheTimeIsUp) {
  const std::vector<Pose> poses = poses_around(20, 8.0);
  PoseMapper mapper(bowl(), ball(), {.tolerance = 1e-9, .out_of_time = [] { return true; }});
  const Mapped found = map(mapper, poses);
  ASSERT_EQ(found.rows.size(), poses.size());
  EXPECT_TRUE(found.summary.out_of_time);
  const ModelSearch search(bowl(), ball());
  for (std::size_t i = poses.size() / 2; i < poses.size(); i += 3) {
    const Enclosure one = search(poses[i], {.tolerance = 1e-4}).distance;
    EXPECT_LE(found.rows[i].distance.lo, one.lo);
    EXPECT_GE(found.rows[i].distance.hi, one.lo);
    EXPECT_TRUE(std::isfinite(found.rows[i].distance.hi));
  }
}

TEST(SolidPoseMap, IsAsTightAsSearchesAre) {
  const std::vector<Pose> poses = poses_around(8, 8.0);
  PoseMapper mapper(bent_rod(), ball(), {.tolerance = 0.0});
  const Mapped found = map(mapper, poses);
  EXPECT_EQ(found.summary.wide, 0U);
  EXPECT_LE(found.summary.largest_width, 4e-9 * bounding_radius(bent_rod()));
}

TEST(SolidPoseMap, HugeTranslations) {
  std::vector<Pose> poses;
  for (const double r : {1e5, 1e10, 1e20, 1e100, 1e200, 1e300, 1e308}) {
    for (std::size_t i = 0; i < 3; ++i) {
      Pose pose{{0.0, 0.0, 0.0}, {0.5, -0.1, 0.3, 0.7}};
      pose.translation[i] = i == 1 ? -r : r;
      poses.push_back(pose);
    }
  }
  PoseMapper mapper(bowl(), bent_rod(), {.tolerance = 1e-6});
  const Mapped found = map(mapper, poses);
  ASSERT_EQ(found.rows.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double r = std::ranges::max(poses[i].translation, {}, [](double t) { return std::fabs(t); });
    EXPECT_LE(found.rows[i].distance.lo, std::fabs(r)) << i;
    EXPECT_GE(found.rows[i].distance.hi, std::fabs(r) - 8.0) << i;
  }
}

TEST(SolidPoseMap, RefusesWhatItLacks) {
  const auto refused = [](const UncertainModel& a, const MapOptions& options, const std::string& message) {
    testing::expect_error([&] { (void)PoseMapper(a, ball(), options); }, ErrorKind::input, "", message);
  };
  refused(bent_rod(), {.tolerance = 1e-3, .certificates = true}, "maps of poses have no certificates");
  refused(bent_rod(), {.tolerance = 1e-3, .point_radius = 0.1}, "maps of poses have no points with a radius");
  Model nothing = bowl();
  nothing.primitives[1] = {"all", {{3.0, 3.0, 3.0}, {1.0, 1.0}}, {}};
  refused(nothing, {.tolerance = 1e-3}, "the model has no point at all: its set operations leave nothing");
  PoseMapper mapper(bent_rod(), ball(), {.tolerance = 1e-3});
  const std::vector<Pose> none{{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}}};
  testing::expect_error([&] { (void)map(mapper, none); }, ErrorKind::input, "pose (0, 0, 0)",
                        ", quaternion (0, 0, 0, 0) has a zero quaternion");
}

}  // namespace
}  // namespace verisq::oracle
