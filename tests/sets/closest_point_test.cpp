/// Closest points of models: what is known of simple ones, and derivatives against differences of distances.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <random>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/places.hpp"

namespace verisq {
namespace {

constexpr double tolerance = 1e-6;

Primitive ball(double radius, const Point& centre) {
  return {"", {{radius, radius, radius}, {1.0, 1.0}}, {centre}};
}

Primitive box(const Point& half, const Point& centre) {
  return {"", {half, {0.1, 0.1}}, {centre}};
}

bool contains(const EnclosedPoint& box, const Point& x) {
  return box[0].contains(x[0]) && box[1].contains(x[1]) && box[2].contains(x[2]);
}

double widest(const EnclosedPoint& box) {
  return std::max({box[0].width(), box[1].width(), box[2].width()});
}

ClosestPoint closest(const Model& model, const Point& x) {
  return SignedDistance(model).closest_point(x, tolerance);
}

TEST(ClosestPoint, OfABallIsOnTheRayFromItsCentre) {
  const Model model{"", {ball(2.0, {1.0, 0.0, 0.0})}};
  for (const double apart : {5.0, 1.75}) {  // outside, inside: along the unit vector (3, 4, 12)/13
    const Point x{1.0 + apart * 3.0 / 13.0, apart * 4.0 / 13.0, apart * 12.0 / 13.0};
    const ClosestPoint found = closest(model, x);
    EXPECT_TRUE(found.unique) << apart;
    EXPECT_EQ(found.primitive, 0U);
    for (std::size_t k = 0; k < 3; ++k) {
      const double n = std::array{3.0, 4.0, 12.0}[k] / 13.0;
      EXPECT_NEAR(found.normal[k].lo, n, 4e-16) << apart;
      EXPECT_NEAR(found.point[k].hi, (k == 0 ? 1.0 : 0.0) + 2.0 * n, 2e-15) << apart;
    }
    EXPECT_LT(widest(found.point), 1e-15);
    EXPECT_LT(widest(found.normal), 1e-15);
    EXPECT_NEAR(found.distance.lo, apart - 2.0, 1e-15);
  }
}

TEST(ClosestPoint, OfTheMiddleOfABallIsNotUnique) {
  const ClosestPoint found = closest({"", {ball(2.0, {1.0, 0.0, 0.0})}}, {1.0, 0.0, 0.0});
  EXPECT_FALSE(found.unique);
  EXPECT_EQ(found.primitive, 0U);
  for (const Point& p : {Point{3.0, 0.0, 0.0}, Point{1.0, -2.0, 0.0}, Point{1.0, 0.0, 2.0}}) {
    EXPECT_TRUE(contains(found.point, p));
  }
}

/// Halfway between two faces there are two.
TEST(ClosestPoint, IsNotUniqueOnTheMedialAxis) {
  const Model model{"", {box({4.0, 3.0, 1.0}, {})}};
  EXPECT_FALSE(closest(model, {0.5, 0.25, 0.0}).unique);
  const ClosestPoint above = closest(model, {0.5, 0.25, 0.001});
  EXPECT_TRUE(above.unique);
  EXPECT_GT(above.normal[2].lo, 0.999);
}

TEST(ClosestPoint, OnASmoothSurfaceIsThePointItself) {
  const ClosestPoint found = closest({"", {ball(2.0, {})}}, {0.0, 2.0, 0.0});
  EXPECT_TRUE(found.unique);
  EXPECT_TRUE(contains(found.point, {0.0, 2.0, 0.0}));
  EXPECT_TRUE(contains(found.normal, {0.0, 1.0, 0.0}));
  EXPECT_LT(widest(found.normal), 1e-14);
}

/// The octahedron has a vertex there, and no normal.
TEST(ClosestPoint, OnAVertexHasNoGradient) {
  const Model octahedron{"", {{"", {{2.0, 2.0, 2.0}, {2.0, 2.0}}, {}}}};
  EXPECT_FALSE(closest(octahedron, {0.0, 0.0, 2.0}).unique);
  const ClosestPoint above = closest(octahedron, {0.25, 0.0, 5.0});
  EXPECT_TRUE(above.unique);
  EXPECT_TRUE(contains(above.point, {0.0, 0.0, 2.0}));
  const double length = std::hypot(0.25, 3.0);
  EXPECT_NEAR(above.normal[0].lo, 0.25 / length, 1e-9);
}

TEST(ClosestPoint, OfAUnionIsThatOfTheNearestPrimitive) {
  const Model model{"", {ball(1.0, {-3.0, 0.0, 0.0}), ball(1.0, {3.0, 0.0, 0.0})}};
  const ClosestPoint right = closest(model, {1.0, 0.0, 0.0});
  EXPECT_TRUE(right.unique);
  EXPECT_EQ(right.primitive, 1U);
  EXPECT_TRUE(contains(right.point, {2.0, 0.0, 0.0}));
  const ClosestPoint middle = closest(model, {0.0, 0.0, 0.0});
  EXPECT_FALSE(middle.unique);
  EXPECT_EQ(middle.primitive, std::nullopt);
  EXPECT_TRUE(contains(middle.point, {2.0, 0.0, 0.0}) && contains(middle.point, {-2.0, 0.0, 0.0}));
  EXPECT_TRUE(contains(middle.normal, {1.0, 0.0, 0.0}) && contains(middle.normal, {-1.0, 0.0, 0.0}));
}

/// Within the overlap the nearest point of one ball lies in the other: no surface of the union.
TEST(ClosestPoint, OfAnOverlapIsNotThatOfOnePrimitive) {
  const Model model{"", {ball(2.0, {-1.0, 0.0, 0.0}), ball(2.0, {1.0, 0.0, 0.0})}};
  EXPECT_FALSE(closest(model, {0.25, 0.125, 0.0}).unique);
  const ClosestPoint end = closest(model, {2.5, 0.125, 0.0});  // inside the right one, away from the left one
  EXPECT_TRUE(end.unique);
  EXPECT_EQ(end.primitive, 1U);
}

/// A tube whose middle lies on the circle of radius 2 about (2, 0, 0): in the plane z = 0 its section is a disc.
Primitive bent_tube() {
  return {"", {{0.25, 0.25, 1.0}, {0.1, 1.0}}, {}, Bend{0.5, 0.0}};
}

TEST(ClosestPoint, OutsideABentSolidIsUnique) {
  const Model model{"", {bent_tube()}};
  for (const double apart : {0.2501, 0.375, 1.0, 4.0}) {
    const Point x{-apart * 0.6, apart * 0.8, 0.0};  // away from the centre: no other part of the tube is as near
    const ClosestPoint found = closest(model, x);
    EXPECT_TRUE(found.unique) << apart;
    EXPECT_EQ(found.primitive, 0U);
    EXPECT_NEAR(found.point[0].lo, -0.15, 1e-16 + found.point[0].width());
    EXPECT_NEAR(found.point[1].lo, 0.2, 1e-16 + found.point[1].width());
    EXPECT_TRUE(found.point[2].contains(0.0));
    EXPECT_TRUE(found.normal[2].contains(0.0));
    EXPECT_NEAR(found.normal[0].lo, -0.6, 1e-12);
    EXPECT_LE(widest(found.point), 1e-15);
    EXPECT_LE(widest(found.normal), 1e-11);
  }
  const ClosestPoint inside = closest(model, {0.1, 0.0, 0.0});
  EXPECT_FALSE(inside.unique);
  EXPECT_LT(inside.distance.hi, 0.0);
}

/// Both ends of the arc are as far from its plane of symmetry, and from its centre nearly all of it is.
TEST(ClosestPoint, OfABentSolidIsNotUniqueWhereTwoPointsAre) {
  const Model model{"", {bent_tube()}};
  EXPECT_FALSE(closest(model, {2.0, 0.0, 0.0}).unique);
  EXPECT_FALSE(closest(model, {3.0, 0.0, 0.0}).unique);
}

TEST(ClosestPoint, OfAUnionWithABentSolidIsThatOfTheNearestPrimitive) {
  const Model model{"", {bent_tube(), ball(0.5, {0.0, 0.0, 2.0})}};
  EXPECT_EQ(closest(model, {-1.0, 0.0, 0.0}).primitive, 0U);
  const ClosestPoint above = closest(model, {0.0, 0.0, 4.0});
  EXPECT_TRUE(above.unique);
  EXPECT_EQ(above.primitive, 1U);
  EXPECT_TRUE(contains(above.point, {0.0, 0.0, 2.5}));
  const ClosestPoint inside =
      closest(model, {0.0, 0.125, 2.25});  // of the ball, whose nearest point the tube leaves free
  EXPECT_TRUE(inside.unique);
  EXPECT_EQ(inside.primitive, 1U);
}

SetExpression leaf(std::uint32_t primitive) {
  return {{}, SetOperation::unite, primitive};
}

/// A cup: the ball of radius 3, bored out by one of radius 2, without what lies above z = 1.
Model cup() {
  Model model{"", {ball(3.0, {}), ball(2.0, {}), box({5.0, 5.0, 5.0}, {0.0, 0.0, 6.0})}};
  model.primitives[2].superquadric.exponents = {0.05, 0.05};
  model.csg = SetExpression{{leaf(0), leaf(1), leaf(2)}, SetOperation::subtract};
  return model;
}

/// Whichever side of it the query is on, normals point out of the solid.
TEST(ClosestPoint, OfADifferenceIsThatOfTheSurfaceBesideIt) {
  const SignedDistance distance(cup());
  const auto expect = [&](const Point& x, std::uint32_t primitive, double sd, const Point& p, const Point& normal) {
    const ClosestPoint found = distance.closest_point(x, tolerance);
    EXPECT_TRUE(found.unique) << x[0] << " " << x[2];
    EXPECT_EQ(found.primitive, primitive);
    EXPECT_NEAR(found.distance.lo, sd, 1e-14);
    EXPECT_NEAR(found.distance.hi, sd, 1e-14);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(found.point[k].lo, p[k], 1e-14);
      EXPECT_NEAR(found.point[k].hi, p[k], 1e-14);
      EXPECT_NEAR(found.normal[k].lo, normal[k], 1e-13);
      EXPECT_NEAR(found.normal[k].hi, normal[k], 1e-13);
    }
  };
  expect({0.0, 2.4, -3.2}, 0, 1.0, {0.0, 1.8, -2.4}, {0.0, 0.6, -0.8});     // outside of the cup
  expect({0.0, 1.68, -2.24}, 0, -0.2, {0.0, 1.8, -2.4}, {0.0, 0.6, -0.8});  // in its wall, outer half
  expect({0.0, 1.32, -1.76}, 1, -0.2, {0.0, 1.2, -1.6}, {0.0, -0.6, 0.8});  // inner half
  expect({0.0, 1.08, -1.44}, 1, 0.2, {0.0, 1.2, -1.6}, {0.0, -0.6, 0.8});   // in the bore
  EXPECT_FALSE(distance.closest_point({0.0, 1.5, -2.0}, tolerance).unique) << "in the middle of the wall";
  EXPECT_FALSE(distance.closest_point({0.0, 0.0, 2.0}, tolerance).unique) << "nearest to the rim";
}

/// The surface of a ball is nearer that an intersection leaves nothing of there.
TEST(ClosestPoint, PassesOverSurfacesThatAreCutAway) {
  Model model{"", {ball(1.0, {-2.0, 0.0, 0.0}), ball(1.0, {2.0, 0.0, 0.0}), ball(1.0, {3.5, 0.0, 0.0})}};
  model.csg = SetExpression{{leaf(0), {{leaf(1), leaf(2)}, SetOperation::intersect}}, SetOperation::unite};
  const ClosestPoint found = closest(model, {0.125, 0.0, 0.0});
  EXPECT_TRUE(found.unique);
  EXPECT_EQ(found.primitive, 0U);
  EXPECT_NEAR(found.distance.lo, 1.125, 1e-14);
}

TEST(ClosestPoint, OfADifferenceOfABentSolidIsKnownOutside) {
  Model model{"", {bent_tube(), ball(0.125, {})}};
  model.csg = SetExpression{{leaf(0), leaf(1)}, SetOperation::subtract};
  const ClosestPoint outside = closest(model, {-1.0, 0.0, 0.0});
  EXPECT_TRUE(outside.unique);
  EXPECT_EQ(outside.primitive, 0U);
  const ClosestPoint bored = closest(model, {0.048, 0.036, 0.08});  // inside, off the axes
  EXPECT_TRUE(bored.unique);
  EXPECT_EQ(bored.primitive, 1U);
  EXPECT_NEAR(bored.distance.lo, 0.025, 1e-14);
  const ClosestPoint wall = closest(model, {0.0, 0.24, 0.0});  // beside the tube's surface, from inside
  EXPECT_FALSE(wall.unique);
  EXPECT_EQ(wall.primitive, 0U);
  EXPECT_LT(wall.distance.hi, 0.0);
  EXPECT_LT(wall.point[1].width(), 0.2);
}

TEST(ClosestPoint, WithinAKnownDistanceIsAnywhereSoFar) {
  const ClosestPoint found = closest_point_within({-3.0, -2.0}, {1.0, 2.0, 0.1});
  EXPECT_EQ(found.point[0], (Enclosure{-2.0, 4.0}));
  EXPECT_LE(found.point[2].lo, 0.1 - 3.0);
  EXPECT_FALSE(found.unique);
}

/// A model and points about it, outside and inside.
struct Scene {
  Model model;
  std::vector<Point> points;
};

Scene tapered_stem() {
  Scene scene{read_model(places::example("tapered_stem.json")), {}};
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> coordinate(-40.0, 40.0);
  for (int i = 0; i < 60; ++i) scene.points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  return scene;
}

Scene bent_union() {
  Scene scene{{"", {bent_tube(), ball(0.5, {0.0, 0.0, 2.0})}}, {}};
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> coordinate(-3.0, 0.0);
  for (int i = 0; i < 10; ++i) scene.points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  return scene;
}

/// Middle of the tightest enclosure: right to some 1e-14 of the size.
double signed_distance(const SignedDistance& distance, const Point& x) {
  const auto [lo, hi] = distance(x, 0.0);
  return 0.5 * (lo + hi);
}

/// Central differences with steps of 1e-4 are right to 1e-8 times third derivatives, and 1e-14/1e-4.
constexpr double step = 1e-4;

TEST(ClosestPoint, HasTheGradientByPositionAsItsNormal) {
  const Scene scene = tapered_stem();
  const SignedDistance distance(scene.model);
  std::size_t unique = 0;
  for (const Point& x : scene.points) {
    const ClosestPoint found = distance.closest_point(x, tolerance);
    if (!found.unique) continue;
    ++unique;
    for (std::size_t k = 0; k < 3; ++k) {
      Point more = x;
      Point less = x;
      more[k] += step;
      less[k] -= step;
      const double difference =
          (signed_distance(distance, more) - signed_distance(distance, less)) / (more[k] - less[k]);
      EXPECT_NEAR(found.normal[k].lo, difference, 1e-6);
      EXPECT_LE(found.normal[k].width(), 1e-9);
    }
  }
  EXPECT_GE(unique, 50U);
}

TEST(ClosestPoint, OutsideABentSolidHasTheGradientAsItsNormal) {
  const Scene scene = bent_union();
  const SignedDistance distance(scene.model);
  for (const Point& x : scene.points) {
    const ClosestPoint found = distance.closest_point(x, tolerance);
    ASSERT_TRUE(found.unique);
    EXPECT_LE(widest(found.normal), 1e-8);  // beside the tube's rim; elsewhere 1e-15
    for (std::size_t k = 0; k < 3; ++k) {
      Point more = x;
      Point less = x;
      more[k] += step;
      less[k] -= step;
      const double rise =
          distance.closest_point(more, tolerance).distance.lo - distance.closest_point(less, tolerance).distance.lo;
      EXPECT_NEAR(found.normal[k].lo, rise / (more[k] - less[k]), 1e-6);
    }
  }
}

Pose small_motion(std::size_t parameter, double size, const Point& centre) {
  Pose pose;
  if (parameter < 3) {
    pose.translation[parameter] = size;
    return pose;
  }
  const std::size_t axis = parameter - 3;
  pose.quaternion = {std::cos(size / 2), 0.0, 0.0, 0.0};
  pose.quaternion[1 + axis] = std::sin(size / 2);
  // x -> c + R (x - c)
  const std::size_t j = (axis + 1) % 3;
  const std::size_t k = (axis + 2) % 3;
  const double cosine = std::cos(size);
  const double sine = std::sin(size);
  pose.translation[j] = centre[j] - (cosine * centre[j] - sine * centre[k]);
  pose.translation[k] = centre[k] - (sine * centre[j] + cosine * centre[k]);
  return pose;
}

/// Of a motion of the model, the negatives of those of the point.
TEST(ClosestPoint, GivesTheGradientByMotions) {
  const Scene scene = tapered_stem();
  const SignedDistance distance(scene.model);
  const Point centre{3.0, -5.0, 10.0};
  for (std::size_t parameter = 0; parameter < 6; ++parameter) {
    const double size = parameter < 3 ? step : step / 40.0;
    const SignedDistance further(posed(scene.model, small_motion(parameter, size, centre)));
    const SignedDistance back(posed(scene.model, small_motion(parameter, -size, centre)));
    for (std::size_t i = 0; i < scene.points.size(); i += 5) {
      const Point& x = scene.points[i];
      const ClosestPoint found = distance.closest_point(x, tolerance);
      if (!found.unique) continue;
      const Enclosure gradient = gradient_by_motion(found, x, centre)[parameter];
      const double difference = (signed_distance(further, x) - signed_distance(back, x)) / (2.0 * size);
      EXPECT_NEAR(-gradient.lo, difference, 1e-6 * std::max(1.0, std::fabs(difference)));
      EXPECT_LE(gradient.width(), 1e-7);
    }
  }
}

TEST(ClosestPoints, OfManyPointsAreThoseOfEach) {
  const Scene scene = tapered_stem();
  const SignedDistance distance(scene.model);
  std::vector<ClosestPoint> rows(scene.points.size());
  const ClosestPointSummary summary = closest_points(distance, scene.points, rows, {.tolerance = tolerance});
  EXPECT_EQ(summary, summary_of(rows));
  EXPECT_EQ(summary.points, rows.size());
  for (std::size_t i = 0; i < rows.size(); i += 7) {
    const ClosestPoint one = distance.closest_point(scene.points[i], tolerance);
    EXPECT_EQ(rows[i].point, one.point);
    EXPECT_EQ(rows[i].normal, one.normal);
  }
}

TEST(ClosestPoints, EndWhenInterrupted) {
  const Scene scene = tapered_stem();
  std::vector<ClosestPoint> rows(scene.points.size());
  const ClosestPointSummary summary = closest_points(SignedDistance(scene.model), scene.points, rows,
                                                     {.tolerance = tolerance, .interrupted = [] { return true; }});
  EXPECT_TRUE(summary.interrupted);
  EXPECT_EQ(summary.points, 0U);
  EXPECT_EQ(rows.back().point[0], (Enclosure{-infinity, infinity}));
}

TEST(ClosestPoints, RefuseWhatDoesNotFit) {
  const SignedDistance distance(Model{"", {ball(1.0, {})}});
  std::vector<ClosestPoint> rows(1);
  const std::vector<Point> points{{0.0, 0.0, std::nan("")}};
  EXPECT_THROW(closest_points(distance, points, rows, {.tolerance = tolerance}), Error);
  EXPECT_THROW(closest_points(distance, std::vector<Point>(2), rows, {.tolerance = tolerance}), Error);
}

}  // namespace
}  // namespace verisq
