/// Maps that run out of time: what is known without a search, and that every row is delivered with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>
#include <verisq/map.hpp>

#include "host/maps/certified_rows.hpp"
#include "host/maps/map_run.hpp"
#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/places.hpp"
#include "verify/search/octree_cube.hpp"

namespace verisq {
namespace {

using oracle::FinishedMap;
using oracle::map_in_memory;
using verify::CoarseDistance;
using verify::CoarseProof;

std::vector<Point> random_points(std::size_t count, double reach, const Point& centre = {}) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> along(-reach, reach);
  std::vector<Point> points(count);
  for (Point& p : points) {
    for (std::size_t i = 0; i < 3; ++i) p[i] = centre[i] + along(generator);
  }
  return points;
}

Primitive ball(const Point& centre, double radius) {
  return {"ball", {{radius, radius, radius}, {1, 1}}, {centre, {1, 0, 0, 0}}};
}

double distance(const Point& x, const Point& y) {
  return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

void expect_contains(const Enclosure& e, double exact, const Point& x) {
  EXPECT_LE(e.lo, exact + 1e-14) << x[0] << ' ' << x[1] << ' ' << x[2];
  EXPECT_GE(e.hi, exact - 1e-14) << x[0] << ' ' << x[1] << ' ' << x[2];
}

// ---------------------------------------------------------------- without a search

TEST(CoarseDistanceTest, OfABallLacksNoMoreThanTheCornersOfItsBox) {
  const Point centre{0.5, -1, 2};
  const CoarseDistance coarse({"", {ball(centre, 2.0)}}, {{centre, {-2.0, -2.0}}});
  for (const Point& x : random_points(2000, 6.0, centre)) {
    const Enclosure found = coarse(x);
    const double exact = distance(x, centre) - 2.0;
    expect_contains(found, exact, x);
    EXPECT_NEAR(found.hi, exact, 1e-14);  // the way from the centre
    EXPECT_LE(found.width(), 2.0 * (std::sqrt(3.0) - 1.0) + 1e-14);
  }
}

TEST(CoarseDistanceTest, KnowsTheBoxWhereNoDistanceIsKnown) {
  const CoarseDistance coarse({"", {ball({}, 2.0)}}, {});
  for (const Point& x : random_points(2000, 5.0)) {
    expect_contains({coarse(x).lo, HUGE_VAL}, distance(x, {}) - 2.0, x);
    EXPECT_EQ(coarse(x).hi, HUGE_VAL);
  }
  EXPECT_NEAR(coarse({5, 0, 0}).lo, 3.0, 1e-14);
  EXPECT_NEAR(coarse({5, 0, 6}).lo, 5.0, 1e-14);
  EXPECT_NEAR(coarse({0.5, 0, 1}).lo, -1.0, 1e-14);
  EXPECT_NEAR(coarse({0, 2, 0}).lo, 0.0, 1e-14);
}

TEST(CoarseDistanceTest, InfiniteDistancesSayNothing) {
  const CoarseDistance coarse({"", {ball({}, 2.0)}}, {{{1, 1, 1}, {-HUGE_VAL, HUGE_VAL}}});
  EXPECT_NEAR(coarse({5, 0, 0}).lo, 3.0, 1e-14);
  EXPECT_EQ(coarse({5, 0, 0}).hi, HUGE_VAL);
}

TEST(CoarseProofTest, OfPointsIsWhatTheCertificateProves) {
  const Model model{"", {ball({0.5, -1, 2}, 1.0), ball({1.5, 0, 2}, 1.5)}};
  const CoarseProof coarse(model);
  const Checker checker(model);
  const SignedDistance exact(model);
  std::size_t inside = 0;
  for (const Point& x : random_points(300, 3.0, {1, 0, 2})) {
    const auto [found, certificate] = coarse(x);
    EXPECT_EQ(checker(x, found, certificate).verdict, Verdict::proved);
    const Enclosure tight = exact(x, 1e-9);
    EXPECT_LE(found.lo, tight.hi);
    EXPECT_GE(found.hi, tight.lo);
    EXPECT_LE(found.width(), 8.0);
    inside += tight.hi < 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, 10U);
}

TEST(CoarseProofTest, OfTrianglesIsWhatTheCertificateProves) {
  const Model model{"", {ball({0.5, -1, 2}, 1.0), ball({1.5, 0, 2}, 1.5)}};
  const CoarseProof coarse(model);
  const Checker checker(model);
  const std::vector<Point> corners = random_points(300, 5.0);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const Triangle triangle{corners[i], corners[i + 1], corners[i + 2]};
    const auto [found, certificate] = coarse(triangle);
    EXPECT_EQ(checker(triangle, found, certificate).verdict, Verdict::proved);
    EXPECT_GE(found.lo, 0.0);
    EXPECT_LE(found.hi, 20.0);
  }
}

/// A limit may leave a million rows: some hundred get an enclosure that takes a fraction of a millisecond.
TEST(LateRowsTest, AreToldInAMomentAfterTheFirst) {
  const Model model{"", {ball({0.5, -1, 2}, 1.0), ball({1.5, 0, 2}, 1.5)}};
  LateRows late(model);
  const Checker checker(model);
  const Point x{6, 0, 2};
  const Triangle triangle{x, {7, 0, 2}, {6, 1, 2}};
  for (int run = 0; run < 2; ++run) {
    for (std::size_t n = 0; n < LateRows::first_rows; ++n) ASSERT_TRUE(std::isfinite(late.next(x).distance.hi)) << n;
    const auto [of_point, none] = late.next(x);
    EXPECT_EQ(none, Certificate{});
    EXPECT_NEAR(of_point.lo, 4.5 - 1.5 * std::sqrt(3.0), 1e-9);  // spheres hold their primitives' boxes
    EXPECT_EQ(of_point.hi, HUGE_VAL);
    EXPECT_EQ(checker(x, of_point, none).verdict, Verdict::proved);
    const auto [of_triangle, nothing] = late.next(triangle);
    EXPECT_EQ(of_triangle, (Enclosure{0.0, HUGE_VAL}));
    EXPECT_EQ(checker(triangle, of_triangle, nothing).verdict, Verdict::proved);
    late.begin_anew();
  }
}

TEST(SignedDistanceTest, AnInterruptedSearchIsValidAndWide) {
  const Model model = read_model(places::example("bent_stem.json"));
  const SignedDistance search(model);
  for (const Point& x : random_points(40, 0.3, {0, 0, -0.2})) {
    const Enclosure tight = search(x, 1e-8);
    int polled = 0;
    const Enclosure early = search(x, 1e-8, [&] { return ++polled > 5; });
    EXPECT_LE(polled, 12);  // one search for each side of the surface
    EXPECT_LE(early.lo, tight.hi);
    EXPECT_GE(early.hi, tight.lo);
  }
}

// ---------------------------------------------------------------- maps

MapOptions limited(const std::string& device, double tolerance, std::atomic<int>& polls_left) {
  return {.tolerance = tolerance, .device = device, .out_of_time = [&polls_left] { return --polls_left < 0; }};
}

TEST(TimeLimitTest, EveryRowIsDeliveredInOrder) {
  const Model model = read_model(places::example("bent_stem.json"));
  const std::vector<Point> points = random_points(700, 0.35, {0, 0, -0.2});
  constexpr double tolerance = 1e-6;
  const FinishedMap all = map_in_memory(model, points, {.tolerance = tolerance, .device = "host"});
  EXPECT_EQ(all.summary.wide, 0U);
  EXPECT_FALSE(all.summary.out_of_time);
  for (const std::string device : {"host", "auto"}) {
    for (const int polls : {0, 1, 5, 400, 40'000, 1'000'000'000}) {
      SCOPED_TRACE(device + " " + std::to_string(polls));
      std::atomic<int> polls_left = polls;
      const FinishedMap map = map_in_memory(model, points, limited(device, tolerance, polls_left));
      ASSERT_EQ(map.rows.size(), points.size());
      EXPECT_FALSE(map.summary.interrupted);
      EXPECT_EQ(map.summary.points, points.size());
      EXPECT_EQ(map.summary.out_of_time, map.summary.wide > 0);
      if (polls == 0) {
        EXPECT_EQ(map.summary.wide, points.size());
      }
      if (polls == 1'000'000'000) {
        EXPECT_EQ(map.summary.wide, 0U);
      }
      for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& [found, status] = map.rows[i];
        const Enclosure& proven = all.rows[i].distance;
        ASSERT_TRUE(found.lo <= proven.hi && found.hi >= proven.lo)
            << i << ": [" << found.lo << ", " << found.hi << "]";
        EXPECT_LE(found.width(), 0.8);
        EXPECT_EQ(status == Status::wide, !verified(found, tolerance));
      }
    }
  }
}

TEST(TimeLimitTest, WithCertificatesEveryRowIsProven) {
  const Model model = read_model(places::example("stem.json"));
  const Checker checker(model);
  const std::vector<Point> points = random_points(200, 0.3, {0, 0, -0.2});
  for (const std::string device : {"host", "auto"}) {
    for (const int polls : {0, 30}) {
      std::atomic<int> polls_left = polls;
      MapOptions options = limited(device, 1e-6, polls_left);
      options.certificates = true;
      const FinishedMap map = map_in_memory(model, points, options);
      ASSERT_EQ(map.rows.size(), points.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(checker(points[i], map.rows[i].distance, map.certificates[i]).verdict, Verdict::proved) << i;
        EXPECT_TRUE(std::isfinite(map.rows[i].distance.width()));
      }
    }
  }
}

TEST(TimeLimitTest, PosesAreBoundedByCentres) {
  const Model a{"", {ball({1, 0, 0}, 1.0)}};
  const Model b{"", {ball({0, 2, 0}, 0.5)}};
  std::atomic<int> polls_left = 0;
  PoseMapper mapper(a, b, limited("host", 1e-9, polls_left));
  std::vector<MapResult> rows;
  bool read = false;
  const auto source = [&](std::span<Pose> poses) -> std::size_t {
    if (read) return 0;
    read = true;
    // A quarter of a turn about z takes the second ball to x = -2.
    std::ranges::copy(std::array{Pose{{9, 0, 0}, {1, 0, 0, 1}}, Pose{{1, -2, 0}, {1, 0, 0, 0}}}, poses.begin());
    return 2;
  };
  const auto sink = [&](std::span<const Pose>, std::span<const MapResult> some, std::span<const Certificate>) {
    rows.assign(some.begin(), some.end());
  };
  const MapSummary summary = mapper.map(source, sink);
  EXPECT_TRUE(summary.out_of_time);
  ASSERT_EQ(rows.size(), 2U);
  expect_contains(rows[0].distance, 4.5, {});
  EXPECT_NEAR(rows[0].distance.hi, 6.0, 1e-14);
  EXPECT_EQ(rows[1].distance, (Enclosure{0.0, 0.0}));
}

TEST(ChunkPaceTest, KeepsChunksShortAndLarge) {
  ChunkPace pace;
  const std::size_t first = pace.size();
  EXPECT_LE(first, 100U);
  for (int i = 0; i < 20; ++i) pace.took(1e-6);
  const std::size_t largest = pace.size();
  EXPECT_GE(largest, 10'000U);
  EXPECT_LE(largest, 100'000U);
  pace.took(0.2);
  EXPECT_EQ(pace.size(), largest);
  pace.took(1.0);
  EXPECT_LT(pace.size(), largest);
  for (int i = 0; i < 20; ++i) pace.took(1.0);
  EXPECT_LT(pace.size(), first);
  EXPECT_GT(pace.size(), 0U);
}

}  // namespace
}  // namespace verisq
