/// What corners and centre prove of a piece of a triangle, against distances at many of its points.
#include "verify/proof/triangle_piece.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/deviation/brute_force.hpp"
#include "tests/fixtures/random.hpp"

namespace verisq::verify {
namespace {

using testing::Random;

double length(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Signed distance to a ball, to a union of two, or to the complement of a ball, whose boundaries are closed sets
/// alike.
struct Solid {
  std::vector<std::pair<Point, double>> balls;
  bool complement = false;

  /// Outside a union the least distance; inside only where a point is in one alone and nearest to that one's boundary.
  [[nodiscard]] double operator()(const Point& x) const {
    double nearest = infinity;
    for (const auto& [centre, radius] : balls) nearest = std::min(nearest, length(x, centre) - radius);
    return complement ? -nearest : nearest;
  }
};

constexpr double rounding = 1e-14;

Enclosure about(double x) {
  return {x - rounding, x + rounding};
}

TrianglePiece piece_of(const Triangle& triangle, const Solid& solid, bool convex) {
  TrianglePiece piece{.corners = triangle, .triangle = 0, .convex = convex};
  for (std::size_t i = 0; i < 3; ++i) piece.at_corners[i] = about(solid(triangle[i]));
  piece.at_centre = about(solid(centre(triangle)));
  return piece;
}

/// Distances on a fine grid of equal cells, at their centroids.
std::vector<double> sampled(const Triangle& triangle, const Solid& solid) {
  constexpr int steps = 40;
  std::vector<double> distances;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; i + j < steps; ++j) {
      for (const double third : {1.0 / 3.0, 2.0 / 3.0}) {
        if (third > 0.5 && i + j + 2 > steps) continue;
        Point p;
        for (std::size_t k = 0; k < 3; ++k) {
          p[k] = triangle[0][k] + (i + third) / steps * (triangle[1][k] - triangle[0][k]) +
                 (j + third) / steps * (triangle[2][k] - triangle[0][k]);
        }
        distances.push_back(std::abs(solid(p)));
      }
    }
  }
  return distances;
}

void expect_sound(const Triangle& triangle, const Solid& solid, bool convex) {
  const TrianglePiece piece = piece_of(triangle, solid, convex);
  const PieceDistances found = distances_on(piece, shape_of(triangle, 0.0));
  const std::vector<double> distances = sampled(triangle, solid);
  double sum = 0.0;
  for (const double d : distances) {
    ASSERT_GE(d, found.range.lo - 1e-12);
    ASSERT_LE(d, found.range.hi + 1e-12);
    sum += d;
  }
  const auto count = static_cast<double>(distances.size());
  const double size = length(triangle[0], triangle[1]) + length(triangle[0], triangle[2]);
  const double grid_error = size / 40.0 * 0.5;  // of sums over the grid: far below it where d is smooth
  EXPECT_GE(sum / count, found.mean.lo - 0.1 * grid_error);
  EXPECT_LE(sum / count, found.mean.hi + 0.1 * grid_error);
  const WeightedCell cell{{1.0, 1.0}, found.range, found.mean, found.affine};
  for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    const double limit = found.range.lo + share * (found.range.hi - found.range.lo);
    const Enclosure part = part_up_to(cell, limit);
    const auto counted = static_cast<double>(std::ranges::count_if(distances, [&](double d) { return d <= limit; }));
    EXPECT_GE(counted / count, part.lo - 0.08);  // of a row of the grid and more
    EXPECT_LE(counted / count, part.hi + 0.08);
  }
}

Triangle random_triangle(Random& random) {
  const Point middle = random.point(2.0);
  const double size = std::pow(10.0, random.uniform(-2.0, 0.5));
  Triangle triangle{};
  for (Point& corner : triangle) {
    const Point off = random.point(size);
    for (std::size_t i = 0; i < 3; ++i) corner[i] = middle[i] + off[i];
  }
  return triangle;
}

TEST(TrianglePiece, HoldsTheDistancesToABall) {
  Random random(1);
  for (int n = 0; n < 300; ++n) {
    const Solid ball{.balls = {{random.point(0.5), random.uniform(0.3, 2.0)}}};
    const Triangle triangle = random_triangle(random);
    expect_sound(triangle, ball, false);
    expect_sound(triangle, ball, true);
  }
}

TEST(TrianglePiece, HoldsTheDistancesToAnyClosedSet) {
  Random random(2);
  for (int n = 0; n < 300; ++n) {
    // The least of two signed distances is the distance to a closed set where it is positive: no radius, two points.
    const Solid points{.balls = {{random.point(2.0), 0.0}, {random.point(2.0), 0.0}}, .complement = n % 2 == 0};
    expect_sound(random_triangle(random), points, false);
  }
}

TEST(TrianglePiece, ConvexityMakesThinDistancesKnown) {
  // Corners on the unit sphere: without convexity nothing is known but Lipschitz bounds.
  Triangle triangle{Point{0.1, 0.0, 0.0}, Point{-0.05, 0.09, 0.0}, Point{-0.05, -0.09, 0.0}};
  for (Point& corner : triangle) corner[2] = std::sqrt(1.0 - corner[0] * corner[0] - corner[1] * corner[1]);
  const Solid ball{.balls = {{{0, 0, 0}, 1.0}}};
  const PieceShape shape = shape_of(triangle, 0.0);
  const double depth = -ball(centre(triangle));
  EXPECT_GT(distances_on(piece_of(triangle, ball, false), shape).range.hi, 10.0 * depth);
  EXPECT_LT(distances_on(piece_of(triangle, ball, true), shape).range.hi, 3.01 * depth);
}

TEST(TrianglePiece, HalvesMeetAtTheLongestSide) {
  const Triangle triangle{Point{0, 0, 0}, Point{4, 0, 0}, Point{1, 1, 0}};
  const Solid ball{.balls = {{{0, 0, 3}, 1.0}}};
  const LongestSide side = longest_side(triangle);
  EXPECT_EQ(side.middle, (Point{2, 0, 0}));
  const auto parts = halves(piece_of(triangle, ball, false), side, about(ball(side.middle)));
  EXPECT_EQ(parts[0].corners, (Triangle{Point{0, 0, 0}, Point{2, 0, 0}, Point{1, 1, 0}}));
  EXPECT_EQ(parts[1].corners, (Triangle{Point{2, 0, 0}, Point{4, 0, 0}, Point{1, 1, 0}}));
  EXPECT_EQ(parts[0].halvings, 1);
  EXPECT_EQ(parts[0].at_corners[1], about(ball(side.middle)));
}

TEST(WeightedCells, MeanAndPercentilesOfKnownOnes) {
  std::vector<WeightedCell> cells;
  for (int i = 1; i <= 100; ++i) {
    const Enclosure value{static_cast<double>(i), i + 0.5};
    cells.push_back({{1.0, 1.0}, value, value});
  }
  const Enclosure mean = mean_of(cells);
  EXPECT_LE(mean.lo, 50.5);
  EXPECT_NEAR(mean.lo, 50.5, 1e-12);
  EXPECT_NEAR(mean.hi, 51.0, 1e-12);
  const Distribution distribution(cells);
  EXPECT_EQ(distribution.percentile(50.0), (Enclosure{50.0, 50.5}));
  EXPECT_EQ(distribution.percentile(94.5), (Enclosure{95.0, 95.5}));
  EXPECT_EQ(distribution.percentile(100.0), (Enclosure{100.0, 100.5}));
  EXPECT_EQ(distribution.percentile(0.5), (Enclosure{1.0, 1.5}));
}

/// Whole numbers from 1, each known exactly.
std::vector<WeightedCell> whole_numbers(int count) {
  std::vector<WeightedCell> cells;
  for (int i = 1; i <= count; ++i) {
    const Enclosure value{static_cast<double>(i), static_cast<double>(i)};
    cells.push_back({{1.0, 1.0}, value, value});
  }
  return cells;
}

// In thousandths of a percent: the rank is the least integer that is at least n p / 100.
TEST(WeightedCells, RanksAreExact) {
  Random random(4);
  for (int n = 0; n < 2000; ++n) {
    const auto count = static_cast<int>(random.uniform(1.0, 400.0));
    const std::array<int, 4> steps{1, 100, 1000, 12500};
    const int step = steps[static_cast<std::size_t>(n) % steps.size()];
    const int thousandths = step * static_cast<int>(random.uniform(1.0, 100000.0 / step + 0.999));
    const std::int64_t product = static_cast<std::int64_t>(thousandths) * count;
    const auto rank = static_cast<double>((product + 99999) / 100000);
    const std::vector<WeightedCell> cells = whole_numbers(count);
    EXPECT_EQ(Distribution(cells).percentile(thousandths / 1000.0), (Enclosure{rank, rank}))
        << count << " of " << thousandths;
  }
  const std::vector<WeightedCell> thousand = whole_numbers(1000);
  EXPECT_EQ(Distribution(thousand).percentile(99.9), (Enclosure{999.0, 999.0}));  // 99.9 in binary64 is above 99.9
  EXPECT_TRUE(Distribution(whole_numbers(3)).percentile(100.0 / 3.0).contains(1.0));
}

TEST(WeightedCells, AffineBoundsNarrowPercentiles) {
  // d is the height over a right triangle: half of its area lies up to 1 - 1/sqrt(2).
  const std::vector<WeightedCell> cells{
      {{1.0, 1.0}, {0.0, 1.0}, {0.3, 0.4}, {.values = {0.0, 0.0, 1.0}, .below = 0.0, .above = 0.0}}};
  const Enclosure median = Distribution(cells).percentile(50.0);
  const double exact = 1.0 - std::sqrt(0.5);
  EXPECT_LE(median.lo, exact);
  EXPECT_GE(median.hi, exact);
  EXPECT_LE(median.width(), 1e-3);
}

}  // namespace
}  // namespace verisq::verify
