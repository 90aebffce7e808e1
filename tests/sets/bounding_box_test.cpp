/// Boxes of models: points of bent solids lie in them, closely; set operations combine them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>

#include "tests/fixtures/large_models.hpp"
#include "verify/search/set_tree.hpp"

namespace verisq {
namespace {

using verify::bounding_box;
using verify::Box;
using Vector = std::array<long double, 3>;

class RandomBends {
 public:
  double between(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }

  /// Of semi-axes about 1, bent by up to nearly what is allowed.
  Primitive primitive() {
    Primitive result{"a", {{}, {between(0.05, 2.0), between(0.05, 2.0)}}, {}, Bend{0.0, between(-720.0, 720.0)}};
    for (double& a : result.superquadric.semi_axes) a = std::exp(between(-2.0, 2.0));
    for (double& t : result.pose.translation) t = between(-3.0, 3.0);
    for (double& q : result.pose.quaternion) q = between(-1.0, 1.0);
    const auto [a1, a2, a3] = result.superquadric.semi_axes;
    result.bend->curvature = between(-1.0, 1.0) * std::min(0.99 / std::hypot(a1, a2), 3.14 / a3);
    return result;
  }

  /// On the surface of the unbent solid, in its own frame.
  Vector surface_point(const Superquadric& solid) {
    const auto& [a1, a2, a3] = solid.semi_axes;
    const auto& [e1, e2] = solid.exponents;
    const double pi = std::numbers::pi;
    const double latitude = between(-pi / 2, pi / 2);
    const double longitude = between(-pi, pi);
    const long double x = signed_power(std::cos(longitude), e2);
    const long double y = signed_power(std::sin(longitude), e2);
    const long double across = signed_power(std::cos(latitude), e1);
    return {a1 * across * x, a2 * across * y, a3 * signed_power(std::sin(latitude), e1)};
  }

 private:
  static long double signed_power(long double base, double exponent) {
    return std::copysign(std::pow(std::abs(base), static_cast<long double>(exponent)), base);
  }

  std::mt19937_64 engine_{20};
};

/// The formula of `Bend` as it stands there.
Vector bent(const Vector& x, const Bend& bend) {
  const long double k = bend.curvature;
  const long double angle = std::fmod(bend.angle_degrees, 360.0) * std::numbers::pi_v<long double> / 180;
  const long double c = std::cos(angle);
  const long double d = std::sin(angle);
  const long double r = x[0] * c + x[1] * d;
  const long double s = x[1] * c - x[0] * d;
  const long double turned = 1 / k - (1 / k - r) * std::cos(k * x[2]);
  return {turned * c - s * d, turned * d + s * c, (1 / k - r) * std::sin(k * x[2])};
}

/// R x + t by the product of quaternions.
Vector posed(const Vector& v, const Pose& pose) {
  const auto [w, x, y, z] = pose.quaternion;
  const long double s = 2.0L / (w * w + x * x + y * y + z * z);
  const Vector u{y * v[2] - z * v[1] + w * v[0], z * v[0] - x * v[2] + w * v[1], x * v[1] - y * v[0] + w * v[2]};
  const auto& t = pose.translation;
  return {v[0] + s * (y * u[2] - z * u[1]) + t[0], v[1] + s * (z * u[0] - x * u[2]) + t[1],
          v[2] + s * (x * u[1] - y * u[0]) + t[2]};
}

bool contains(const Box& box, const Vector& x, long double rounding) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(box.lower[i] - rounding <= x[i] && x[i] <= box.upper[i] + rounding)) return false;
  }
  return true;
}

TEST(BoundingBoxTest, ContainsBentSolids) {
  RandomBends random;
  for (int k = 0; k < 2000; ++k) {
    const Primitive primitive = random.primitive();
    const Model model{"", {primitive}};
    const Box box = bounding_box(model);
    for (int i = 0; i < 200; ++i) {
      const Vector x = posed(bent(random.surface_point(primitive.superquadric), *primitive.bend), primitive.pose);
      ASSERT_TRUE(contains(box, x, 1e-15L)) << k;
    }
  }
}

/// A brick but for its edges: what its box bounds, it reaches.
Primitive brick(double curvature, double angle, double a3 = 2.0) {
  return {"a", {{0.5, 0.25, a3}, {1e-3, 1e-3}}, {}, Bend{curvature, angle}};
}

void expect_box(const Box& found, const Box& expected, double relative) {
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.lower[i], expected.lower[i], relative * std::abs(expected.lower[i])) << i;
    EXPECT_NEAR(found.upper[i], expected.upper[i], relative * std::abs(expected.upper[i])) << i;
  }
}

TEST(BoundingBoxTest, TouchesBentBricks) {
  // An eighth of a turn to either side: the middle of the inner face, and the corners of the ends.
  const double k = std::numbers::pi / 8;
  const double root = std::numbers::sqrt2 / 2;
  const double inner = 1.0 / k - (1.0 / k - 0.5) * root;
  const double outer = (1.0 / k + 0.5) * root;
  expect_box(bounding_box({"", {brick(k, 0.0)}}), {{-0.5, -0.25, -outer}, {inner, 0.25, outer}}, 2e-3);
  expect_box(bounding_box({"", {brick(-k, 0.0)}}), {{-inner, -0.25, -outer}, {0.5, 0.25, outer}}, 2e-3);
  expect_box(bounding_box({"", {brick(k, 180.0)}}), {{-inner, -0.25, -outer}, {0.5, 0.25, outer}}, 2e-3);
  // Towards y, where the half-width is 0.25.
  const double inner_y = 1.0 / k - (1.0 / k - 0.25) * root;
  const double outer_y = (1.0 / k + 0.25) * root;
  expect_box(bounding_box({"", {brick(k, 90.0)}}), {{-0.5, -0.25, -outer_y}, {0.5, inner_y, outer_y}}, 2e-3);
  // Three eighths of a turn to either side: the ends come back, and their outer corners reach farthest.
  const double radius = 2.0 * 4.0 / (3.0 * std::numbers::pi);
  expect_box(bounding_box({"", {brick(1.0 / radius, 0.0)}}),
             {{-0.5, -0.25, -radius - 0.5}, {radius + (radius + 0.5) * root, 0.25, radius + 0.5}}, 2e-3);
}

TEST(BoundingBoxTest, TendsToTheUnbentBox) {
  const Box plain{{-0.5, -0.25, -2.0}, {0.5, 0.25, 2.0}};
  expect_box(bounding_box({"", {brick(0.0, 0.0)}}), plain, 0.0);
  for (const double k : {1e-10, -1e-100, 1e-300, std::numeric_limits<double>::denorm_min()}) {
    expect_box(bounding_box({"", {brick(k, 0.0)}}), plain, 1e-9);
  }
}

Model set_operations(SetExpression csg) {
  const auto cube = [](double x) {
    return Primitive{"a", {{1.0, 1.0, 1.0}, {0.1, 0.1}}, {{x, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}};
  };
  return {"", {cube(0.0), cube(1.5), cube(10.0)}, std::move(csg)};
}

SetExpression operation(SetOperation kind, std::vector<SetExpression> operands) {
  return {std::move(operands), kind};
}

using testing::leaf;

/// Along x; the others are [-1, 1].
std::array<double, 2> range(SetExpression csg) {
  const Box box = bounding_box(set_operations(std::move(csg)));
  return {box.lower[0], box.upper[0]};
}

TEST(BoundingBoxTest, FollowsSetOperations) {
  using enum SetOperation;
  const SetExpression all = operation(unite, {leaf(0), leaf(1), leaf(2)});
  EXPECT_EQ(range(all), (std::array{-1.0, 11.0}));
  EXPECT_EQ(range(operation(unite, {leaf(1), leaf(0)})), (std::array{-1.0, 2.5}));
  EXPECT_EQ(range(operation(intersect, {leaf(0), leaf(1)})), (std::array{0.5, 1.0}));
  EXPECT_EQ(range(operation(subtract, {leaf(1), leaf(0)})), (std::array{0.5, 2.5}));
  EXPECT_EQ(range(operation(subtract, {leaf(0), leaf(1), leaf(2)})), (std::array{-1.0, 1.0}));
  EXPECT_EQ(range(operation(intersect, {all, leaf(2)})), (std::array{9.0, 11.0}));
  EXPECT_EQ(range(operation(unite, {leaf(2), operation(intersect, {leaf(0), leaf(1)})})), (std::array{0.5, 11.0}));
  EXPECT_EQ(range(operation(intersect, {leaf(0), leaf(2)})), (std::array{-1.0, 1.0})) << "empty: the first operand's";
}

/// How often a box of the tree asks for that of a leaf.
std::size_t leaves_asked_for(const SetExpression& tree) {
  std::size_t count = 0;
  static_cast<void>(bounding_box(tree, [&](std::uint32_t /*primitive*/) {
    ++count;
    return Box{{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};
  }));
  return count;
}

TEST(BoundingBoxTest, LooksAtEachLeafOnce) {
  using namespace testing;
  EXPECT_EQ(leaves_asked_for(deep_tree(20, always_union)), 20U);
  ASSERT_FALSE(HasFailure()) << "twice a level: a deep tree would take for ever";
  EXPECT_EQ(leaves_asked_for(deep_tree(1000, always_union)), 1000U);
  EXPECT_EQ(leaves_asked_for(deep_tree_of_last_operands(1000, always_union)), 1000U);
  EXPECT_EQ(leaves_asked_for(wide_tree(10000, SetOperation::intersect)), 10000U);
  EXPECT_EQ(leaves_asked_for(wide_tree(10000, SetOperation::subtract)), 1U);
  EXPECT_EQ(leaves_asked_for(balanced_tree(0, 10000, always_union)), 10000U);
  EXPECT_LE(leaves_asked_for(balanced_tree(0, 10000, in_turn)), 10000U);
}

TEST(BoundingBoxTest, OfNestedUnionsIsThatOfTheWideOne) {
  using namespace testing;
  const Model wide{"", grid_of_balls(1000, 0.6)};
  for (const SetExpression& tree : {deep_tree(1000, always_union), balanced_tree(0, 1000, always_union)}) {
    const Box found = bounding_box({"", wide.primitives, tree});
    EXPECT_EQ(found.lower, bounding_box(wide).lower);
    EXPECT_EQ(found.upper, bounding_box(wide).upper);
  }
}

TEST(BoundingRadiusTest, IsThatOfTheBox) {
  const Model pair = set_operations(operation(SetOperation::unite, {leaf(0), leaf(1)}));
  EXPECT_NEAR(bounding_radius(pair), std::sqrt(1.75 * 1.75 + 2.0), 1e-15);
  const double k = std::numbers::pi / 8;
  const double along = 0.5 + 1.0 / k - (1.0 / k - 0.5) * std::numbers::sqrt2 / 2;
  const double up = (1.0 / k + 0.5) * std::numbers::sqrt2;
  EXPECT_NEAR(bounding_radius({"", {brick(k, 0.0)}}), std::hypot(along, 0.5, up) / 2, 2e-3);
}

TEST(BoundingBoxTest, OverflowsToInfinity) {
  const Primitive far{"a", {{1e308, 1.0, 1.0}, {1.0, 1.0}}, {{1.7e308, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}};
  EXPECT_EQ(bounding_box({"", {far}}).upper[0], infinity);
  EXPECT_EQ(bounding_radius({"", {far}}), infinity);
}

}  // namespace
}  // namespace verisq
