/// Patches of random primitives contain the surface points that belong to them, and shrink quadratically.
#include "verify/proof/surface_patch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/deviation/brute_force.hpp"
#include "tests/fixtures/random.hpp"
#include "verify/proof/proven_surface.hpp"

namespace verisq::verify {
namespace {

using testing::Long;
using testing::Random;

Primitive random_primitive(Random& random, int n) {
  const auto exponent = [&] {
    const double choice = random.uniform(0.0, 1.0);
    if (choice < 0.1) return 2.0;
    if (choice < 0.2) return 1.0;
    return random.uniform(0.05, 2.0);
  };
  Primitive primitive{"",
                      {{random.uniform(0.3, 3.0), random.uniform(0.3, 3.0), random.uniform(0.3, 3.0)},
                       {exponent(), exponent()},
                       n % 2 == 0 ? 1.0 : std::pow(10.0, random.uniform(-1.0, 1.0))},
                      {random.point(5.0), {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), 0.5}},
                      {}};
  // |k| times the largest |r|, at most twice the axes' length, below 1.
  if (n % 4 >= 2) primitive.bend = Bend{random.uniform(-0.1, 0.1), random.uniform(-180.0, 180.0)};
  return primitive;
}

Point middle_between(const CurvePoint& p) {
  return {0.5 * (p.x.lower() + p.x.upper()), 0.5 * (p.y.lower() + p.y.upper()), 0.0};
}

/// A point of the arc: towards a point of its chord.
std::array<Long, 2> on_arc(const ArcTree& tree, ArcTree::Arc arc, Long share, double exponent) {
  const Point from = middle_between(tree.from(arc));
  const Point to = middle_between(tree.to(arc));
  return testing::on_curve((1 - share) * from[0] + share * to[0], (1 - share) * from[1] + share * to[1], exponent);
}

TEST(ArcTree, PointsOfAnArcLieWithinItsBulge) {
  Random random(1);
  for (const double exponent : {0.05, 0.3, 1.0, 1.7, 2.0}) {
    ArcTree tree(exponent);
    for (ArcTree::Arc arc = 0; arc < 100; ++arc) {
      tree.halve(arc);
      const double width = random.uniform(0.1, 10.0);
      const double height = random.uniform(0.1, 10.0);
      const double bulge = tree.bulge(arc, width, height);
      const Point from = middle_between(tree.from(arc));
      const Point to = middle_between(tree.to(arc));
      Long farthest = 0;
      for (int i = 1; i < 20; ++i) {
        const auto [x, y] = on_arc(tree, arc, Long(i) / 20, exponent);
        farthest = std::max(
            farthest, testing::distance_to_side({x * width, y * height, 0}, {from[0] * width, from[1] * height, 0},
                                                {to[0] * width, to[1] * height, 0}));
      }
      ASSERT_LE(farthest, bulge + 1e-14) << exponent << ' ' << arc;
      // Where it is not the rounding that counts, no more than the samples miss.
      if (arc > 14) {
        ASSERT_LE(bulge, 2 * farthest + 1e-3 * (width + height)) << exponent << ' ' << arc;
      }
    }
  }
}

/// The patch's cells are halved along a random way down.
TEST(SurfacePatch, HoldsItsPartOfTheSurface) {
  Random random(2);
  for (int n = 0; n < 60; ++n) {
    const Primitive primitive = random_primitive(random, n);
    const auto& exponents = primitive.superquadric.exponents;
    PatchedSurface surface(primitive, 7);
    ArcTree along(exponents[0]);
    ArcTree around(exponents[1]);
    PatchCell cell = surface.octants()[static_cast<std::size_t>(random.uniform(0.0, 7.999))];
    EXPECT_EQ(cell.primitive, 7U);
    // The test's own trees number the arcs alike where the same are halved in the same order.
    for (int depth = 0; depth < 10; ++depth) {
      surface.prepare(cell);
      along.halve(cell.along);
      around.halve(cell.around);
      const Patch patch = surface.patch(cell);
      for (int i = 0; i < 40; ++i) {
        const auto c1 = on_arc(along, cell.along, random.uniform(0.0, 1.0), exponents[0]);
        const auto c2 = on_arc(around, cell.around, random.uniform(0.0, 1.0), exponents[1]);
        testing::LongPoint unit{c1[0] * c2[0], c1[0] * c2[1], c1[1]};
        for (std::size_t k = 0; k < 3; ++k) {
          if ((cell.octant >> k & 1U) != 0) unit[k] = -unit[k];
        }
        const Point point = testing::placed(primitive, unit);
        Long nearest = HUGE_VALL;
        for (const Triangle& half : patch.halves()) {
          nearest = std::min(nearest, testing::distance_to_triangle(point, half));
        }
        ASSERT_LE(nearest, patch.thickness + 1e-13) << n << ' ' << depth;
        ASSERT_LE(testing::distance_to_triangle(point, {patch.sample, patch.sample, patch.sample}),
                  patch.radius + 1e-13);
      }
      const auto halves = surface.halves(cell);
      ASSERT_TRUE(halves);
      cell = (*halves)[random.uniform(0.0, 1.0) < 0.5 ? 0 : 1];
    }
  }
}

/// Points of a cell over a grid of shares of both chords, row by row.
struct CellGrid {
  int steps;
  std::vector<Point> points;

  [[nodiscard]] const Point& at(int i, int j) const {
    return points[static_cast<std::size_t>(i) * static_cast<std::size_t>(steps + 1) + static_cast<std::size_t>(j)];
  }
};

CellGrid grid_of(const Primitive& primitive, const ArcTree& along, const ArcTree& around, const PatchCell& cell,
                 int steps) {
  CellGrid grid{steps, {}};
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const auto c1 = on_arc(along, cell.along, Long(i) / steps, primitive.superquadric.exponents[0]);
      const auto c2 = on_arc(around, cell.around, Long(j) / steps, primitive.superquadric.exponents[1]);
      testing::LongPoint unit{c1[0] * c2[0], c1[0] * c2[1], c1[1]};
      for (std::size_t k = 0; k < 3; ++k) {
        if ((cell.octant >> k & 1U) != 0) unit[k] = -unit[k];
      }
      grid.points.push_back(testing::placed(primitive, unit));
    }
  }
  return grid;
}

/// Of the triangles between the grid's points: the area, and the mean of x by it.
struct Integrals {
  Long area = 0;
  Long mean = 0;
};

Integrals integrals_of(const CellGrid& grid) {
  Integrals sums;
  const auto add = [&](const Point& a, const Point& b, const Point& c) {
    const testing::LongPoint normal = testing::cross(testing::difference(testing::widened(b), testing::widened(a)),
                                                     testing::difference(testing::widened(c), testing::widened(a)));
    const Long area = std::sqrt(testing::dot(normal, normal)) / 2;
    sums.area += area;
    sums.mean += area * (Long(a[0]) + b[0] + c[0]) / 3;
  };
  for (int i = 0; i < grid.steps; ++i) {
    for (int j = 0; j < grid.steps; ++j) {
      add(grid.at(i, j), grid.at(i + 1, j), grid.at(i, j + 1));
      add(grid.at(i + 1, j + 1), grid.at(i, j + 1), grid.at(i + 1, j));
    }
  }
  sums.mean /= sums.area;
  return sums;
}

/// Down a random way; x, as a function of the point, changes no faster than distances do.
TEST(PatchArea, HoldsAreaAndMeansOfItsPartOfTheSurface) {
  Random random(4);
  int known = 0;
  for (int n = 0; n < 60; ++n) {
    const Primitive primitive = random_primitive(random, n);
    PatchedSurface surface(primitive, 0);
    ArcTree along(primitive.superquadric.exponents[0]);
    ArcTree around(primitive.superquadric.exponents[1]);
    PatchCell cell = surface.octants()[static_cast<std::size_t>(random.uniform(0.0, 7.999))];
    for (int depth = 0; depth < 10; ++depth) {
      surface.prepare(cell);
      along.halve(cell.along);
      around.halve(cell.around);
      const PatchArea area = surface.area(cell);
      const CellGrid grid = grid_of(primitive, along, around, cell, 24);
      const Integrals fine = integrals_of(grid);
      const Integrals coarse = integrals_of(grid_of(primitive, along, around, cell, 12));
      const Long missed = 2 * std::abs(fine.area - coarse.area) + 1e-12L;
      ASSERT_LE(area.area.lo, fine.area + missed) << n << ' ' << depth;
      ASSERT_GE(area.area.hi, fine.area - missed) << n << ' ' << depth;
      if (area.unevenness < 1.0) {
        ++known;
        const auto corners = surface.patch(cell).corners;
        const Long even = (2 * Long(corners[0][0]) + corners[1][0] + corners[2][0] + 2 * Long(corners[3][0])) / 6;
        double least = grid.points[0][0];
        double greatest = least;
        for (const Point& p : grid.points) {
          least = std::min(least, p[0]);
          greatest = std::max(greatest, p[0]);
        }
        const Long off = area.correspondence + 0.25L * area.unevenness * (greatest - least);
        ASSERT_LE(std::abs(fine.mean - even), off + 2 * std::abs(fine.mean - coarse.mean) + 1e-12L)
            << n << ' ' << depth;
      }
      cell = (*surface.halves(cell))[random.uniform(0.0, 1.0) < 0.5 ? 0 : 1];
    }
  }
  EXPECT_GT(known, 200);
}

/// The mean over the grid's triangles of the distance from a point.
Long mean_distance(const CellGrid& grid, const Point& from) {
  Long area = 0;
  Long moment = 0;
  const auto add = [&](const Point& a, const Point& b, const Point& c) {
    const testing::LongPoint normal = testing::cross(testing::difference(testing::widened(b), testing::widened(a)),
                                                     testing::difference(testing::widened(c), testing::widened(a)));
    const Long of_triangle = std::sqrt(testing::dot(normal, normal)) / 2;
    area += of_triangle;
    for (const Point& corner : {a, b, c})
      moment += of_triangle / 3 * testing::distance_to_triangle(from, {corner, corner, corner});
  };
  for (int i = 0; i < grid.steps; ++i) {
    for (int j = 0; j < grid.steps; ++j) {
      add(grid.at(i, j), grid.at(i + 1, j), grid.at(i, j + 1));
      add(grid.at(i + 1, j + 1), grid.at(i, j + 1), grid.at(i + 1, j));
    }
  }
  return moment / area;
}

/// Down a random way, from points far and near, of which distances are almost affine or not at all.
TEST(WeightedPatch, HoldsDistancesAndTheirMean) {
  Random random(8);
  int narrow = 0;
  for (int n = 0; n < 120; ++n) {
    Primitive primitive = random_primitive(random, n);
    // An octahedron's octants are flat, and covered by the shares of their chords as unevenly as can be.
    if (n % 8 == 0) primitive.superquadric = {primitive.superquadric.semi_axes, {2.0, 2.0}};
    PatchedSurface surface(primitive, 0);
    ArcTree along(primitive.superquadric.exponents[0]);
    ArcTree around(primitive.superquadric.exponents[1]);
    PatchCell cell = surface.octants()[static_cast<std::size_t>(random.uniform(0.0, 7.999))];
    const Point from = random.point(n % 3 == 0 ? 1e4 : 12.0);
    const TriangleTree triangles({{from, from, from}});
    for (int depth = 0; depth < 9; ++depth) {
      surface.prepare(cell);
      along.halve(cell.along);
      around.halve(cell.around);
      const WeightedCell weighted = weighted_patch(surface.patch(cell), surface.area(cell), triangles);
      const CellGrid grid = grid_of(primitive, along, around, cell, 24);
      const Long fine = mean_distance(grid, from);
      const Long missed =
          2 * std::abs(fine - mean_distance(grid_of(primitive, along, around, cell, 12), from)) + 1e-11L;
      ASSERT_LE(weighted.mean.lo, fine + missed) << n << ' ' << depth;
      ASSERT_GE(weighted.mean.hi, fine - missed) << n << ' ' << depth;
      for (const Point& point : grid.points) {
        const Long distance = testing::distance_to_triangle(from, {point, point, point});
        ASSERT_GE(distance, weighted.range.lo - 1e-11L);
        ASSERT_LE(distance, weighted.range.hi + 1e-11L);
      }
      if (weighted.mean.width() < 0.5 * weighted.range.width()) ++narrow;
      cell = (*surface.halves(cell))[random.uniform(0.0, 1.0) < 0.5 ? 0 : 1];
    }
  }
  EXPECT_GT(narrow, 200);
}

/// What is not all of the boundary may be none of it, and have any mean; nothing is farther than the farthest.
TEST(WeightedPatch, CountsInPartWithAnyMean) {
  const WeightedCell patch{{2.0, 3.0}, {1.0, 5.0}, {2.0, 2.5}};
  const WeightedCell whole = on_boundary(patch, true, 4.0);
  EXPECT_EQ(whole.weight, patch.weight);
  EXPECT_EQ(whole.range, (Enclosure{1.0, 4.0}));
  EXPECT_EQ(whole.mean, patch.mean);
  const WeightedCell part = on_boundary(patch, false, 4.0);
  EXPECT_EQ(part.weight, (Enclosure{0.0, 3.0}));
  EXPECT_EQ(part.mean, (Enclosure{1.0, 4.0}));
  const WeightedCell uncertain = on_boundary({{0.0, 3.0}, {1.0, 5.0}, {2.0, 2.5}}, true, 4.0);
  EXPECT_EQ(uncertain.mean, (Enclosure{1.0, 4.0}));
}

/// Where the surface is smooth, what is lost falls with the square of the size.
TEST(PatchArea, IsTight) {
  Random random(5);
  for (int n = 0; n < 8; ++n) {
    Primitive primitive = random_primitive(random, n);
    primitive.superquadric.exponents = {1.0, 1.0};
    PatchedSurface surface(primitive, 0);
    std::vector<PatchCell> cells = surface.octants();
    for (int depth = 0; depth < 8; ++depth) {
      std::vector<PatchCell> next;
      for (const PatchCell& cell : cells) {
        surface.prepare(cell);
        const auto halves = surface.halves(cell);
        next.insert(next.end(), halves->begin(), halves->end());
      }
      cells = std::move(next);
    }
    Enclosure total{0.0, 0.0};
    for (const PatchCell& cell : cells) {
      surface.prepare(cell);
      const Enclosure area = surface.area(cell).area;
      total = {total.lo + area.lo, total.hi + area.hi};
    }
    EXPECT_LE(total.width(), 0.05 * total.hi) << n;
  }
}

/// However far a patch is halved, along one way and another: beyond what binary64 tells apart nothing counts twice.
TEST(PatchArea, OfHalvesAddsUpToNoMoreThanTheWhole) {
  Random random(6);
  const double of_octant = std::numbers::pi / 2;
  for (int n = 0; n < 60; ++n) {
    PatchedSurface surface({"", {{1, 1, 1}, {1, 1}}, {}, {}}, 0);
    PatchCell cell = surface.octants()[0];
    Enclosure total{0.0, 0.0};
    const double along = n % 3 == 0 ? 1.0 : random.uniform(0.0, 1.0);
    const double first = random.uniform(0.0, 1.0) < 0.5 ? random.uniform(0.0, 1.0) : 1.0;
    const auto add = [&](const PatchCell& leaf) {
      surface.prepare(leaf);
      const Enclosure area = surface.area(leaf).area;
      total = {total.lo + area.lo, total.hi + area.hi};
    };
    for (int depth = 0; depth < most_halvings_of_patch; ++depth) {
      surface.prepare(cell);
      const auto halves =
          surface.halves(cell, random.uniform(0.0, 1.0) < along ? PatchHalving::along : PatchHalving::around);
      const std::size_t next = random.uniform(0.0, 1.0) < first ? 0 : 1;
      add(halves[1 - next]);
      cell = halves[next];
    }
    add(cell);
    EXPECT_LE(total.lo, of_octant * (1.0 + 1e-14)) << n;
    EXPECT_GE(total.hi, of_octant * (1.0 - 1e-14)) << n;
  }
}

/// Where the ends of arcs cannot be told apart, what is cut off may reach beyond them.
TEST(ArcTree, IsInOrderAsLongAsEndsAreToldApart) {
  ArcTree tree(1.0);
  ArcTree::Arc arc = ArcTree::whole();
  int ordered = 0;
  for (int depth = 0; depth < most_halvings_of_patch; ++depth) {
    tree.halve(arc);
    arc = tree.first_half(arc) + 1;
    if (tree.in_order(arc)) ++ordered;
  }
  EXPECT_GT(ordered, 40);
  tree.halve(ArcTree::whole());
  arc = tree.first_half(ArcTree::whole()) + 1;
  for (int depth = 0; depth < most_halvings_of_patch; ++depth) {
    tree.halve(arc);
    arc = tree.first_half(arc);
  }
  EXPECT_FALSE(tree.in_order(arc));
}

TEST(SurfacePatch, ThicknessFallsWithTheSquareOfTheSize) {
  Random random(3);
  for (int n = 0; n < 20; ++n) {
    Primitive primitive = random_primitive(random, n);
    primitive.superquadric.exponents = {1.0, 1.0};
    PatchedSurface surface(primitive, 0);
    PatchCell cell = surface.octants()[0];
    for (int depth = 0; depth < 20; ++depth) {
      const auto halves = surface.halves(cell);
      ASSERT_TRUE(halves);
      surface.prepare(cell);
      cell = (*surface.halves(cell))[static_cast<std::size_t>(depth % 2)];
    }
    surface.prepare(cell);
    const Patch patch = surface.patch(cell);
    EXPECT_LE(patch.thickness, 100.0 * patch.radius * patch.radius) << n;
    EXPECT_LE(patch.thickness, 0.1 * patch.radius) << n;
  }
}

}  // namespace
}  // namespace verisq::verify
