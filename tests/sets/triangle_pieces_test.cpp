/// Pieces cover their triangle, their points belong to it, and balls bound the distance of all of them.
#include "verify/search/triangle_pieces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <utility>
#include <vector>
#include <verisq/enclosure.hpp>

#include "tests/fixtures/random.hpp"

namespace verisq::verify {
namespace {

using testing::Random;
using Exact = boost::multiprecision::cpp_rational;

/// Twice the area in the plane of weights, with its sign.
Exact area(const Piece& piece) {
  const auto side = [&](std::size_t i, std::size_t k) { return Exact(Exact(piece[i][k]) - Exact(piece[0][k])); };
  return side(1, 0) * side(2, 1) - side(1, 1) * side(2, 0);
}

/// w_0 t_0 + w_1 t_1 + w_2 t_2, exactly.
std::array<Exact, 3> exact_point(const Triangle& triangle, const Weights& weights) {
  std::array<Exact, 3> result;
  const Exact first = Exact(1) - Exact(weights[0]) - Exact(weights[1]);
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = first * Exact(triangle[0][i]) + Exact(weights[0]) * Exact(triangle[1][i]) +
                Exact(weights[1]) * Exact(triangle[2][i]);
  return result;
}

Exact squared_distance(const std::array<Exact, 3>& a, const Point& b) {
  Exact sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += (a[i] - Exact(b[i])) * (a[i] - Exact(b[i]));
  return sum;
}

Triangle random_triangle(Random& random, double size) {
  return {random.point(size), random.point(size), random.point(size)};
}

TEST(TrianglePiecesTest, HalvesCoverThePieceExactly) {
  Random random(1);
  for (int chain = 0; chain < 50; ++chain) {
    Piece piece = whole_triangle;
    for (int depth = 0; depth < 60; ++depth) {
      const auto parts = halves(piece, static_cast<std::size_t>(random.uniform(0.0, 3.0)));
      if (!parts) break;
      // Of the same sense, with the piece's own corners and one on its edge: their areas add up to its own.
      EXPECT_EQ(area((*parts)[0]) + area((*parts)[1]), area(piece));
      EXPECT_EQ(area((*parts)[0]), area((*parts)[1]));
      EXPECT_GT(area((*parts)[0]), 0);
      for (const Piece& part : *parts) EXPECT_TRUE(std::ranges::all_of(part, in_triangle));
      piece = (*parts)[random.uniform(0.0, 1.0) < 0.5 ? 0 : 1];
    }
  }
}

TEST(TrianglePiecesTest, HalvingEndsWhereBinary64HasNoPlaceForTheMiddle) {
  Piece piece = whole_triangle;
  int depth = 0;
  while (const auto parts = halves(piece, 0)) {
    piece = (*parts)[0];
    ++depth;
  }
  EXPECT_EQ(depth, 50);
}

TEST(TrianglePiecesTest, RoundedWeightsAreThoseOfATrianglesPoint) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Weights wanted{random.uniform(-0.1, 1.1), random.uniform(-0.1, 1.1)};
    EXPECT_TRUE(in_triangle(rounded_into_triangle(wanted))) << wanted[0] << ' ' << wanted[1];
  }
  EXPECT_TRUE(in_triangle(rounded_into_triangle({1.0 / 3.0, 2.0 / 3.0})));
}

TEST(TrianglePiecesTest, CornersAreThoseOfTheTriangle) {
  Random random(3);
  for (const double size : {1e-300, 1.0, 1e300}) {
    const Triangle triangle = random_triangle(random, size);
    EXPECT_EQ(DividedTriangle(triangle).corners(whole_triangle), triangle);
  }
}

TEST(TrianglePiecesTest, PointsAreTheTrianglesButForWhatUpperBoundsAdd) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const double size = std::ldexp(1.0, static_cast<int>(random.uniform(-1070.0, 1000.0)));
    Triangle triangle = random_triangle(random, size);
    if (i % 3 == 0) triangle[1] = triangle[0];
    const DividedTriangle divided(triangle);
    const Weights weights = rounded_into_triangle({random.uniform(0.0, 1.0), random.uniform(0.0, 1.0)});
    const Exact error = divided.upper_by_point(0.0);
    EXPECT_LE(squared_distance(exact_point(triangle, weights), divided.point(weights)), error * error) << size;
    EXPECT_LE(error, Exact(size) * Exact(0x1p-48) + Exact(0x1p-1050));
  }
}

/// The signed distance of a point x is at least that of c less |x - c|: of the half-space beyond a plane through all
/// that a lower end says, with equality where x - c is normal to it.
TEST(TrianglePiecesTest, NoPointOfThePieceIsBelowTheBoundByABall) {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const Triangle triangle = random_triangle(random, 1.0);
    const DividedTriangle divided(triangle);
    Piece piece = whole_triangle;
    for (int depth = static_cast<int>(random.uniform(0.0, 12.0)); depth > 0; --depth)
      piece = halves(piece, static_cast<std::size_t>(random.uniform(0.0, 3.0)))->at(0);
    const Point centre = random.point(3.0);
    const double lo = random.uniform(-1.0, 5.0);
    const double bound = divided.lower_by_ball(divided.corners(piece), centre, lo);
    double tightest = infinity;
    for (const Weights& corner : piece) {
      const Exact radius = Exact(lo) - Exact(bound);
      EXPECT_LE(squared_distance(exact_point(triangle, corner), centre), radius * radius);
      const Point x = divided.point(corner);
      tightest = std::min(tightest, lo - std::hypot(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]));
    }
    EXPECT_GE(bound, tightest - 1e-13);
  }
}

TEST(TrianglePiecesTest, NothingIsKnownByNothing) {
  const Triangle triangle{Point{0.0, 0.0, 0.0}, Point{1.0, 0.0, 0.0}, Point{0.0, 1.0, 0.0}};
  const DividedTriangle divided(triangle);
  EXPECT_EQ(divided.lower_by_ball(triangle, {}, -infinity), -infinity);
  EXPECT_EQ(divided.upper_by_point(infinity), infinity);
  EXPECT_EQ(divided.upper_by_point(-1.0), 0.0);
  // Ways that overflow.
  const Triangle huge{Point{1e308, 1e308, 0.0}, Point{-1e308, 0.0, 0.0}, Point{0.0, 1e308, 0.0}};
  EXPECT_EQ(DividedTriangle(huge).lower_by_ball(huge, {-1e308, -1e308, 0.0}, 1e308), -infinity);
}

}  // namespace
}  // namespace verisq::verify
