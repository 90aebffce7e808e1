/// Distances of uncertain models, one by one and mapped: no members leave the enclosure, and the extreme ones come to
/// its ends. VERISQ_MEMBERS sets how many pairs of members are tried a scene.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/uncertain_scenes.hpp"
#include "tests/oracle/in_parallel.hpp"

namespace verisq::oracle {
namespace {

struct Scene {
  std::string name;
  std::vector<Primitive> a;
  std::vector<Primitive> b;
  Uncertainty of_a;
  Uncertainty of_b;
};

void PrintTo(const Scene& scene, std::ostream* stream) {
  *stream << scene.name;
}

/// In all directions, from deep overlap to far apart; quaternions of any length.
[[nodiscard]] std::vector<Pose> poses_around(std::size_t count) {
  RandomCases random(7);
  std::vector<Pose> poses;
  for (std::size_t n = 0; n < count; ++n) {
    const Point u = random.direction();
    const double r = 8.0 * static_cast<double>(n) / static_cast<double>(count);
    Pose pose{{r * u[0], r * u[1], r * u[2]}, {}};
    for (double& q : pose.quaternion) q = random.uniform(-2, 2);
    poses.push_back(pose);
  }
  return poses;
}

/// Of the distances of the members tried at one pose.
struct Reach {
  double lowest_upper = infinity;  ///< some members are at most so far apart
  double highest_lower = -infinity;
  std::size_t escapes = 0;
};

[[nodiscard]] std::vector<Reach> reach(const std::vector<Model>& of_a, const std::vector<Model>& of_b,
                                       const std::vector<Pose>& poses, const std::vector<Enclosure>& enclosures) {
  std::vector<Reach> reached(poses.size());
  std::mutex mutex;
  in_parallel(of_a.size(), [&](std::size_t m) {
    const PairDistance distance(of_a[m], of_b[m]);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Enclosure of_members = distance(poses[i]).distance;
      const std::lock_guard lock(mutex);
      reached[i].lowest_upper = std::min(reached[i].lowest_upper, of_members.hi);
      reached[i].highest_lower = std::max(reached[i].highest_lower, of_members.lo);
      if (of_members.hi < enclosures[i].lo || of_members.lo > enclosures[i].hi) ++reached[i].escapes;
    }
  });
  return reached;
}

/// Other members than `members` of the same seed would give, so that those of A and of B are independent.
[[nodiscard]] std::vector<Model> other_members(const UncertainModel& model, std::size_t count) {
  std::vector<Model> result = members(model, 2);
  RandomCases random(12);
  while (result.size() < count) result.push_back(any_member(model, random));
  return result;
}

class UncertainPairTest : public testing::TestWithParam<Scene> {};

TEST_P(UncertainPairTest, MembersNeverLeaveTheEnclosure) {
  const auto& [name, nominal_a, nominal_b, by_a, by_b] = GetParam();
  const UncertainModel a = uncertain_model(nominal_a, by_a);
  const UncertainModel b = uncertain_model(nominal_b, by_b);
  const std::vector<Pose> poses = poses_around(12);
  const PairDistance distance(a, b);
  std::vector<Enclosure> enclosures;
  enclosures.reserve(poses.size());
  for (const Pose& pose : poses) enclosures.push_back(distance(pose).distance);
  const std::size_t count = member_count(100);
  const std::vector<Reach> reached = reach(members(a, count), other_members(b, count), poses, enclosures);
  double nearness = 0.0;
  std::size_t judged = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Enclosure& e = enclosures[i];
    EXPECT_EQ(reached[i].escapes, 0U) << fmt::format("pose {}: [{}, {}], members at most {} and at least {}", i, e.lo,
                                                     e.hi, reached[i].lowest_upper, reached[i].highest_lower);
    if (by_a.translation > 0.0 || by_b.translation > 0.0 || e.width() == 0.0) continue;
    const double slack = std::max(reached[i].lowest_upper - e.lo, e.hi - reached[i].highest_lower);
    nearness = std::max(nearness, slack / e.width());
    ++judged;
  }
  if (by_a.translation > 0.0 || by_b.translation > 0.0) return;
  fmt::print("{}: members come within {:.2g} of the width of the ends at {} poses\n", name, nearness, judged);
  EXPECT_LE(nearness, 0.01);
  EXPECT_GE(judged, 3U);
}

[[nodiscard]] std::vector<MapResult> mapped(const UncertainModel& a, const UncertainModel& b,
                                            std::span<const Pose> poses, const MapOptions& options) {
  std::vector<MapResult> rows;
  const Source<Pose> source = [&poses](std::span<Pose> chunk) {
    const std::size_t count = std::min(chunk.size(), poses.size());
    std::ranges::copy(poses.first(count), chunk.begin());
    poses = poses.subspan(count);
    return count;
  };
  const Sink<Pose> sink = [&rows](std::span<const Pose>, std::span<const MapResult> results,
                                  std::span<const Certificate>) {
    rows.insert(rows.end(), results.begin(), results.end());
  };
  const MapSummary summary = PoseMapper(a, b, options).map(source, sink);
  EXPECT_EQ(summary.points, rows.size());
  return rows;
}

TEST_P(UncertainPairTest, MembersNeverLeaveTheRowsOfAMap) {
  const auto& [name, nominal_a, nominal_b, by_a, by_b] = GetParam();
  const UncertainModel a = uncertain_model(nominal_a, by_a);
  const UncertainModel b = uncertain_model(nominal_b, by_b);
  const std::vector<Pose> poses = poses_around(40);
  constexpr double tolerance = 1e-4;
  const std::vector<MapResult> by_host = mapped(a, b, poses, {.tolerance = tolerance, .device = "host"});
  const std::vector<MapResult> by_device = mapped(a, b, poses, {.tolerance = tolerance});
  ASSERT_EQ(by_host.size(), poses.size());
  ASSERT_EQ(by_device.size(), poses.size());
  const PairDistance distance(a, b);
  std::vector<Enclosure> enclosures;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Enclosure of_pair = distance(poses[i]).distance;
    EXPECT_EQ(by_host[i].distance, of_pair);
    enclosures.push_back(by_device[i].distance);
    EXPECT_LE(enclosures[i].width(), of_pair.width() + tolerance);
    EXPECT_EQ(by_device[i].status != Status::wide, verified(enclosures[i], tolerance));
  }
  const std::size_t count = member_count(10);
  const std::vector<Reach> reached = reach(members(a, count), other_members(b, count), poses, enclosures);
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(reached[i].escapes, 0U) << "pose " << i;
}

[[nodiscard]] std::vector<Scene> scenes() {
  const auto object = [](std::size_t i) { return std::vector{table_objects()[i]}; };
  std::vector<Scene> result;
  const auto add = [&result](const std::string& name, const std::vector<Primitive>& a,
                             const std::vector<Primitive>& b) {
    const Uncertainty axes{.semi_axes = 0.02};
    const Uncertainty exponents{.exponents = 0.05};
    const Uncertainty translation{.translation = 0.03};
    const Uncertainty all{.semi_axes = 0.01, .exponents = 0.03, .translation = 0.02};
    result.push_back({name + "Axes", a, b, axes, axes});
    result.push_back({name + "Exponents", a, b, exponents, exponents});
    result.push_back({name + "AxesOfOneExponentsOfOther", a, b, axes, exponents});
    result.push_back({name + "OnlyTheSecond", a, b, {}, axes});
    result.push_back({name + "Translation", a, b, translation, translation});
    result.push_back({name + "All", a, b, all, all});
  };
  add("capsuleGem", object(0), object(1));
  add("gemSoap", object(1), object(2));
  add("capsuleUnion", object(0), three_in_a_row());
  add("unions", three_in_a_row(), three_in_a_row());
  return result;
}

INSTANTIATE_TEST_SUITE_P(Scenes, UncertainPairTest, testing::ValuesIn(scenes()),
                         [](const auto& test) { return test.param.name; });

[[nodiscard]] std::vector<Primitive> ball(double x) {
  return {{"ball", {{1, 1, 1}, {1, 1}}, {{x, 0, 0}, {1, 0, 0, 0}}}};
}

/// Radii of 1 +- 0.1 and of 1 +- 0.2, centres each +- 0.25 along the line between them: 3 +- 0.8.
TEST(UncertainBallsTest, AddUpRadiiAndShiftsOfBoth) {
  UncertainModel a = uncertain_model(ball(0.0), {.semi_axes = 0.1});
  UncertainModel b = uncertain_model(ball(5.0), {.semi_axes = 0.2});
  a.primitives[0].translation[0] = {-0.25, 0.25};
  b.primitives[0].translation[0] = {4.75, 5.25};
  const auto [e, proximity, certificate, complete] = PairDistance(a, b)();
  EXPECT_LE(e.lo, 2.2);
  EXPECT_GE(e.hi, 3.8);
  EXPECT_LE(e.width(), 1.6 + 1e-14);
  EXPECT_EQ(proximity, Proximity::separated);
  EXPECT_TRUE(complete);
}

TEST(UncertainBallsTest, OnlyTheSecondMovesWithThePose) {
  const UncertainModel a = uncertain_model(ball(1.0), {.semi_axes = 0.1});
  const UncertainModel b = uncertain_model(ball(5.0), {.semi_axes = 0.1});
  // Half a turn about z: x = 5 goes to x = -5, six from A's centre.
  const Enclosure e = PairDistance(a, b)({{0, 0, 0}, {0, 0, 0, 3}}).distance;
  EXPECT_LE(e.lo, 3.8);
  EXPECT_GE(e.hi, 4.2);
  EXPECT_LE(e.width(), 0.4 + 1e-14);
}

TEST(UncertainBallsTest, ProximityIsThatOfAllMembers) {
  const auto proximity = [](double x, const Uncertainty& by) {
    return PairDistance(uncertain_model(ball(0.0), by), uncertain_model(ball(x), by))();
  };
  EXPECT_EQ(proximity(2.3, {.semi_axes = 0.1}).proximity, Proximity::separated);
  EXPECT_EQ(proximity(2.1, {.semi_axes = 0.1}).proximity, Proximity::undecided);
  EXPECT_EQ(proximity(1.9, {.semi_axes = 0.1}).proximity, Proximity::undecided);
  EXPECT_EQ(proximity(1.7, {.semi_axes = 0.1}).proximity, Proximity::overlapping);
  EXPECT_EQ(proximity(1.7, {.semi_axes = 0.1}).distance, (Enclosure{0.0, 0.0}));
  EXPECT_EQ(proximity(2.5, {.translation = 0.1}).proximity, Proximity::separated);
  EXPECT_EQ(proximity(1.9, {.translation = 0.1}).proximity, Proximity::undecided);
  EXPECT_EQ(proximity(1.9, {.translation = 0.1}).distance.lo, 0.0);
}

TEST(UncertainBallsTest, HaveNeitherCertificateNorClosestPoints) {
  const PairDistance distance(uncertain_model(ball(0.0), {.semi_axes = 0.1}), Model{"", ball(5.0)});
  const ModelDistance found = distance();
  EXPECT_EQ(found.proximity, Proximity::separated);
  EXPECT_TRUE(found.certificate.separations.empty());
  EXPECT_FALSE(found.certificate.common);
  EXPECT_FALSE(distance.closest_points(found));
}

TEST(UncertainPairOfExactModelsTest, IsThePairDistance) {
  const std::vector<Primitive> a = three_in_a_row();
  const std::vector<Primitive> b = table_objects();
  const PairDistance expected(Model{"", a}, Model{"", b});
  const PairDistance found(uncertain_model(a, {}), uncertain_model(b, {}));
  for (const Pose& pose : poses_around(10)) {
    const ModelDistance of_pair = expected(pose);
    EXPECT_EQ(found(pose).distance, of_pair.distance);
    EXPECT_EQ(found(pose).proximity, of_pair.proximity);
    EXPECT_EQ(found(pose).certificate.common, of_pair.certificate.common);
    EXPECT_EQ(found(pose).certificate.separations.size(), of_pair.certificate.separations.size());
  }
}

TEST(UncertainPairOfExactModelsTest, RefusesShiftsThatOverflow) {
  const UncertainModel a = uncertain_model(ball(0.0), {});
  UncertainModel b = a;
  b.primitives[0].translation = {{{-1.7e308, 1.7e308}, {-1.7e308, 1.7e308}, {0, 0}}};
  EXPECT_THROW(PairDistance(a, b), Error);
  EXPECT_THROW(PairDistance(b, a), Error);
}

}  // namespace
}  // namespace verisq::oracle
