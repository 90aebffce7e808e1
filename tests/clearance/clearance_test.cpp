/// Certified clearance reports: of spheres against closed forms in MPFR, of rows made by hand.
#include "verisq/clearance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <random>
#include <vector>
#include <verisq/error.hpp>

#include "verify/proof/clearance_claims.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using Number =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>, boost::multiprecision::et_off>;

const Sink<Point> nowhere = [](std::span<const Point>, std::span<const MapResult>, std::span<const Certificate>) {};

Model ball(double radius) {
  return {"mm", {{"ball", {{radius, radius, radius}, {1.0, 1.0}}, {}, {}}}};
}

Number exact_distance(const Point& p, double radius) {
  const Number x = p[0];
  const Number y = p[1];
  const Number z = p[2];
  return sqrt(x * x + y * y + z * z) - Number(radius);
}

/// Eq. (4) in words of its own.
Number exact_fitness(const Fitness& fitness, const Number& distance) {
  const Number apart = (distance - Number(fitness.target)) / Number(fitness.scale);
  const Number inside = distance < 0 ? Number(distance / Number(fitness.scale)) : Number(0);
  return 1 / (1 + apart * apart) - inside * inside;
}

MapResult row(double lo, double hi) {
  return {{lo, hi}, Status::device_verified};
}

/// Points in areas in turn.
Cavity cavity_of(std::vector<Point> points, std::vector<Area> areas) {
  Cavity cavity{.points = std::move(points), .areas = std::move(areas), .area_of = {}};
  for (std::size_t n = 0; n < cavity.points.size(); ++n)
    cavity.area_of.push_back(static_cast<std::uint32_t>(n % cavity.areas.size()));
  return cavity;
}

Cavity random_cavity(std::size_t count, double farthest, std::vector<Area> areas) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> coordinate(-farthest, farthest);
  std::vector<Point> points(count);
  for (Point& point : points) point = {coordinate(engine), coordinate(engine), coordinate(engine)};
  return cavity_of(std::move(points), std::move(areas));
}

TEST(Clearance, EnclosesTheClosedFormsOfABall) {
  const double radius = 4.0;
  const Cavity cavity = random_cavity(500, 4.0, {{"a", 1.0}, {"b", 0.1}, {"c", 0.0}, {"d", 7.5}});
  const Fitness fitness = cementless(2.0, 1.5);
  const Clearance report =
      certified_clearance(ball(radius), cavity, fitness, 1.5, {.tolerance = 1e-9, .device = "host"}, nowhere);

  Number objective = 0;
  Number smallest = infinity;
  std::uint64_t too_deep = 0;
  std::vector<std::uint64_t> within(cavity.areas.size(), 0);
  for (std::size_t n = 0; n < cavity.points.size(); ++n) {
    const Number distance = exact_distance(cavity.points[n], radius);
    objective += cavity.areas[cavity.area_of[n]].weight * exact_fitness(fitness, distance);
    if (distance < smallest) smallest = distance;
    if (distance < -1.5) ++too_deep;
    if (distance >= -1.5 && distance <= 2.0) ++within[cavity.area_of[n]];
  }
  EXPECT_LE(Number(report.objective.lo), objective);
  EXPECT_GE(Number(report.objective.hi), objective);
  EXPECT_LE(report.objective.width(), 1e-5);
  EXPECT_LE(Number(report.smallest_distance.lo), smallest);
  EXPECT_GE(Number(report.smallest_distance.hi), smallest);
  EXPECT_LE(Number(report.deepest_penetration.lo), -smallest);
  EXPECT_GE(Number(report.deepest_penetration.hi), -smallest);
  EXPECT_LE(report.deepest_penetration.width(), 1e-8);
  EXPECT_EQ(report.proven_too_deep, too_deep);
  EXPECT_EQ(report.proven_shallow, cavity.points.size() - too_deep);
  EXPECT_GT(too_deep, 50U);
  ASSERT_EQ(report.areas.size(), 4U);
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_EQ(report.areas[n].area.name, cavity.areas[n].name);
    EXPECT_EQ(report.areas[n].points, 125U);
    EXPECT_EQ(report.areas[n].proven_within, within[n]);
    EXPECT_EQ(report.areas[n].proven_outside, 125U - within[n]);
    EXPECT_EQ(report.areas[n].undecided, 0U);
  }
  EXPECT_EQ(report.map.points, 500U);
  EXPECT_FALSE(report.map.interrupted);
}

TEST(Clearance, IsAsWideAsItsRows) {
  const Cavity cavity = random_cavity(300, 6.0, {{"all", 2.0}});
  const Fitness fitness = cemented(1.0, 0.5);
  const Clearance report =
      certified_clearance(ball(4.0), cavity, fitness, 0.5, {.tolerance = 1.0, .device = "host"}, nowhere);
  Number objective = 0;
  for (const Point& point : cavity.points) objective += 2 * exact_fitness(fitness, exact_distance(point, 4.0));
  EXPECT_LE(Number(report.objective.lo), objective);
  EXPECT_GE(Number(report.objective.hi), objective);
  const AreaClearance& area = report.areas.at(0);
  EXPECT_EQ(area.proven_within + area.proven_outside + area.undecided, 300U);
}

TEST(Clearance, HandsOnTheRows) {
  const Cavity cavity = random_cavity(100, 6.0, {{"all", 1.0}});
  std::vector<Point> points;
  std::vector<MapResult> rows;
  std::size_t certificates = 0;
  const Sink<Point> sink = [&](std::span<const Point> p, std::span<const MapResult> r, std::span<const Certificate> c) {
    points.insert(points.end(), p.begin(), p.end());
    rows.insert(rows.end(), r.begin(), r.end());
    certificates += c.size();
  };
  const Clearance report = certified_clearance(ball(4.0), cavity, cementless(2.0, 0.5), 0.5,
                                               {.tolerance = 1e-6, .device = "host", .certificates = true}, sink);
  EXPECT_EQ(points, cavity.points);
  EXPECT_EQ(rows.size(), 100U);
  EXPECT_EQ(certificates, 100U);
  EXPECT_EQ(report.map.minimum_lo, report.smallest_distance.lo);
  EXPECT_EQ(report.map.minimum_hi, report.smallest_distance.hi);
}

TEST(Clearance, IsOfTheRowsDeliveredWhereItIsInterrupted) {
  const Cavity cavity = random_cavity(100'000, 6.0, {{"all", 1.0}});
  std::size_t delivered = 0;
  const Sink<Point> sink = [&](std::span<const Point>, std::span<const MapResult> rows, std::span<const Certificate>) {
    delivered += rows.size();
  };
  const Clearance report =
      certified_clearance(ball(4.0), cavity, cementless(2.0, 0.5), 0.5,
                          {.tolerance = 1e-3, .device = "host", .interrupted = [&] { return delivered > 100; }}, sink);
  EXPECT_TRUE(report.map.interrupted);
  EXPECT_GT(delivered, 100U);
  EXPECT_LT(delivered, cavity.points.size());
  EXPECT_EQ(report.map.points, delivered);
  EXPECT_EQ(report.areas.at(0).points, delivered);
}

TEST(Clearance, OfNoPointsIsEmpty) {
  const Cavity cavity{{}, {{"all", 1.0}}, {}};
  const Clearance report =
      certified_clearance(ball(4.0), cavity, cementless(2.0, 0.5), 0.5, {.tolerance = 1e-3, .device = "host"}, nowhere);
  EXPECT_EQ(report.objective, (Enclosure{0.0, 0.0}));
  EXPECT_EQ(report.smallest_distance, (Enclosure{infinity, infinity}));
  EXPECT_EQ(report.deepest_penetration, (Enclosure{0.0, 0.0}));
}

TEST(Clearance, RefusesWhatTheMapRefuses) {
  const Cavity cavity = cavity_of({{0.0, infinity, 0.0}}, {{"all", 1.0}});
  EXPECT_THROW((void)certified_clearance(ball(4.0), cavity, cementless(2.0, 0.5), 0.5,
                                         {.tolerance = 1e-3, .device = "host"}, nowhere),
               Error);
}

/// The report of rows made by hand, all in one area of weight 1.
Clearance report_of(std::vector<MapResult> rows, const Fitness& fitness, double limit, double weight = 1.0) {
  const Cavity cavity = cavity_of(std::vector<Point>(rows.size()), {{"all", weight}});
  ClearanceSum sum(cavity.areas, cavity.area_of, fitness, limit);
  sum.add(rows);
  return sum.report();
}

TEST(ClearanceSum, CountsWhatIsProvenAboutTheLimit) {
  const Clearance report = report_of({row(-2.0, -1.5), row(-1.5, -1.0), row(-1.0, -0.5), row(-0.5, 3.0), row(4.0, 5.0)},
                                     cementless(2.0, 1.0), 1.0);
  EXPECT_EQ(report.proven_too_deep, 1U);  // [-1.5, -1] may be just as deep as allowed
  EXPECT_EQ(report.proven_shallow, 3U);
  EXPECT_EQ(report.smallest_distance, (Enclosure{-2.0, -1.5}));
  EXPECT_EQ(report.deepest_penetration, (Enclosure{1.5, 2.0}));
}

TEST(ClearanceSum, CountsWhatIsProvenAboutTheBand) {
  const Clearance report = report_of(
      {row(-1.0, 2.0), row(-1.1, 0.0), row(1.0, 2.1), row(-1.2, -1.1), row(2.1, 2.2), row(2.0, 2.0), row(-3.0, 3.0)},
      cementless(2.0, 1.0), 1.0);
  const AreaClearance& area = report.areas.at(0);
  EXPECT_EQ(area.points, 7U);
  EXPECT_EQ(area.proven_within, 2U);
  EXPECT_EQ(area.proven_outside, 2U);
  EXPECT_EQ(area.undecided, 3U);
}

TEST(ClearanceSum, KnowsNoPenetrationWhereAllIsProvenOutside) {
  EXPECT_EQ(report_of({row(0.5, 1.0), row(0.0, 2.0)}, cementless(2.0, 1.0), 1.0).deepest_penetration,
            (Enclosure{0.0, 0.0}));
  EXPECT_EQ(report_of({row(-0.5, 1.0)}, cementless(2.0, 1.0), 1.0).deepest_penetration, (Enclosure{0.0, 0.5}));
}

TEST(ClearanceSum, HoldsInfiniteEnds) {
  const Fitness fitness = cementless(2.0, 1.0);
  const Clearance unbounded = report_of({row(-infinity, infinity), row(1.0, 1.0)}, fitness, 1.0);
  EXPECT_EQ(unbounded.objective.lo, -infinity);
  EXPECT_GE(unbounded.objective.hi, 1.8);  // 1 at most of the first, 0.8 of the second
  EXPECT_EQ(unbounded.smallest_distance, (Enclosure{-infinity, 1.0}));
  EXPECT_EQ(unbounded.deepest_penetration, (Enclosure{0.0, infinity}));
  EXPECT_EQ(unbounded.areas.at(0).undecided, 1U);
  EXPECT_EQ(unbounded.proven_shallow, 1U);
  const Clearance far_away = report_of({row(5.0, infinity)}, fitness, 1.0);
  EXPECT_LE(far_away.objective.lo, 0.0);
  EXPECT_EQ(far_away.areas.at(0).proven_outside, 1U);
  EXPECT_EQ(report_of({row(-infinity, infinity)}, fitness, 1.0, 0.0).objective, (Enclosure{0.0, 0.0}));
}

TEST(ClearanceSum, EnclosesSumsOfAnySignTightly) {
  // The terms are exact: 1 at the target, and 1/2 - 1 at -scale.
  const Fitness fitness{0.0, 1.0, {-1.0, 1.0}};
  std::vector<MapResult> rows;
  rows.reserve(3000);
  for (int n = 0; n < 3000; ++n) rows.push_back(n % 3 == 0 ? row(0.0, 0.0) : row(-1.0, -1.0));
  const double weight = 0.1;
  const Clearance report = report_of(rows, fitness, 2.0, weight);
  EXPECT_LE(report.objective.lo, 0.0);
  EXPECT_GE(report.objective.hi, 0.0);
  EXPECT_LE(report.objective.width(), 1e-30);

  for (MapResult& one : rows) one = row(0.0, 0.0);
  const Clearance positive = report_of(rows, fitness, 2.0, weight);
  const Number expected = Number(weight) * 3000;
  EXPECT_LE(Number(positive.objective.lo), expected);
  EXPECT_GE(Number(positive.objective.hi), expected);
  EXPECT_LE(positive.objective.hi, std::nextafter(positive.objective.lo, infinity));
}

/// Of members of the rows the order statistics are known: those of the enclosures hold them, and no less would.
TEST(ClearanceSum, EnclosesMeanAndPercentiles) {
  std::vector<MapResult> rows;
  rows.reserve(101);
  for (int n = 0; n <= 100; ++n) rows.push_back(row((37 * n) % 101 - 1.0, (37 * n) % 101 + (n % 2 == 0 ? 0.0 : 0.5)));
  const AreaClearance area = report_of(rows, cementless(2.0, 1.0), 1.0).areas.at(0);
  EXPECT_EQ(area.mean_distance.lo, 49.0);
  const double upper_mean = 50.0 + 50 * 0.5 / 101;
  EXPECT_GE(area.mean_distance.hi, upper_mean);
  EXPECT_LE(area.mean_distance.hi, std::nextafter(upper_mean, infinity));
  EXPECT_EQ(area.median_distance.lo, 49.0);  // the 51st of 101
  EXPECT_THAT(area.median_distance.hi, ::testing::AnyOf(50.0, 50.5));
  EXPECT_EQ(area.distance_of_95.lo, 94.0);  // the 96th
  EXPECT_THAT(area.distance_of_95.hi, ::testing::AnyOf(95.0, 95.5));
  const AreaClearance one = report_of({row(-infinity, 3.0)}, cementless(2.0, 1.0), 1.0).areas.at(0);
  for (const Enclosure& of_one : {one.mean_distance, one.median_distance, one.distance_of_95})
    EXPECT_EQ(of_one, (Enclosure{-infinity, 3.0}));
}

TEST(ClearanceSum, KeepsAreasApart) {
  const Cavity cavity{std::vector<Point>(3), {{"rim", 1.0}, {"floor", 3.0}, {"none", 5.0}}, {1, 0, 1}};
  ClearanceSum sum(cavity.areas, cavity.area_of, {0.0, 1.0, {-1.0, 1.0}}, 2.0);
  sum.add(std::vector{row(0.0, 0.0), row(3.0, 3.5)});
  sum.add(std::vector{row(-1.0, -1.0)});
  const Clearance report = sum.report();
  ASSERT_EQ(report.areas.size(), 3U);
  EXPECT_EQ(report.areas[0].points, 1U);
  EXPECT_EQ(report.areas[0].smallest_distance, (Enclosure{3.0, 3.5}));
  EXPECT_EQ(report.areas[0].proven_outside, 1U);
  EXPECT_EQ(report.areas[1].points, 2U);
  EXPECT_EQ(report.areas[1].smallest_distance, (Enclosure{-1.0, -1.0}));
  EXPECT_EQ(report.areas[1].proven_within, 2U);
  EXPECT_EQ(report.areas[2].points, 0U);
  EXPECT_EQ(report.areas[2].smallest_distance, (Enclosure{infinity, infinity}));
  // 3 * 1 + 1 / (1 + d^2) + 3 * (1/2 - 1) with d in [3, 3.5]
  EXPECT_LE(report.objective.lo, 1.5 + 1.0 / 13.25);
  EXPECT_GE(report.objective.hi, 1.6);
  EXPECT_NEAR(report.objective.lo, 1.5 + 1.0 / 13.25, 1e-14);
  EXPECT_NEAR(report.objective.hi, 1.6, 1e-14);
}

}  // namespace
}  // namespace verisq
