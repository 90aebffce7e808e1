/// The search over parts of a triangle, told distances of closed form: it contains the exact distance whatever it is
/// told, and asks for few points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>

#include "tests/fixtures/random.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/solid_triangle_distance.hpp"

namespace verisq::verify {
namespace {

using testing::Random;
using Answer = TriangleBranchAndBound::Answer;
using Oracle = std::function<Answer(const Point&)>;

double length_of(const Point& v) {
  return std::hypot(v[0], v[1], v[2]);
}

Enclosure about(double value, double width) {
  return {value - 0.5 * width, value + 0.5 * width};
}

constexpr double rounding = 1e-14;

/// The unit ball.
Answer of_ball(const Point& x) {
  return {about(length_of(x) - 1.0, rounding), x};
}

/// All but the interior of the ball of radius 2: concave, with a distance of 2 - |x| within.
Answer of_hollow(const Point& x) {
  return {about(2.0 - length_of(x), rounding), {-x[0], -x[1], -x[2]}};
}

double distance_to_ball(const Triangle& t) {
  return std::max(0.0, length_of(closest_to_origin(t[0], t[1], t[2])) - 1.0);
}

/// |x| is convex: largest at a corner.
double distance_to_hollow(const Triangle& t) {
  return std::max(0.0, 2.0 - std::max({length_of(t[0]), length_of(t[1]), length_of(t[2])}));
}

struct Found {
  Enclosure distance;
  std::size_t asked;
  bool finished;
};

Found search(const Triangle& triangle, const Oracle& oracle, double tolerance, std::size_t most = 20'000) {
  TriangleBranchAndBound search(triangle, {{0.0, 0.0, 0.0}, 1.0}, tolerance);
  std::vector<Point> points;
  std::vector<Answer> answers;
  while (!search.finished() && search.asked() < most) {
    points.clear();
    answers.clear();
    search.ask(points);
    for (const Point& point : points) answers.push_back(oracle(point));
    search.answer(answers);
  }
  return {search.enclosure(), search.asked(), search.finished()};
}

Triangle random_triangle(Random& random, double reach, double size) {
  const Point corner = random.point(reach);
  Triangle triangle{corner, corner, corner};
  for (std::size_t i = 1; i < 3; ++i) triangle[i] = along(corner, random.point(size), 1.0);
  return triangle;
}

/// A corner, a segment, a needle and an ordinary one in turn.
Triangle some_triangle(Random& random, int i, double reach, double size) {
  Triangle triangle = random_triangle(random, reach, size);
  if (i % 8 == 1) triangle[2] = triangle[1] = triangle[0];
  if (i % 8 == 3) triangle[2] = triangle[1];
  if (i % 8 == 5) triangle[2] = along(triangle[0], difference(triangle[1], triangle[0]), 0.5);
  return triangle;
}

struct Case {
  std::string name;
  Oracle oracle;
  std::function<double(const Triangle&)> exact;
  double reach;
};

std::vector<Case> cases() {
  return {{"ball", of_ball, distance_to_ball, 3.0}, {"hollow", of_hollow, distance_to_hollow, 1.5}};
}

TEST(TriangleBranchAndBoundTest, ContainsTheExactDistance) {
  constexpr double tolerance = 1e-6;
  Random random(1);
  for (const Case& each : cases()) {
    for (const double size : {1e-9, 1e-3, 0.1, 1.0, 10.0}) {
      for (int i = 0; i < 200; ++i) {
        const Triangle triangle = some_triangle(random, i, each.reach, size);
        const Found found = search(triangle, each.oracle, tolerance);
        const double exact = each.exact(triangle);
        EXPECT_LE(found.distance.lo, exact + 1e-13) << each.name << ' ' << size << ' ' << i;
        EXPECT_GE(found.distance.hi, exact - 1e-13) << each.name << ' ' << size << ' ' << i;
        EXPECT_LE(found.distance.width(), tolerance) << each.name << ' ' << size << ' ' << i;
        EXPECT_GE(found.distance.lo, 0.0);
        EXPECT_TRUE(found.finished);
      }
    }
  }
}

TEST(TriangleBranchAndBoundTest, HugeTrianglesTouchAndMiss) {
  for (const double size : {1e3, 1e6}) {
    const Triangle above{Point{-size, -size, 1.25}, Point{size, -size, 1.25}, Point{0.0, size, 1.25}};
    const Found missing = search(above, of_ball, 1e-6);
    EXPECT_TRUE(missing.distance.contains(0.25)) << missing.distance.lo << ' ' << missing.distance.hi;
    EXPECT_LE(missing.distance.width(), 1e-6 + 1e-12 * size);
    Triangle through = above;
    for (Point& corner : through) corner[2] = 0.5;
    EXPECT_EQ(search(through, of_ball, 1e-6).distance, (Enclosure{0.0, 0.0}));
    Triangle touching = above;
    for (Point& corner : touching) corner[2] = 1.0;
    const Found met = search(touching, of_ball, 1e-6);
    EXPECT_EQ(met.distance.lo, 0.0);
    EXPECT_LE(met.distance.hi, 1e-6);
  }
}

/// Two points as a rule: what is nearest, and a ball's centre beyond it.
TEST(TriangleBranchAndBoundTest, SmallTrianglesTakeFewPoints) {
  Random random(2);
  for (const Case& each : cases()) {
    std::size_t asked = 0;
    constexpr int count = 500;
    for (int i = 0; i < count; ++i) asked += search(random_triangle(random, each.reach, 0.01), each.oracle, 1e-6).asked;
    EXPECT_LE(asked, 4U * count) << each.name;
  }
}

/// Directions propose only: wrong ones, or none, cost points and nothing else.
TEST(TriangleBranchAndBoundTest, WrongDirectionsNeverMakeItWrong) {
  Random random(3);
  for (const Case& each : cases()) {
    for (int i = 0; i < 200; ++i) {
      const Oracle misled = [&](const Point& x) {
        Answer answer = each.oracle(x);
        answer.direction = i % 2 == 0 ? random.point(1.0) : Point{};
        return answer;
      };
      const Triangle triangle = some_triangle(random, i, each.reach, 0.1);
      const Found found = search(triangle, misled, 1e-4, 3000);
      const double exact = each.exact(triangle);
      EXPECT_LE(found.distance.lo, exact + 1e-13) << each.name << ' ' << i;
      EXPECT_GE(found.distance.hi, exact - 1e-13) << each.name << ' ' << i;
      if (i % 2 == 1) {
        EXPECT_LE(found.distance.width(), 1e-4) << each.name << " " << i;
      }
    }
  }
}

/// As where a point takes a search that ends early.
TEST(TriangleBranchAndBoundTest, WideAnswersMakeValidAndWideEnclosures) {
  Random random(4);
  for (const Case& each : cases()) {
    for (int i = 0; i < 200; ++i) {
      const Oracle wide = [&](const Point& x) {
        const Answer exact = each.oracle(x);
        const double below = std::pow(10.0, random.uniform(-9.0, 0.0));
        const double above = std::pow(10.0, random.uniform(-9.0, 0.0));
        return Answer{{exact.distance.lo - below, exact.distance.hi + above}, exact.direction};
      };
      const Triangle triangle = some_triangle(random, i, each.reach, 0.3);
      const Found found = search(triangle, wide, 1e-6, 500);
      const double exact = each.exact(triangle);
      EXPECT_LE(found.distance.lo, exact + 1e-13) << each.name << ' ' << i;
      EXPECT_GE(found.distance.hi, exact - 1e-13) << each.name << ' ' << i;
    }
  }
}

TEST(TriangleBranchAndBoundTest, EndsWhereNothingIsEverTold) {
  const Oracle nothing = [](const Point&) { return Answer{{-infinity, infinity}, {}}; };
  const Triangle triangle{Point{1.0, 2.0, 3.0}, Point{2.0, 2.0, 3.0}, Point{1.0, 3.0, 3.0}};
  const Found found = search(triangle, nothing, 1e-6, 1000);
  EXPECT_EQ(found.distance, (Enclosure{0.0, infinity}));
}

TEST(TriangleBranchAndBoundTest, IsValidAtAnyTime) {
  const Triangle triangle{Point{-3.0, -2.0, 1.5}, Point{4.0, -3.0, 1.25}, Point{0.0, 5.0, 1.5}};
  const double exact = distance_to_ball(triangle);
  Enclosure before{0.0, infinity};
  for (std::size_t most = 1; most < 60; ++most) {
    const Found found = search(triangle, of_ball, 1e-9, most);
    EXPECT_TRUE(found.distance.lo <= exact + 1e-13 && found.distance.hi >= exact - 1e-13) << most;
    EXPECT_LE(found.distance.hi, before.hi);
    before = found.distance;
  }
}

}  // namespace
}  // namespace verisq::verify
