/// What kind of solid a model is, and that everything which rests on convex certificates refuses the other kinds.
#include <gmock/gmock.h>

#include <functional>
#include <verisq/checker.hpp>
#include <verisq/error.hpp>
#include <verisq/map.hpp>
#include <verisq/published_method.hpp>
#include <verisq/triangle_distance.hpp>

namespace verisq {
namespace {

Primitive ball(std::optional<Bend> bend = {}) {
  return {"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}, bend};
}

SetExpression leaf(std::uint32_t primitive) {
  return {.primitive = primitive};
}

SetExpression operation(SetOperation kind, std::vector<SetExpression> operands) {
  return {std::move(operands), kind};
}

Model two_balls(std::optional<SetExpression> csg = {}) {
  return {"", {ball(), ball()}, std::move(csg)};
}

const Model bent{"", {ball(), ball(Bend{0.5, 0.0})}};
const Model difference = two_balls(operation(SetOperation::subtract, {leaf(0), leaf(1)}));

TEST(ModelTest, TellsUnionsOfConvexSolids) {
  using enum SetOperation;
  EXPECT_TRUE(is_union_of_convex(two_balls()));
  EXPECT_TRUE(is_union_of_convex({"", {ball(Bend{0.0, 45.0})}}));
  EXPECT_TRUE(is_union_of_convex(two_balls(operation(unite, {leaf(1), leaf(0)}))));
  EXPECT_TRUE(is_union_of_convex(two_balls(operation(unite, {leaf(1), operation(unite, {leaf(1), leaf(0)})}))));
  EXPECT_TRUE(is_union_of_convex({"", {ball()}, leaf(0)}));
  EXPECT_FALSE(is_union_of_convex(two_balls(leaf(0))));
  EXPECT_FALSE(is_union_of_convex(two_balls(operation(unite, {leaf(1)}))));
  EXPECT_FALSE(is_union_of_convex(two_balls(operation(intersect, {leaf(0), leaf(1)}))));
  EXPECT_FALSE(is_union_of_convex(two_balls(operation(unite, {leaf(0), operation(subtract, {leaf(1), leaf(0)})}))));
  EXPECT_FALSE(is_union_of_convex(bent));
  EXPECT_FALSE(is_union_of_convex({"", {ball(Bend{-5e-324, 0.0})}}));
  EXPECT_FALSE(is_union_of_convex(difference));
}

std::string message_of(const std::function<void(const Model&)>& use, const Model& model) {
  try {
    use(model);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "no error";
}

/// `use` of other set operations is an input error that begins with `what`, of bent solids none.
void expect_refusal_of_csg(const std::function<void(const Model&)>& use, const std::string& what) {
  EXPECT_EQ(message_of(use, difference), what + ": not supported for csg other than the union of all primitives");
  EXPECT_EQ(message_of(use, bent), "no error");
}

/// `use` of either kind of model is an input error that begins with `what`.
void expect_refusal(const std::function<void(const Model&)>& use, const std::string& what) {
  const auto message = [&](const Model& model) { return message_of(use, model); };
  EXPECT_EQ(message(bent), what + ": not supported for bent solids: primitives[1].bend");
  EXPECT_EQ(message(difference), what + ": not supported for csg other than the union of all primitives");
  EXPECT_EQ(message(two_balls()), "no error");
}

TEST(ModelTest, ConvexCertificatesRefuseOtherSolids) {
  MapOptions options{.tolerance = 1.0, .device = "host"};
  expect_refusal_of_csg([](const Model& model) { (void)Checker(model, 0.5); }, "certificates of intervals");
  expect_refusal([](const Model& model) { (void)TriangleDistance(model); }, "distances of triangles");
  options.certificates = true;
  EXPECT_NO_THROW((void)PointMapper(difference, options));
  options.covers = false;
  expect_refusal_of_csg([&](const Model& model) { (void)PointMapper(model, options); }, "certificates without covers");
  expect_refusal([&](const Model& model) { (void)TriangleMapper(model, options); }, "certificates without covers");
  options.certificates = false;
  options.method = Method::published;
  expect_refusal([&](const Model& model) { (void)PointMapper(model, options); }, "the published method");
}

TEST(ModelTest, ThePublishedMethodRefusesBentSolids) {
  const Primitive solid = ball(Bend{0.5, 0.0});
  EXPECT_THROW((void)published_distance(solid, Point{3.0, 0.0, 0.0}), Error);
  EXPECT_THROW((void)published_distance(ball(), solid), Error);
  EXPECT_THROW((void)unverified_distance(solid, Point{3.0, 0.0, 0.0}), Error);
  EXPECT_THROW((void)unverified_distance(solid, ball()), Error);
}

TEST(ModelTest, UncertainTranslationsAreForUnionsOfConvexSolids) {
  expect_refusal(
      [](const Model& model) {
        UncertainModel widened = model;
        widened.primitives[0].translation[0] = {1.0, 1.5};
        (void)bracket(widened);
      },
      "intervals of translations");
}

/// Of what a difference removes the larger one leaves the smaller solid; what is removed from that is kept.
TEST(ModelTest, WhatIsRemovedBracketsTheOtherWay) {
  UncertainModel model =
      two_balls(operation(SetOperation::subtract, {leaf(0), operation(SetOperation::subtract, {leaf(1), leaf(0)})}));
  model.primitives[0].semi_axes[0] = {1.0, 1.5};
  model.primitives[1].semi_axes[0] = {3.0, 4.0};
  model.primitives[1].exponents[0] = {0.5, 0.7};
  const auto& [smallest, largest, inflated, shift] = bracket(model);
  EXPECT_EQ(shift, 0.0);
  EXPECT_FALSE(inflated);
  // Kept both times it is named, and once removed.
  ASSERT_EQ(smallest.primitives.size(), 2U);
  EXPECT_EQ(smallest.primitives[0].superquadric.semi_axes[0], 1.0);
  EXPECT_EQ(largest.primitives[0].superquadric.semi_axes[0], 1.5);
  EXPECT_EQ(smallest.primitives[1].superquadric.semi_axes[0], 4.0);
  EXPECT_EQ(smallest.primitives[1].superquadric.exponents[0], 0.5);
  EXPECT_EQ(largest.primitives[1].superquadric.semi_axes[0], 3.0);
  EXPECT_EQ(largest.primitives[1].superquadric.exponents[0], 0.7);
  model.csg = operation(SetOperation::unite, {leaf(1), operation(SetOperation::subtract, {leaf(0), leaf(1)})});
  const Bracket apart = bracket(model);
  ASSERT_EQ(apart.smallest.primitives.size(), 3U) << "one of them kept in one place and removed in another";
  EXPECT_EQ(apart.smallest.primitives[0].superquadric.semi_axes[0], 3.0);
  EXPECT_EQ(apart.smallest.primitives[2].superquadric.semi_axes[0], 4.0);
  EXPECT_EQ(apart.largest.csg->operands[1].operands[1].primitive, 2U);
}

TEST(ModelTest, ExactModelsAreTheirOwnBrackets) {
  for (const Model& model : {bent, difference}) {
    const Bracket models = bracket(model);
    EXPECT_EQ(models.shift, 0.0);
    EXPECT_FALSE(models.inflated);
    for (const Model& same : {models.smallest, models.largest}) {
      EXPECT_EQ(same.csg.has_value(), model.csg.has_value());
      EXPECT_EQ(same.primitives[1].bend.has_value(), model.primitives[1].bend.has_value());
    }
  }
}

}  // namespace
}  // namespace verisq
