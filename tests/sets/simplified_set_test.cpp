/// Signed distances by branch and bound where the tree of sets is simpler within a cube than beside it, or names a
/// primitive twice.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/fixtures/bitten_ball.hpp"
#include "verify/search/solid_distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

Enclosure signed_distance(const Model& model, const Point& x, double tolerance) {
  return SolidDistance(model)(x, tolerance, {-infinity, infinity}, [] { return false; });
}

/// What is proven to lie in a set need not lie in the cube that proposed it: what is bitten off beside a cube must not
/// come back.
TEST(SimplifiedSetTest, PointsBesideTheirCubesLieInTheSet) {
  int cases = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto& [solid, above] = oracle::random_bitten_ball(seed);
    if (std::hypot(above[0], above[1], above[2]) < 1.1) continue;
    ++cases;
    SCOPED_TRACE(seed);
    const double tolerance = seed % 2 == 0 ? 0.01 : 0.001;
    const Enclosure found = signed_distance(solid.model(), above, tolerance);
    const double exact = solid.distance(above);
    EXPECT_LE(found.lo, exact + 1e-14);
    EXPECT_GE(found.hi, exact - 1e-14);
    EXPECT_LE(found.width(), tolerance);
  }
  EXPECT_GT(cases, 150);
}

Primitive ball(const Point& centre, double radius) {
  return {"ball", {{radius, radius, radius}, {1.0, 1.0}}, {centre, {1.0, 0.0, 0.0, 0.0}}};
}

SetExpression leaf(std::uint32_t primitive) {
  return {.operands = {}, .operation = SetOperation::unite, .primitive = primitive};
}

/// a and (b or c) as (a and b) or (a and c): with a once, with a twice, and with a copy of it.
TEST(SimplifiedSetTest, OnePrimitiveMayOccurTwice) {
  const std::vector<Primitive> primitives{ball({}, 1.0),
                                          {"b", {{0.5, 0.6, 0.7}, {0.4, 1.2}}, {{0.9, 0.3, 0.0}, {1.0, 0.0, 0.0, 0.0}}},
                                          ball({-0.2, 1.1, 0.1}, 0.5),
                                          ball({}, 1.0)};
  const auto both = [](std::uint32_t i, std::uint32_t j) {
    return SetExpression{.operands = {leaf(i), leaf(j)}, .operation = SetOperation::intersect};
  };
  const SetExpression either{.operands = {leaf(1), leaf(2)}, .operation = SetOperation::unite};
  const auto model = [&](const SetExpression& x, const SetExpression& y, SetOperation operation) {
    return Model{"", primitives, SetExpression{.operands = {x, y}, .operation = operation}};
  };
  const Model factored = model(leaf(0), either, SetOperation::intersect);
  const Model repeated = model(both(0, 1), both(0, 2), SetOperation::unite);
  const Model copied = model(both(0, 1), both(3, 2), SetOperation::unite);
  std::mt19937_64 generator(8);
  std::uniform_real_distribution<double> symmetric(-1.0, 1.0);
  int inside = 0;
  for (int i = 0; i < 60; ++i) {
    const double reach = i % 2 == 0 ? 1.5 : 0.5;
    const Point x{0.4 + reach * symmetric(generator), 0.5 + reach * symmetric(generator), reach * symmetric(generator)};
    const Enclosure once = signed_distance(factored, x, 1e-6);
    for (const Model* other : {&repeated, &copied}) {
      const Enclosure found = signed_distance(*other, x, 1e-6);
      EXPECT_LE(found.width(), 1e-6);
      EXPECT_LE(found.lo, once.hi) << x[0] << ' ' << x[1] << ' ' << x[2];
      EXPECT_GE(found.hi, once.lo) << x[0] << ' ' << x[1] << ' ' << x[2];
    }
    inside += once.hi < 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, 5);
}

}  // namespace
}  // namespace verisq::verify
