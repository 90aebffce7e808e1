/// Triangles of polygons: they cover what the polygon bounds and nothing else, or the polygon is refused.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <verisq/enclosure.hpp>

#include "host/files/mesh_file.hpp"

namespace verisq {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Triangle = std::array<std::uint32_t, 3>;
using Polygon = std::vector<Point>;

/// Twice the signed area, of integers small enough to be exact.
double doubled_area(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point& a = polygon[k];
    const Point& b = polygon[(k + 1) % polygon.size()];
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return sum;
}

/// By crossings of a ray to the right. Precondition: no corner is as high as the point.
bool holds(const Polygon& polygon, double x, double y) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point& a = polygon[k];
    const Point& b = polygon[(k + 1) % polygon.size()];
    if ((a[1] > y) == (b[1] > y)) continue;
    if (a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x) inside = !inside;
  }
  return inside;
}

/// Their areas add up to the polygon's, with its sign each, and each one's middle is inside: so they cover it once.
void expect_covered(const Polygon& polygon) {
  const PolygonTriangles found = triangles_of_polygon(polygon);
  ASSERT_EQ(found.defect, "");
  ASSERT_EQ(found.triangles.size(), polygon.size() - 2);
  double sum = 0.0;
  const double whole = doubled_area(polygon);
  for (const auto& [a, b, c] : found.triangles) {
    const Polygon triangle{polygon[a], polygon[b], polygon[c]};
    const double area = doubled_area(triangle);
    EXPECT_GT(area * whole, 0.0);
    sum += area;
    // Off the rational middle, whose height a corner may have.
    const auto middle = [&](std::size_t i) {
      return 0.3313 * triangle[0][i] + 0.3347 * triangle[1][i] + 0.334 * triangle[2][i];
    };
    EXPECT_TRUE(holds(polygon, middle(0), middle(1)));
  }
  EXPECT_EQ(sum, whole);
}

/// Every corner as the first one, both ways around.
void expect_covered_from_everywhere(Polygon polygon) {
  for (int way = 0; way < 2; ++way) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      expect_covered(polygon);
      std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    }
    std::ranges::reverse(polygon);
  }
}

const Polygon letter_l{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
const Polygon comb{{0, 0, 0}, {7, 0, 0}, {7, 4, 0}, {6, 1, 0}, {5, 4, 0},
                   {4, 1, 0}, {3, 4, 0}, {2, 1, 0}, {1, 4, 0}, {0, 1, 0}};
const Polygon square_with_corners_in_lines{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {3, 2, 0},
                                           {3, 3, 0}, {2, 3, 0}, {1, 3, 0}, {0, 3, 0}, {0, 2, 0}, {0, 1, 0}};

TEST(PolygonTriangles, ConvexOnesAreFansAroundTheFirstCorner) {
  EXPECT_THAT(triangles_of_polygon(Polygon{{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {2, 2, 0}, {0, 2, 0}}).triangles,
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4}));
  // Bent ones, too: the file says no better which surface is meant.
  EXPECT_THAT(triangles_of_polygon(Polygon{{0, 0, 0.5}, {2, 0, 0}, {2, 2, 0.5}, {0, 2, 0}}).triangles,
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(PolygonTriangles, ConcaveOnesAreCovered) {
  expect_covered_from_everywhere(letter_l);
  expect_covered_from_everywhere(comb);
  expect_covered_from_everywhere({{0, 0, 0}, {4, 1, 0}, {0, 2, 0}, {1, 1, 0}});  // a dart
}

TEST(PolygonTriangles, CornersInALineAreCorners) {
  expect_covered_from_everywhere({{0, 0, 0}, {10, 0, 0}, {10, 5, 0}, {10, 10, 0}, {0, 10, 0}});
  expect_covered_from_everywhere(square_with_corners_in_lines);
  expect_covered_from_everywhere({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 3, 0}});
}

/// Diagonals run through other corners and along edges.
TEST(PolygonTriangles, StaircasesAreCovered) {
  for (const int steps : {3, 20}) {
    Polygon stairs;
    for (int k = 0; k < steps; ++k) {
      stairs.push_back({static_cast<double>(k), static_cast<double>(k), 0});
      stairs.push_back({static_cast<double>(k + 1), static_cast<double>(k), 0});
    }
    stairs.push_back({static_cast<double>(steps), static_cast<double>(steps), 0});
    stairs.push_back({0, static_cast<double>(steps), 0});
    expect_covered_from_everywhere(stairs);
  }
}

/// Stars about a point are simple, whatever their radii; on a coarse grid corners come to lie in lines. Rounded corners
/// may make a star touch itself, which is refused.
TEST(PolygonTriangles, RandomStarsAreCovered) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> radius(1.0, 20.0);
  int covered = 0;
  for (int n = 0; n < 600; ++n) {
    const std::size_t count = 4 + random() % 30;
    Polygon star;
    for (std::size_t k = 0; k < count; ++k) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
      const double r = radius(random);
      star.push_back({std::round(r * std::cos(angle)), std::round(r * std::sin(angle)), 0});
    }
    if (!triangles_of_polygon(star).defect.empty()) continue;
    expect_covered(star);
    ++covered;
  }
  EXPECT_GT(covered, 150);
}

TEST(PolygonTriangles, SpiralsAreCoveredInTheirOwnPlane) {
  constexpr int turns = 40;
  Polygon outer;
  Polygon inner;
  for (int k = 0; k < 4 * turns; ++k) {
    const double r = 4.0 * turns - k + 4.0;
    const std::array<std::array<double, 2>, 4> ways{{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
    const auto& [x, y] = ways[static_cast<std::size_t>(k) % 4];
    outer.push_back({x * 4 * r, y * 4 * r, 0});
    inner.push_back({x * (4 * r - 7), y * (4 * r - 7), 0});
  }
  std::ranges::reverse(inner);
  outer.insert(outer.end(), inner.begin(), inner.end());
  expect_covered(outer);
  // The same in a steep plane, exactly: the same triangles.
  Polygon steep = outer;
  for (Point& p : steep) p = {p[0], p[0] + 2 * p[1], 8 * p[1]};
  EXPECT_EQ(triangles_of_polygon(steep).defect, "");
}

TEST(PolygonTriangles, SizesDoNotMatter) {
  for (const double scale : {1e-300, 1e-160, 1e150, 1e300}) {
    Polygon small = letter_l;
    for (Point& p : small)
      for (double& x : p) x *= scale;
    EXPECT_EQ(triangles_of_polygon(small).triangles, triangles_of_polygon(letter_l).triangles) << scale;
    for (Point& p : small) p[2] = 1.0;  // far away from the origin, along its normal
    EXPECT_EQ(triangles_of_polygon(small).triangles, triangles_of_polygon(letter_l).triangles) << scale;
  }
}

TEST(PolygonTriangles, RoundedOnesAreStillPlane) {
  Polygon rounded = letter_l;
  for (Point& p : rounded) p = {p[0] + 300, p[1] / 3, p[1] / 7 + p[0] / 9};
  for (Point& p : rounded)
    for (double& x : p) x = static_cast<double>(static_cast<float>(x));
  EXPECT_EQ(triangles_of_polygon(rounded).defect, "");
}

void expect_defect(const Polygon& polygon, const std::string& words) {
  const PolygonTriangles found = triangles_of_polygon(polygon);
  EXPECT_TRUE(found.triangles.empty());
  EXPECT_THAT(found.defect, HasSubstr(words));
}

TEST(PolygonTriangles, OthersAreRefused) {
  expect_defect({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}},
                "crosses or touches itself, at the edges from corners 1 and 3");
  expect_defect({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "its corners 2 and 3 are one point");
  expect_defect({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, "crosses or touches itself");
  expect_defect({{0, 0, 0}, {4, 0, 0}, {2, 0, 0}, {2, 2, 0}}, "crosses or touches itself");      // there and back
  expect_defect({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}}, "crosses or touches");  // a corner on an edge
  expect_defect({{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0}}, "crosses");
  Polygon pentagram;
  for (int k = 0; k < 5; ++k)
    pentagram.push_back({std::cos(0.8 * k * std::numbers::pi), std::sin(0.8 * k * std::numbers::pi), 0});
  expect_defect(pentagram, "crosses or touches itself");
  // Bent so much that from one side it looks convex.
  expect_defect({{0, 0, 0}, {2, 2, 0}, {2, 0, 0.01}, {0, 2, 0.02}}, "it is not plane");
  Polygon bent = letter_l;
  bent[3][2] = 0.1;
  expect_defect(bent, "it is not plane: its corners lie up to");
}

/// One more than is cut, convex but for a corner: a fan is not bounded.
TEST(PolygonTriangles, AreFoundInBoundedTime) {
  Polygon circle;
  constexpr int count = 4097;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    circle.push_back({std::cos(angle), std::sin(angle), 0});
  }
  EXPECT_EQ(triangles_of_polygon(circle).triangles.size(), count - 2U);
  circle[7] = {0, 0, 0};
  expect_defect(circle, "4097 corners that make no fan: at most 4096");
}

// --- the predicate ---------------------------------------------------------------------------------------------------

TEST(Turn, IsExact) {
  const CoordinatePlane plane{0, 1};
  EXPECT_EQ(turn({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, plane), 1);
  EXPECT_EQ(turn({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, plane), -1);
  const double tiny = std::numeric_limits<double>::denorm_min();
  const double huge = std::numeric_limits<double>::max();
  EXPECT_EQ(turn({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, plane), 1);
  EXPECT_EQ(turn({-huge, -huge, 0}, {huge, -huge, 0}, {0, huge, 0}, plane), 1);
  EXPECT_EQ(turn({0, 0, 0}, {huge, huge, 0}, {tiny, 2 * tiny, 0}, plane), 1);
  EXPECT_EQ(turn({0, 0, 0}, {huge, huge, 0}, {2 * tiny, tiny, 0}, plane), -1);
}

/// Near a line every stage is asked, at all sizes: a mirror image turns the other way, another first corner does not.
TEST(Turn, IsAntisymmetricNearALine) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> step(-2, 2);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  const CoordinatePlane plane{0, 1};
  std::array<int, 3> signs{};
  for (int n = 0; n < 20'000; ++n) {
    const double scale = std::ldexp(1.0, static_cast<int>(random() % 2000) - 1000);
    const double t = place(random);
    const Point a{0.1 * scale, 0.2 * scale, 0};
    const Point b{0.3 * scale, 0.6 * scale, 0};
    Point c{(0.1 + t) * scale, 2 * (0.1 + t) * scale, 0};
    for (int k = step(random); k != 0; k -= k > 0 ? 1 : -1) c[1] = std::nextafter(c[1], k > 0 ? infinity : -infinity);
    const int sign = turn(a, b, c, plane);
    ASSERT_EQ(turn(b, c, a, plane), sign);
    ASSERT_EQ(turn(c, a, b, plane), sign);
    ASSERT_EQ(turn(b, a, c, plane), -sign);
    ASSERT_EQ(turn({a[1], a[0], 0}, {b[1], b[0], 0}, {c[1], c[0], 0}, plane), -sign);
    ++signs[static_cast<std::size_t>(sign + 1)];
  }
  EXPECT_GT(*std::ranges::min_element(signs), 100);
}

}  // namespace
}  // namespace verisq
