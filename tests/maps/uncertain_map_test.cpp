/// Maps of uncertain models: rows, summary, and certificates that the checker proves again.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/files.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/uncertain_scenes.hpp"
#include "tests/maps/summary_of_rows.hpp"
#include "tests/oracle/in_parallel.hpp"

namespace verisq::oracle {
namespace {

struct Case {
  std::string name;
  std::vector<Primitive> nominal;
  Uncertainty by;
  double point_radius;
  std::string device;

  [[nodiscard]] UncertainModel model() const { return uncertain_model(nominal, by); }
  [[nodiscard]] double tolerance() const { return 1e-6 * bounding_radius(bracket(model()).largest); }
  [[nodiscard]] std::vector<Point> points() const { return points_about(nominal, 40 / nominal.size()); }
  [[nodiscard]] FinishedMap map() const {
    return map_in_memory(
        model(), points(),
        {.tolerance = tolerance(), .device = device, .certificates = true, .point_radius = point_radius});
  }
};

class CheckerOfUncertainModelsTest : public testing::TestWithParam<Case> {};

TEST_P(CheckerOfUncertainModelsTest, ProvesEveryRowAndNoneThatLeavesOutAMember) {
  const Case& scene = GetParam();
  const std::vector<Point> points = scene.points();
  const FinishedMap map = scene.map();
  ASSERT_EQ(map.certificates.size(), points.size());
  const Checker check(scene.model(), scene.point_radius);
  std::vector<std::string> failures(points.size());
  in_parallel(points.size(), [&](std::size_t i) {
    const Enclosure e = map.rows[i].distance;
    const Certificate& certificate = map.certificates[i];
    const auto fail = [&](const char* what) {
      failures[i] += fmt::format("{}: {}, [{}, {}]\n", what, points[i], e.lo, e.hi);
    };
    if (check(points[i], e, certificate).verdict != Verdict::proved) fail("not proved");
    const double step = std::max(1e-3 * e.width(), 1e-9);
    if (check(points[i], {e.lo + step, e.hi}, certificate).verdict == Verdict::proved) fail("proved a higher lo");
    if (check(points[i], {e.lo, e.hi - step}, certificate).verdict == Verdict::proved) fail("proved a lower hi");
    if (check(points[i], {e.hi + 1e-9, e.hi + 1}, certificate).verdict == Verdict::proved) fail("proved past hi");
    if (check(points[i], {e.lo - 1, e.lo - 1e-9}, certificate).verdict != Verdict::refuted && e.lo > 0.0)
      fail("did not refute what lies below lo");
    if (check(points[i], e, {}).verdict == Verdict::proved) fail("proved without a certificate");
  });
  for (const std::string& failure : failures) EXPECT_EQ(failure, "");
}

[[nodiscard]] std::vector<Case> cases() {
  std::vector<Case> result;
  for (const std::string device : {"auto", "host"}) {
    for (const Primitive& object : table_objects()) {
      result.push_back({object.name + "All_" + device, {object}, {0.01, 0.02, 0.01}, 0.0, device});
      result.push_back({object.name + "Points_" + device, {object}, {}, 0.01, device});
    }
    result.push_back({"unionSolids_" + device, three_in_a_row(), {0.01, 0.02, 0.0}, 0.0, device});
    result.push_back({"unionAll_" + device, three_in_a_row(), {0.01, 0.02, 0.01}, 0.02, device});
  }
  return result;
}

INSTANTIATE_TEST_SUITE_P(Cases, CheckerOfUncertainModelsTest, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

TEST(CheckerOfUncertainModelsTest, RefutesWhatLeavesOutTheLargestOrTheSmallestMember) {
  const Case scene{"", {table_objects()[0]}, {.semi_axes = 0.02}, 0.0, "host"};
  const std::vector<Point> points{{2.0, 1.0, 0.5}};
  const Enclosure e = map_in_memory(scene.model(), points, {.tolerance = 0.0, .device = "host"}).rows[0].distance;
  const FinishedMap map =
      map_in_memory(scene.model(), points, {.tolerance = 0.0, .device = "host", .certificates = true});
  const Checker check(scene.model(), 0.0);
  const double middle = 0.5 * (e.lo + e.hi);
  EXPECT_EQ(check(points[0], {middle, e.hi}, map.certificates[0]).verdict, Verdict::refuted);
  EXPECT_EQ(check(points[0], {e.lo, middle}, map.certificates[0]).verdict, Verdict::refuted);
  EXPECT_EQ(check(points[0], {e.lo - 1, e.hi + 1}, map.certificates[0]).verdict, Verdict::proved);
  EXPECT_EQ(check(points[0], {-infinity, infinity}, map.certificates[0]).verdict, Verdict::proved);
}

TEST(CheckerOfUncertainModelsTest, OfSingleNumbersIsThatOfTheExactModel) {
  const std::vector<Primitive> nominal = three_in_a_row();
  const Model model{"", nominal};
  const std::vector<Point> points = points_about(nominal, 5);
  const FinishedMap map = map_in_memory(model, points, {.tolerance = 1e-6, .device = "host", .certificates = true});
  const Checker checker(model);
  const Checker checker_of_intervals(uncertain_model(nominal, {}), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Finding expected = checker(points[i], map.rows[i].distance, map.certificates[i]);
    const Finding found = checker_of_intervals(points[i], map.rows[i].distance, map.certificates[i]);
    EXPECT_EQ(found.verdict, expected.verdict);
    EXPECT_EQ(found.proven, expected.proven);
  }
}

TEST(UncertainMapTest, OfAnExactModelIsTheMap) {
  const std::vector<Primitive> nominal = three_in_a_row();
  const std::vector<Point> points = points_about(nominal, 20);
  const MapOptions options{.tolerance = 1e-6, .certificates = true};
  const FinishedMap expected = map_in_memory(Model{"", nominal}, points, options);
  const FinishedMap found = map_in_memory(uncertain_model(nominal, {}), points, options);
  EXPECT_EQ(found.certificates, expected.certificates);
  ASSERT_EQ(found.rows.size(), expected.rows.size());
  for (std::size_t i = 0; i < found.rows.size(); ++i) {
    EXPECT_EQ(found.rows[i].distance, expected.rows[i].distance);
    EXPECT_EQ(found.rows[i].status, expected.rows[i].status);
  }
  EXPECT_EQ(found.summary.points, expected.summary.points);
  EXPECT_EQ(found.summary.wide, expected.summary.wide);
}

/// 200,000 points: several chunks.
TEST(UncertainMapTest, SummaryAgreesWithTheRows) {
  const UncertainModel model = uncertain_model(std::vector{table_objects()[0]}, {.semi_axes = 0.01});
  RandomCases random(1);
  std::vector<Point> points(200'000);
  for (Point& q : points) {
    const Point u = random.direction();
    const double r = random.uniform(1.3, 4.0);
    q = {r * u[0], r * u[1], r * u[2]};
  }
  const double tolerance = 0.018;  // the width of the enclosures is 0.015 to 0.02: the sizes' own uncertainty
  const FinishedMap map = map_in_memory(model, points, {.tolerance = tolerance});
  ASSERT_EQ(map.rows.size(), points.size());
  for (const auto& [distance, status] : map.rows) EXPECT_EQ(verified(distance, tolerance), status != Status::wide);
  expect_summary_of_rows(map.summary, map.rows);
  EXPECT_GT(map.summary.wide, 0U);
  EXPECT_GT(map.summary.device_verified + map.summary.host_verified, 0U);
  EXPECT_FALSE(map.summary.device.empty());
}

TEST(UncertainMapTest, AnInterruptedMapDeliversWholeRowsInOrder) {
  const UncertainModel model = uncertain_model(three_in_a_row(), {0.01, 0.02, 0.01});
  const std::vector<Point> points(20'000, Point{9.0, 9.0, 9.0});
  int polls = 0;
  const MapOptions options{.tolerance = 1e-3, .device = "host", .interrupted = [&polls] { return ++polls > 2; }};
  const FinishedMap map = map_in_memory(model, points, options);
  EXPECT_TRUE(map.summary.interrupted);
  EXPECT_LT(map.rows.size(), points.size());
  EXPECT_EQ(map.summary.points, map.rows.size());
}

TEST(UncertainMapTest, OfNoPointsIsEmpty) {
  const UncertainModel model = uncertain_model(three_in_a_row(), {0.01, 0.02, 0.01});
  const FinishedMap map = map_in_memory(model, {}, {.tolerance = 1e-3, .device = "host"});
  EXPECT_EQ(map.summary.points, 0U);
  EXPECT_EQ(map.summary.device, "host");
  EXPECT_FALSE(map.summary.interrupted);
}

TEST(UncertainMapTest, ExampleOfAStemWithTolerances) {
  const UncertainModel model = read_uncertain_model(places::example("uncertain_stem.json"));
  EXPECT_FALSE(is_exact(model));
  const Model nominal = read_model(places::example("stem.json"));
  const std::vector<Point> points = points_about(nominal.primitives, 5);
  const FinishedMap outer = map_in_memory(model, points, {.tolerance = 1e-6, .point_radius = 0.0005});
  const FinishedMap inner = map_in_memory(nominal, points, {.tolerance = 1e-6});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE(outer.rows[i].distance.lo, inner.rows[i].distance.hi);
    EXPECT_GE(outer.rows[i].distance.hi, inner.rows[i].distance.lo);
    EXPECT_GE(outer.rows[i].distance.width(), 0.001);
  }
}

}  // namespace
}  // namespace verisq::oracle
