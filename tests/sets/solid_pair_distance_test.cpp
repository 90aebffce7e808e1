/// The distance of any two models by branch and bound: closed forms, limits, sampled surfaces, early ends.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>

#include "tests/fixtures/bitten_ball.hpp"
#include "tests/oracle/bent_surface.hpp"
#include "verify/search/polytope_distance.hpp"
#include "verify/search/solid_pair_cells.hpp"

namespace verisq {
namespace {

constexpr Superquadric capsule{{0.75, 0.75, 1.0}, {1.0, 0.8}};
constexpr Superquadric gem{{0.43, 0.6, 1.9}, {1.5, 0.4}};
constexpr Superquadric soap{{3.4, 4.3, 1.7}, {0.1, 0.1}};

Superquadric ball(double radius) {
  return {{radius, radius, radius}, {1.0, 1.0}};
}

Pose at(double x, double y, double z) {
  return {{x, y, z}, {1.0, 0.0, 0.0, 0.0}};
}

Model model(const Superquadric& solid, const Pose& pose = {}, const std::optional<Bend>& bend = {}) {
  return {"", {{"solid", solid, pose, bend}}};
}

SetExpression leaf(std::uint32_t primitive) {
  return {{}, SetOperation::unite, primitive};
}

/// `operation` of all primitives, in their order.
Model combined(SetOperation operation, const std::vector<Primitive>& primitives) {
  SetExpression expression{{}, operation};
  for (std::uint32_t i = 0; i < primitives.size(); ++i) expression.operands.push_back(leaf(i));
  return {"", primitives, expression};
}

/// A ball of radius 2 with a bore of radius 1 along z. The bore's wall is a cylinder at z = 0, but for 1e-30 or so.
Model bored_ball() {
  return combined(SetOperation::subtract, {{"ball", ball(2.0), {}}, {"bore", {{1.0, 1.0, 10.0}, {0.1, 1.0}}, {}}});
}

SearchedDistance search(const Model& a, const Model& b, double tolerance, const Pose& pose = {}) {
  return ModelSearch(a, b)(pose, {.tolerance = tolerance});
}

void expect_distance(const Model& a, const Model& b, double exact, double tolerance, const Pose& pose = {}) {
  const SearchedDistance found = search(a, b, tolerance, pose);
  const double rounding = 1e-15 * (1.0 + exact);  // `exact` may be a rounded number itself
  EXPECT_LE(found.distance.lo, exact + rounding);
  EXPECT_GE(found.distance.hi, exact - rounding);
  EXPECT_LE(found.distance.width(), tolerance);
  EXPECT_EQ(found.proximity, Proximity::separated);
  EXPECT_TRUE(found.near_points.has_value());
}

bool disjoint(const Enclosure& e, const Enclosure& f) {
  return e.lo > f.hi || f.lo > e.hi;
}

// ---------------------------------------------------------------- closed forms

TEST(SolidPairDistanceTest, Balls) {
  for (const Point& c : {Point{3, 4, 0}, Point{2, 3, 6}, Point{0, 0, 7}, Point{-1, 4, -8}, Point{5, 0, 0}}) {
    const double between = std::hypot(c[0], c[1], c[2]);
    for (const double tolerance : {1e-1, 1e-4, 1e-9}) {
      expect_distance(model(ball(1.0)), model(ball(0.5), at(c[0], c[1], c[2])), between - 1.5, tolerance);
    }
  }
}

TEST(SolidPairDistanceTest, BallsOfAnySize) {
  expect_distance(model(ball(0x1p-100)), model(ball(0x1p-100), at(0, 0, 0x1p-98)), 0x1p-99, 0x1p-120);
  expect_distance(model(ball(0x1p100)), model(ball(0x1p100), at(0, 0, 0x1p102)), 0x1p101, 0x1p80);
  expect_distance(model(ball(1.0)), model(ball(0x1p-20), at(0, 3, 0)), 2.0 - 0x1p-20, 1e-9);
  expect_distance(model(ball(1.0)), model(ball(1.0), at(2.0 + 0x1p-20, 0, 0)), 0x1p-20, 1e-9);
  expect_distance(model(ball(1.0)), model(ball(1.0), at(0, 0x1p20, 0)), 0x1p20 - 2.0, 1e-3);
}

TEST(SolidPairDistanceTest, BallInTheBoreOfAnother) {
  expect_distance(bored_ball(), model(ball(0.25), at(0.3, 0, 0)), 0.45, 1e-6);
  expect_distance(model(ball(0.25), at(0, -0.3, 0)), bored_ball(), 0.45, 1e-6);
}

TEST(SolidPairDistanceTest, EdgeOfALens) {
  const Model lens =
      combined(SetOperation::intersect, {{"left", ball(1.0), at(-0.5, 0, 0)}, {"right", ball(1.0), at(0.5, 0, 0)}});
  expect_distance(lens, model(ball(0.1), at(0, 2, 0)), 2.0 - std::sqrt(0.75) - 0.1, 1e-6);
  expect_distance(lens, model(ball(0.1), at(2, 0, 0)), 1.4, 1e-6);
}

TEST(SolidPairDistanceTest, UnionsTakeTheNearestParts) {
  const Model two = combined(SetOperation::unite, {{"far", ball(1.0), at(0, 9, 0)}, {"near", ball(1.0), at(4, 0, 0)}});
  expect_distance(two, model(ball(0.5)), 2.5, 1e-6);
  const Model overlapping =
      combined(SetOperation::unite, {{"left", ball(1.0), at(-0.5, 0, 0)}, {"right", ball(1.0), at(0.5, 0, 0)}});
  // Two nearest points, one on each part.
  expect_distance(overlapping, model(ball(0.5), at(0, 3, 0)), std::sqrt(9.25) - 1.5, 1e-6);
}

TEST(SolidPairDistanceTest, UnionWithinADifference) {
  // (A or B) minus C, C having eaten what was nearest.
  SetExpression both{{leaf(0), leaf(1)}, SetOperation::unite};
  const Model eaten{"",
                    {{"a", ball(1.0), {}}, {"b", ball(1.0), at(-1, 0, 0)}, {"c", ball(0.5), at(1, 0, 0)}},
                    SetExpression{{both, leaf(2)}, SetOperation::subtract}};
  // C meets A's surface at x = 1 - 0.25/2: the nearest point to (2.5, 0, 0) is on that circle.
  const double x = 0.875;
  expect_distance(eaten, model(ball(0.5), at(2.5, 0, 0)), std::hypot(2.5 - x, std::sqrt(1 - x * x)) - 0.5, 1e-6);
}

// ---------------------------------------------------------------- sets that are simpler within cubes

/// What is proven to lie in a model need not lie in the cube that proposed it, where the tree is simpler: what is
/// bitten off beside a cube must not come back.
TEST(SolidPairDistanceTest, PointsBesideTheirCubesLieInTheModel) {
  int cases = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    const auto& [solid, above] = oracle::random_bitten_ball(seed);
    const double distance = solid.distance(above);
    if (std::hypot(above[0], above[1], above[2]) < 1.1 || distance < 0.1) continue;
    ++cases;
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const double radius = (0.1 + 0.8 * (seed % 10) / 10.0) * distance;
    expect_distance(solid.model(), model(ball(radius), at(above[0], above[1], above[2])), distance - radius, 0.01);
  }
  EXPECT_GT(cases, 100);
}

/// a and (b or c) as (a and b) or (a and c): with a once, with a twice, and with a copy of it.
TEST(SolidPairDistanceTest, OnePrimitiveMayOccurTwice) {
  const std::vector<Primitive> primitives{{"a", ball(1.0), {}},
                                          {"b", {{0.5, 0.6, 0.7}, {0.4, 1.2}}, at(0.9, 0.3, 0.0)},
                                          {"c", ball(0.5), at(-0.2, 1.1, 0.1)},
                                          {"copy", ball(1.0), {}}};
  const auto both = [](std::uint32_t i, std::uint32_t j) {
    return SetExpression{{leaf(i), leaf(j)}, SetOperation::intersect};
  };
  const SetExpression either{{leaf(1), leaf(2)}, SetOperation::unite};
  const Model factored{"", primitives, SetExpression{{leaf(0), either}, SetOperation::intersect}};
  const Model repeated{"", primitives, SetExpression{{both(0, 1), both(0, 2)}, SetOperation::unite}};
  const Model copied{"", primitives, SetExpression{{both(0, 1), both(3, 2)}, SetOperation::unite}};
  const std::vector<Model> parts{{"", primitives, both(0, 1)}, {"", primitives, both(0, 2)}};
  for (const Point& p :
       {Point{2, 0.5, 0}, Point{1.2, 1.3, 0.4}, Point{0, 2, 0.1}, Point{-1, 0, 0.5}, Point{0.5, 0.6, 1}}) {
    SCOPED_TRACE(fmt::format("({}, {}, {})", p[0], p[1], p[2]));
    const Model probe = model(ball(0.1), at(p[0], p[1], p[2]));
    const Enclosure found = search(repeated, probe, 1e-6).distance;
    EXPECT_LE(found.width(), 1e-6);
    EXPECT_FALSE(disjoint(found, search(factored, probe, 1e-6).distance));
    EXPECT_FALSE(disjoint(found, search(copied, probe, 1e-6).distance));
    EXPECT_FALSE(disjoint(found, search(probe, repeated, 1e-6).distance));
    const Enclosure first = search(parts[0], probe, 1e-6).distance;
    const Enclosure second = search(parts[1], probe, 1e-6).distance;
    EXPECT_FALSE(disjoint(found, {std::min(first.lo, second.lo), std::min(first.hi, second.hi)}));
  }
}

// ---------------------------------------------------------------- against the certificates of convex pairs

TEST(SolidPairDistanceTest, AgreesWithTheConvexProof) {
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> symmetric(-1.0, 1.0);
  const std::array<Superquadric, 3> solids{capsule, gem, soap};
  for (int trial = 0; trial < 12; ++trial) {
    const Model a = model(solids[trial % 3]);
    const Model b = model(solids[(trial + 1 + trial / 3 % 2) % 3]);
    const auto number = [&] { return symmetric(generator); };
    const Pose pose{{7.0 * number(), 7.0 * number(), 7.0 * number()}, {number(), number(), number(), number()}};
    SCOPED_TRACE(fmt::format("trial {}", trial));
    const ModelDistance convex = PairDistance(a, b)(pose);
    const SearchedDistance found = search(a, b, 1e-5, pose);
    EXPECT_FALSE(disjoint(found.distance, convex.distance));
    EXPECT_LE(found.distance.width(), 1e-5);
    EXPECT_EQ(found.proximity, convex.proximity);
  }
}

TEST(SolidPairDistanceTest, SmallBendsConvergeToNone) {
  const Pose pose{{6.7, -4.1, 3.8}, {0.8, 0.45, 0.3, -0.2}};
  const Enclosure unbent = PairDistance(model(gem), model(soap))(pose).distance;
  for (const double curvature : {1e-5, 1e-9, -1e-9, 1e-300, 0.0}) {
    SCOPED_TRACE(fmt::format("curvature {}", curvature));
    const Enclosure bent = search(model(gem), model(soap, {}, Bend{curvature, 70.0}), 1e-6, pose).distance;
    EXPECT_LE(bent.width(), 1e-6);
    // No point of the soap moves by more than k (r + z)^2, and a little for rounding.
    const double moved = std::fabs(curvature) * 60.0;
    EXPECT_LE(bent.lo, unbent.hi + moved);
    EXPECT_GE(bent.hi, unbent.lo - moved);
  }
}

TEST(SolidPairDistanceTest, ThePoseMovesTheSecondModel) {
  const Pose pose{{3.0, -4.0, 2.0}, {0.3, -0.8, 0.4, 1.1}};
  const Bend bend{0.2, 25.0};
  const Enclosure by_pose = search(model(capsule), model(gem, {}, bend), 1e-6, pose).distance;
  const Enclosure by_model = search(model(capsule), model(gem, pose, bend), 1e-6).distance;
  EXPECT_FALSE(disjoint(by_pose, by_model));
  EXPECT_LE(by_pose.width(), 1e-6);
  EXPECT_LE(by_model.width(), 1e-6);
}

// ---------------------------------------------------------------- sampled surfaces

/// A point of the boundary of a bent, posed primitive (paper Eqs. (1), (2)), but for rounding.
Point boundary_point(const Superquadric& solid, const Bend& bend, const Pose& pose, double polar, double azimuth) {
  return verify::BoundedMotion(pose).to_a(oracle::bent_surface_point(solid, bend, polar, azimuth).bent);
}

/// Over a grid of both surfaces, and finer ones about the best pair: at least the distance, but for rounding.
double sampled_distance(const Superquadric& a, const Bend& bend_a, const Superquadric& b, const Bend& bend_b,
                        const Pose& pose) {
  constexpr int steps = 24;
  std::array<double, 4> centre{0.0, 0.0, 0.0, 0.0};
  std::array<double, 4> reach{std::numbers::pi / 2, std::numbers::pi, std::numbers::pi / 2, std::numbers::pi};
  double best = infinity;
  for (int round = 0; round < 40; ++round) {
    const int count = round == 0 ? steps : 3;
    const auto surface = [&](const Superquadric& solid, const Bend& bend, const Pose& posed, std::size_t first) {
      std::vector<std::pair<std::array<double, 2>, Point>> points;
      for (int i = -count; i <= count; ++i) {
        for (int j = -count; j <= count; ++j) {
          const std::array<double, 2> angles{centre[first] + reach[first] * i / count,
                                             centre[first + 1] + reach[first + 1] * j / count};
          points.emplace_back(angles, boundary_point(solid, bend, posed, angles[0], angles[1]));
        }
      }
      return points;
    };
    const auto of_a = surface(a, bend_a, {}, 0);
    const auto of_b = surface(b, bend_b, pose, 2);
    std::array<double, 4> next = centre;
    for (const auto& [angles_a, p] : of_a) {
      for (const auto& [angles_b, q] : of_b) {
        const double distance = std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
        if (distance >= best) continue;
        best = distance;
        next = {angles_a[0], angles_a[1], angles_b[0], angles_b[1]};
      }
    }
    for (double& r : reach) r = round == 0 ? 2.0 * r / steps : 0.6 * r;
    centre = next;
  }
  return best;
}

TEST(SolidPairDistanceTest, BentSolidsAgainstSampledSurfaces) {
  std::mt19937_64 generator(9);
  std::uniform_real_distribution<double> symmetric(-1.0, 1.0);
  const auto number = [&] { return symmetric(generator); };
  for (int trial = 0; trial < 8; ++trial) {
    const Superquadric a{{0.6, 0.8, 2.5}, {0.9 + 0.3 * number(), 0.9 + 0.3 * number()}};
    const Superquadric b{{0.7, 0.5, 2.0}, {0.9 + 0.3 * number(), 0.9 + 0.3 * number()}};
    const Bend bend_a{0.5 * number(), 180.0 * number()};
    const Bend bend_b{0.5 * number(), 180.0 * number()};
    const Pose pose{{3.0 + number(), 2.0 + number(), 2.0 * number()}, {number(), number(), number(), number()}};
    SCOPED_TRACE(fmt::format("trial {}", trial));
    const SearchedDistance found = search(model(a, {}, bend_a), model(b, {}, bend_b), 1e-6, pose);
    const double sampled = sampled_distance(a, bend_a, b, bend_b, pose);
    EXPECT_LE(found.distance.lo, sampled + 1e-12);
    if (found.proximity == Proximity::overlapping) continue;
    EXPECT_LE(found.distance.width(), 1e-6);
    EXPECT_GE(found.distance.hi, sampled - 1e-3);  // the sampled minimum may be another, local one, but not by much
  }
}

// ---------------------------------------------------------------- overlapping, touching

TEST(SolidPairDistanceTest, OverlappingModelsHaveACommonPoint) {
  const std::vector<std::pair<Model, Model>> cases{
      {model(ball(1.0)), model(ball(1.0))},
      {model(ball(1.0)), model(ball(0.1), at(0.3, 0.2, 0.1))},
      {model(ball(1.0)), model(ball(1.0), at(2.0 - 1e-4, 0, 0))},
      {model(soap, {}, Bend{0.05, 70.0}), model(gem, at(3.0, 1.0, 2.0), Bend{0.1, 0.0})},
      {bored_ball(), model(ball(0.8), at(0.3, 0, 0))},
      {bored_ball(), bored_ball()}};
  for (const auto& [a, b] : cases) {
    const SearchedDistance found = search(a, b, 1e-6);
    EXPECT_EQ(found.proximity, Proximity::overlapping);
    EXPECT_EQ(found.distance, (Enclosure{0.0, 0.0}));
    ASSERT_TRUE(found.common.has_value());
  }
  const Point common = *search(model(ball(1.0)), model(ball(1.0), at(1.9, 0, 0)), 1e-6).common;
  EXPECT_LE(std::hypot(common[0], common[1], common[2]), 1.0);
  EXPECT_LE(std::hypot(common[0] - 1.9, common[1], common[2]), 1.0);
}

TEST(SolidPairDistanceTest, TouchingIsUndecided) {
  const std::vector<std::pair<Model, Model>> cases{{model(ball(1.0)), model(ball(1.0), at(2, 0, 0))},
                                                   {bored_ball(), model(ball(0.5), at(0.5, 0, 0))}};
  for (const auto& [a, b] : cases) {
    const SearchedDistance found = search(a, b, 1e-6);
    EXPECT_EQ(found.distance.lo, 0.0);
    EXPECT_LE(found.distance.hi, 1e-6);
    EXPECT_EQ(found.proximity, Proximity::undecided);
  }
}

// ---------------------------------------------------------------- huge and tiny lengths

Point times(const Point& x, double s) {
  return {s * x[0], s * x[1], s * x[2]};
}

Model times(Model model, double s) {
  for (Primitive& primitive : model.primitives) {
    for (double& a : primitive.superquadric.semi_axes) a *= s;
    primitive.pose.translation = times(primitive.pose.translation, s);
    if (primitive.bend) primitive.bend->curvature /= s;
  }
  return model;
}

/// Squares of such lengths are no binary64 numbers; powers of two change nothing else.
TEST(SolidPairDistanceTest, LengthsMayBeHugeOrTiny) {
  const Model a = bored_ball();
  const Model bent = model(capsule, {}, Bend{0.1, 0.0});
  for (const int exponent : {-1000, -700, -520, 520, 700, 1000}) {
    const double s = std::ldexp(1.0, exponent);
    for (const auto& [first, second, pose] :
         {std::tuple(a, bent, at(3.0, 1.0, 0.5)), std::tuple(bent, a, at(-4.0, 0.25, 2.0)),
          std::tuple(a, model(ball(0.8)), at(0.3, 0.0, 0.0))}) {
      const SearchedDistance usual = ModelSearch(first, second)(pose, {.tolerance = 1e-4});
      const Pose far{times(pose.translation, s), pose.quaternion};
      const SearchedDistance found = ModelSearch(times(first, s), times(second, s))(far, {.tolerance = 1e-4 * s});
      EXPECT_LE(found.distance.lo, s * usual.distance.hi) << exponent;
      EXPECT_GE(found.distance.hi, s * usual.distance.lo) << exponent;
      EXPECT_LE(found.distance.width(), 1.001e-4 * s) << exponent;
      EXPECT_EQ(found.proximity, usual.proximity) << exponent;
      EXPECT_EQ(found.common.has_value(), usual.common.has_value()) << exponent;
    }
  }
}

// ---------------------------------------------------------------- early ends

TEST(SolidPairDistanceTest, InterruptionLeavesAValidEnclosure) {
  const Model a = model(capsule, {}, Bend{0.1, 0.0});
  const Model b = model(gem, at(2.1, 1.7, 2.3), Bend{-0.2, 30.0});
  const Enclosure tight = search(a, b, 1e-6).distance;
  const SearchedDistance early = ModelSearch(a, b)({}, {.tolerance = 1e-6, .interrupted = [] { return true; }});
  EXPECT_LE(early.distance.lo, tight.lo);
  EXPECT_GE(early.distance.hi, tight.hi);
  EXPECT_GT(early.distance.width(), 1e-6);
}

TEST(SolidPairDistanceTest, ProgressIsValidAndNarrows) {
  const Model a = model(capsule, {}, Bend{0.1, 0.0});
  const Model b = model(gem, at(2.1, 1.7, 2.3), Bend{-0.2, 30.0});
  std::vector<Enclosure> seen;
  std::uint64_t last_cubes = 0;
  const auto keep = [&](const Enclosure& e, std::uint64_t cubes) {
    seen.push_back(e);
    EXPECT_GE(cubes, last_cubes);
    last_cubes = cubes;
  };
  const SearchedDistance found = ModelSearch(a, b)({}, {.tolerance = 1e-7, .progress = keep});
  ASSERT_GE(seen.size(), 2U);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_FALSE(disjoint(seen[i], found.distance));
    if (i > 0) {
      EXPECT_LE(seen[i].width(), seen[i - 1].width());
    }
  }
  EXPECT_GE(found.cubes, last_cubes);
}

TEST(SolidPairDistanceTest, ToleranceZeroEndsAtRoundingErrors) {
  const SearchedDistance found = search(model(ball(1.0)), model(ball(0.5), at(2, 3, 6)), 0.0);
  EXPECT_LE(found.distance.lo, 5.5);
  EXPECT_GE(found.distance.hi, 5.5);
  EXPECT_LE(found.distance.width(), 1e-10);
}

/// A cup bored to 18 mm, open above its middle.
Model cup() {
  const Superquadric half_space{{30.0, 30.0, 30.0}, {0.05, 0.05}};
  return combined(SetOperation::subtract,
                  {{"outer", ball(25.0), {}}, {"bore", ball(18.0), {}}, {"opening", half_space, at(0.0, 0.0, 30.0)}});
}

TEST(SolidPairDistanceTest, AHeadInItsCup) {
  const Model head = model(ball(16.0));
  for (const double down : {0.0, 1e-9, 0.5, 1.9}) {  // concentric, all of the bore is as near
    for (const bool cup_first : {false, true}) {
      const Pose pose = at(0.0, 0.0, cup_first ? -down : down);  // of the second model
      const SearchedDistance found = cup_first ? search(cup(), head, 1.6e-5, pose) : search(head, cup(), 1.6e-5, pose);
      EXPECT_TRUE(found.reached);
      EXPECT_EQ(found.proximity, Proximity::separated);
      EXPECT_LE(found.distance.lo, 2.0 - down + 1e-14);
      EXPECT_GE(found.distance.hi, 2.0 - down - 1e-14);
      EXPECT_LE(found.distance.width(), 1.6e-5);
      EXPECT_LT(found.cubes, 100'000U);  // without its centre's distance more than a million
      EXPECT_TRUE(found.near_points);
    }
  }
}

TEST(SolidPairDistanceTest, TwoHeadsInTheirCups) {
  const Model heads{"", {{"a", ball(16.0), {}}, {"b", ball(1.0), at(0.0, 0.0, -10.0)}}};
  const SearchedDistance found = search(heads, cup(), 1.6e-5, at(0.0, 0.0, 0.0));
  EXPECT_LE(found.distance.lo, 2.0);
  EXPECT_GE(found.distance.hi, 2.0 - 1e-14);
  EXPECT_TRUE(found.reached);
}

TEST(SolidPairDistanceTest, AHeadThatIsNoBallInItsCup) {
  // The farthest point of the head from the centre of the bore is nearest to its wall: a circle of them, or two.
  for (const Superquadric& head : {Superquadric{{16.0, 16.0, 15.9}, {1.0, 1.0}},
                                   {{16.0, 15.9, 15.9}, {1.0, 1.0}},
                                   Superquadric{{15.9, 15.9, 16.0}, {1.0, 1.0}}}) {
    for (const bool cup_first : {false, true}) {
      const SearchedDistance found = cup_first ? search(cup(), model(head), 1e-6) : search(model(head), cup(), 1e-6);
      EXPECT_TRUE(found.reached);
      EXPECT_LE(found.distance.lo, 2.0 + 1e-14);
      EXPECT_GE(found.distance.hi, 2.0 - 1e-14);
      EXPECT_LT(found.cubes, 100'000U);  // by pairs of cubes alone more than a million
      EXPECT_TRUE(found.near_points);
    }
  }
  // Deeper in the cup along its own longest axis.
  const SearchedDistance deep = search(model({{15.9, 15.9, 16.0}, {1.0, 1.0}}), cup(), 1e-6, at(0.0, 0.0, 0.5));
  EXPECT_LE(deep.distance.lo, 1.5 + 1e-14);
  EXPECT_GE(deep.distance.hi, 1.5 - 1e-14);
  EXPECT_LT(deep.cubes, 100'000U);
}

TEST(SolidPairDistanceTest, SeparatedPrimitivesNeedNoCubes) {
  const Pose pose{{7.3, 3.9, 2.6}, {0.6, -0.3, 0.5, 0.7}};
  for (const std::optional<Bend>& bend : {std::optional<Bend>(), std::optional<Bend>(Bend{0.001, 70.0})}) {
    const SearchedDistance found = search(model(capsule), model(soap, {}, bend), 1e-6, pose);
    EXPECT_LE(found.distance.width(), 1e-6);
    EXPECT_LT(found.cubes, 10U);
  }
  // What is removed on the far side does not matter, nor do the other operands of an intersection.
  const Model bitten = combined(SetOperation::subtract, {{"ball", ball(2.0), {}}, {"bite", ball(1.0), at(-2, 0, 0)}});
  const SearchedDistance beside = search(bitten, model(ball(1.0)), 1e-6, at(5, 0, 0));
  EXPECT_LE(beside.distance.lo, 2.0);
  EXPECT_GE(beside.distance.hi, 2.0);
  EXPECT_LE(beside.distance.width(), 1e-6);
  EXPECT_LT(beside.cubes, 20U);
}

TEST(SolidPairDistanceTest, RandomTreesAreNoFartherThanTheirPoints) {
  std::mt19937_64 generator(23);
  std::uniform_real_distribution<double> symmetric(-1.0, 1.0);
  const auto number = [&] { return symmetric(generator); };
  const auto primitive = [&] {
    const Superquadric solid{{0.8 + 0.4 * number(), 0.8 + 0.4 * number(), 1.2 + 0.6 * number()},
                             {1.0 + 0.9 * number(), 1.0 + 0.9 * number()}};
    return Primitive{"p",
                     solid,
                     {{0.5 * number(), 0.5 * number(), 0.5 * number()}, {number(), number(), number(), 0.5}},
                     Bend{0.4 * number(), 180.0 * number()}};
  };
  constexpr std::array operations{SetOperation::unite, SetOperation::intersect, SetOperation::subtract};
  const auto tree = [&](int i) { return combined(operations[i % 3], {primitive(), primitive()}); };
  for (int trial = 0; trial < 9; ++trial) {
    const Model a = tree(trial);
    const Model b = tree(trial / 3);
    const Pose pose{{2.5 + number(), 2.5 + number(), number()}, {number(), number(), number(), 0.5}};
    SCOPED_TRACE(fmt::format("trial {}", trial));
    const SearchedDistance found = search(a, b, 1e-3, pose);
    const verify::SearchSolid solid_a(a);
    const verify::SearchSolid solid_b(b);
    const auto points = [&](const verify::SearchSolid& solid) {
      std::vector<Point> inside;
      for (int i = 0; i < 4000; ++i) {
        const Point x{2.5 * number(), 2.5 * number(), 2.5 * number()};
        const auto within = [&](const auto& part) { return strictly_inside(solid, part.set, {x, 0.0}); };
        if (std::ranges::any_of(solid.parts, within)) inside.push_back(x);
      }
      return inside;
    };
    const verify::BoundedMotion motion(pose);
    double least = infinity;
    const std::vector<Point> of_a = points(solid_a);
    for (const Point& y : points(solid_b)) {
      for (const Point& x : of_a) least = std::min(least, motion.distance_up(x, y));
    }
    EXPECT_LE(found.distance.lo, least);
    if (found.near_points) {
      const auto& [x, y] = *found.near_points;
      EXPECT_EQ(motion.distance_up(x, y), found.distance.hi);
    }
  }
}

TEST(SolidPairDistanceTest, RefusesAModelWithoutAnyPoint) {
  const Model nothing =
      combined(SetOperation::intersect, {{"left", ball(1.0), at(-2, 0, 0)}, {"right", ball(1.0), at(2, 0, 0)}});
  EXPECT_THROW((void)search(nothing, model(ball(1.0)), 1e-6), Error);
}

TEST(SolidPairDistanceTest, TheConvexProofRefusesOtherModels) {
  EXPECT_THROW(PairDistance(bored_ball(), model(ball(1.0))), Error);
  EXPECT_THROW(PairDistance(model(ball(1.0)), model(gem, {}, Bend{0.1, 0.0})), Error);
}

// ---------------------------------------------------------------- polytopes

using verify::CutCube;
using verify::HalfSpace;

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A cube with `count` random cuts, none of which takes its centre.
CutCube random_polytope(std::mt19937_64& generator, std::size_t count) {
  std::normal_distribution<double> normal;
  std::vector<HalfSpace> cuts;
  for (std::size_t j = 0; j < count; ++j) {
    cuts.push_back({{normal(generator), normal(generator), normal(generator)}, 0.4 * std::fabs(normal(generator))});
  }
  return {{{normal(generator), normal(generator), normal(generator)}, 0.5}, cuts};
}

bool contains(const CutCube& polytope, const Point& e, double slack = 0.0) {
  return std::ranges::all_of(polytope.half_spaces(),
                             [&](const HalfSpace& cut) { return dot(cut.normal, e) <= cut.offset + slack; });
}

TEST(SolidPairPolytopeTest, SupportBoundsAllPointsAndIsAttained) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (int trial = 0; trial < 200; ++trial) {
    const CutCube polytope = random_polytope(generator, static_cast<std::size_t>(trial % 4));
    const Point direction{normal(generator), normal(generator), normal(generator)};
    const double support = polytope.support(direction);
    double sampled = -infinity;
    for (int i = 0; i < 4000; ++i) {
      const Point e{within(generator), within(generator), within(generator)};
      if (contains(polytope, e)) sampled = std::max(sampled, dot(direction, e));
    }
    EXPECT_GE(support, sampled);
    // The point nearest to one far away in that direction attains it.
    const Point& c = polytope.cube().centre;
    const Point far{c[0] + 1e6 * direction[0], c[1] + 1e6 * direction[1], c[2] + 1e6 * direction[2]};
    const Point x = polytope.nearest(far);
    const Point e{x[0] - c[0], x[1] - c[1], x[2] - c[2]};
    if (trial % 4 <= 1) {
      EXPECT_TRUE(contains(polytope, e, 1e-8));
      EXPECT_NEAR(dot(direction, e), support, 1e-5);
    }
  }
}

TEST(SolidPairPolytopeTest, NearestPointsAreNearest) {
  std::mt19937_64 generator(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (int trial = 0; trial < 100; ++trial) {
    const CutCube polytope = random_polytope(generator, 1);
    const Point& c = polytope.cube().centre;
    const Point x{c[0] + normal(generator), c[1] + normal(generator), c[2] + normal(generator)};
    const Point nearest = polytope.nearest(x);
    EXPECT_TRUE(contains(polytope, {nearest[0] - c[0], nearest[1] - c[1], nearest[2] - c[2]}, 1e-12));
    const double distance = std::hypot(x[0] - nearest[0], x[1] - nearest[1], x[2] - nearest[2]);
    for (int i = 0; i < 2000; ++i) {
      const Point e{within(generator), within(generator), within(generator)};
      if (!contains(polytope, e)) continue;
      EXPECT_GE(std::hypot(x[0] - c[0] - e[0], x[1] - c[1] - e[1], x[2] - c[2] - e[2]), distance - 1e-12);
    }
  }
}

TEST(SolidPairBoundTest, NoPairOfPointsIsNearerThanTheBound) {
  std::mt19937_64 generator(6);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (int trial = 0; trial < 100; ++trial) {
    const CutCube x = random_polytope(generator, static_cast<std::size_t>(trial % 3));
    const CutCube y = random_polytope(generator, static_cast<std::size_t>(trial / 3 % 3));
    const verify::BoundedMotion motion({{normal(generator), normal(generator), 2.0 + normal(generator)},
                                        {normal(generator), normal(generator), normal(generator), normal(generator)}});
    const verify::Approach found = verify::approach(x, y, motion, {0.0, 0.0, 1.0}, 1e300);
    // Projections onto several cuts at once are not exact.
    if (trial % 3 <= 1 && trial / 3 % 3 <= 1) {
      EXPECT_LE(found.lower, found.between + 1e-9);
    }
    for (int i = 0; i < 1000; ++i) {
      const Point e{within(generator), within(generator), within(generator)};
      const Point f{within(generator), within(generator), within(generator)};
      if (!contains(x, e) || !contains(y, f)) continue;
      const Point& c = x.cube().centre;
      const Point& d = y.cube().centre;
      EXPECT_GE(motion.distance_up({c[0] + e[0], c[1] + e[1], c[2] + e[2]}, {d[0] + f[0], d[1] + f[1], d[2] + f[2]}),
                found.lower);
    }
  }
}

}  // namespace
}  // namespace verisq
