/// The whole surface against a model: balls in closed form, any model against distances at many of its points.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/real.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::oracle {
namespace {

using verisq::testing::expect_error;
using verisq::testing::Random;

Primitive ball(const Point& centre, double radius) {
  return {"ball", {{radius, radius, radius}, {1.0, 1.0}}, {centre}, {}};
}

Model ball_model(const Point& centre, double radius) {
  return {"", {ball(centre, radius)}, {}};
}

Mesh soup(std::span<const Triangle> triangles) {
  Mesh mesh;
  for (const Triangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), triangle.begin(), triangle.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Triangle corners_of(const Mesh& mesh, std::size_t n) {
  const auto& [a, b, c] = mesh.triangles[n];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

MeshClearance clearance(const Model& model, const Mesh& mesh, double limit, double tolerance) {
  return mesh_clearance(
      model, mesh,
      {.penetration_limit = limit, .tolerance = tolerance, .limit_tolerance = tolerance, .device = "host"});
}

MeshClearance clearance(const Model& model, const Triangle& triangle, double limit, double tolerance) {
  return clearance(model, soup({&triangle, 1}), limit, tolerance);
}

Vector along(const Vector& from, const Vector& way, const Real& share) {
  return {from[0] + share * way[0], from[1] + share * way[1], from[2] + share * way[2]};
}

Real distance_to_side(const Vector& p, const Vector& a, const Vector& b) {
  const Vector side = difference(b, a);
  const Real squared = dot(side, side);
  if (squared == 0) return length(difference(p, a));
  const Real share = std::clamp(Real(dot(difference(p, a), side) / squared), Real(0), Real(1));
  return length(difference(p, along(a, side, share)));
}

/// Of a point from a triangle: from its plane where the foot lies inside, else from the nearest side. 200 bits.
Real distance_to_triangle(const Point& point, const Triangle& triangle) {
  const Vector p = widened(point);
  const std::array<Vector, 3> corners{widened(triangle[0]), widened(triangle[1]), widened(triangle[2])};
  const auto& [a, b, c] = corners;
  const Real to_sides = std::min({distance_to_side(p, a, b), distance_to_side(p, b, c), distance_to_side(p, c, a)});
  const auto cross = [](const Vector& u, const Vector& v) {
    return Vector{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  };
  const Vector normal = cross(difference(b, a), difference(c, a));
  if (dot(normal, normal) == 0) return to_sides;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector& from = corners[i];
    if (dot(cross(difference(corners[(i + 1) % 3], from), difference(p, from)), normal) < 0) return to_sides;
  }
  return abs(dot(difference(p, a), normal)) / length(normal);
}

std::uint64_t counted(const MeshClearance& found) {
  return found.proven_within + found.proven_too_deep + found.undecided;
}

Triangle random_triangle(Random& random, double reach, double size) {
  const Point middle = random.point(reach);
  Triangle triangle{};
  for (Point& corner : triangle) {
    corner = random.point(size);
    for (std::size_t i = 0; i < 3; ++i) corner[i] += middle[i];
  }
  return triangle;
}

/// One triangle of which `exact` is the smallest signed distance.
void expect_sound(const MeshClearance& found, const Real& exact, double limit) {
  EXPECT_LE(found.smallest_distance.lo, exact);
  EXPECT_GE(found.smallest_distance.hi, exact);
  EXPECT_EQ(counted(found), 1U);
  EXPECT_EQ(found.too_deep.size(), found.proven_too_deep);
  if (found.proven_within > 0) {
    EXPECT_GE(exact, -limit);
  }
  if (found.proven_too_deep > 0) {
    EXPECT_LT(exact, -limit);
  }
}

void expect_decided(const MeshClearance& found, const Real& exact, double limit, double tolerance) {
  expect_sound(found, exact, limit);
  EXPECT_LE(found.smallest_distance.width(), tolerance);
  if (abs(exact + limit) > tolerance) {
    EXPECT_EQ(found.undecided, 0U);
  }
}

TEST(MeshClearance, OfABallIsTheDistanceToItsCentre) {
  Random random(2);
  std::array<std::uint64_t, 2> decided{};
  for (int n = 0; n < 200; ++n) {
    const Point centre = random.point(1.0);
    const double radius = random.uniform(0.3, 2.0);
    const Triangle triangle = random_triangle(random, 2.0, std::pow(10.0, random.uniform(-2.0, 1.0)));
    const double limit = n % 3 == 0 ? 0.0 : random.uniform(0.0, 1.0);
    const double tolerance = std::pow(10.0, random.uniform(-2.5, -1.0));
    const MeshClearance found = clearance(ball_model(centre, radius), triangle, limit, tolerance);
    expect_decided(found, distance_to_triangle(centre, triangle) - radius, limit, tolerance);
    decided[0] += found.proven_within;
    decided[1] += found.proven_too_deep;
  }
  EXPECT_GT(decided[0], 30U);
  EXPECT_GT(decided[1], 20U);
}

// A vertex alone would tell nothing: all three lie far outside.
TEST(MeshClearance, SeesWhatPiercesBetweenVertices) {
  const Triangle wall{{{0.5, -40.0, -30.0}, {0.5, 50.0, -20.0}, {0.5, 0.0, 60.0}}};
  const Model model = ball_model({}, 1.0);  // 0.5 deep
  for (const double limit : {0.0, 0.25, 0.4, 0.48}) {
    const MeshClearance found = clearance(model, wall, limit, 1e-2);
    EXPECT_EQ(found.proven_too_deep, 1U) << limit;
    ASSERT_EQ(found.too_deep.size(), 1U);
    const auto& [x, y, z] = found.too_deep.front().point;
    EXPECT_EQ(found.too_deep.front().triangle, 0U);
    EXPECT_NEAR(x, 0.5, 1e-12);
    EXPECT_LT(std::hypot(x, y, z) - 1.0, -limit);
  }
  for (const double limit : {0.52, 0.6, 2.0}) {
    EXPECT_EQ(clearance(model, wall, limit, 1e-2).proven_within, 1U) << limit;
  }
  EXPECT_EQ(clearance(model, wall, 0.5, 1e-2).proven_too_deep, 0U);
}

// As exact as the limit is: bounds that are off by more than roundings decide wrongly.
TEST(MeshClearance, DecidesOnTheRightSideOfTheLimit) {
  Random random(3);
  for (int n = 0; n < 100; ++n) {
    const Triangle triangle = random_triangle(random, 0.4, std::pow(10.0, random.uniform(-1.0, 1.0)));
    const Real exact = distance_to_triangle({}, triangle) - 1;
    const double off = random.uniform(-1.0, 1.0) * std::pow(10.0, random.uniform(-8.0, -1.0));
    const double limit = std::max(0.0, -exact.convert_to<double>() + off);
    const MeshClearance found = clearance(ball_model({}, 1.0), triangle, limit, 1e-2);
    expect_decided(found, exact, limit, 1e-2);
  }
}

// As small as what is not divided any more, and as thin as what is taken for a segment: nothing else hides there what a
// ball leaves out.
TEST(MeshClearance, DecidesTinyTrianglesOnTheRightSideOfTheLimit) {
  Random random(10);
  constexpr double tolerance = 1e-2;
  for (int n = 0; n < 3000; ++n) {
    const double angle = random.uniform(0.0, 6.3);
    const double across = tolerance * random.uniform(0.02, 0.2);
    const double along = tolerance * random.uniform(0.2, 0.8);
    const Point corner{0.5, random.uniform(-0.01, 0.01), 0.0};
    Triangle triangle{
        {corner,
         {corner[0] + along * std::cos(angle), corner[1] + along * std::sin(angle), 0.0},
         {corner[0] - across * std::sin(angle), corner[1] + across * std::cos(angle), random.uniform(-1e-4, 1e-4)}}};
    if (n % 2 == 0) std::swap(triangle[1], triangle[2]);
    const Real exact = distance_to_triangle({}, triangle) - 1;
    const double limit = -exact.convert_to<double>() - 1e-6;
    expect_sound(clearance(ball_model({}, 1.0), triangle, limit, tolerance), exact, limit);
  }
}

TEST(MeshClearance, DecidesTheLimitAsCloselyAsAsked) {
  const Triangle wall{{{0.5, -4.0, -3.0}, {0.5, 5.0, -2.0}, {0.5, 0.0, 6.0}}};
  const Mesh mesh = soup({&wall, 1});
  MeshClearanceOptions options{.penetration_limit = 0.5 + 1e-2, .tolerance = 0.5, .device = "host"};
  Model twice = ball_model({}, 1.0);
  twice.primitives.push_back(twice.primitives.front());  // where half-spaces say nothing
  const MeshClearance coarse = mesh_clearance(twice, mesh, options);
  EXPECT_EQ(coarse.undecided, 1U);
  options.limit_tolerance = 5e-3;
  const MeshClearance fine = mesh_clearance(twice, mesh, options);
  EXPECT_EQ(fine.proven_within, 1U);
  EXPECT_GT(fine.samples, coarse.samples);
}

Point point_on(const Triangle& triangle, Random& random) {
  double s = random.uniform(0.0, 1.0);
  double t = random.uniform(0.0, 1.0);
  if (s + t > 1.0) {
    s = 1.0 - s;
    t = 1.0 - t;
  }
  Point point{};
  for (std::size_t i = 0; i < 3; ++i) {
    point[i] = triangle[0][i] + s * (triangle[1][i] - triangle[0][i]) + t * (triangle[2][i] - triangle[0][i]);
  }
  return point;
}

/// Against the proven distances of points of each triangle: its corners, middles, and random ones.
void expect_sound_at_points(const Model& model, const Mesh& mesh, double limit, double tolerance, Random& random) {
  const SignedDistance distance(model);
  const double rounding = 1e-13 * (bounding_radius(model) + 10.0);
  const MeshClearance whole = clearance(model, mesh, limit, tolerance);
  EXPECT_EQ(counted(whole), mesh.triangles.size());
  EXPECT_EQ(whole.too_deep.size(), whole.proven_too_deep);
  double smallest_hi = infinity;
  MeshClearance sum;
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const Triangle triangle = corners_of(mesh, n);
    const MeshClearance alone = clearance(model, triangle, limit, tolerance);
    EXPECT_EQ(counted(alone), 1U);
    sum.proven_too_deep += alone.proven_too_deep;
    sum.proven_within += alone.proven_within;
    smallest_hi = std::min(smallest_hi, alone.smallest_distance.hi);
    EXPECT_LE(whole.smallest_distance.lo, alone.smallest_distance.hi);
    for (int k = 0; k < 12; ++k) {
      const Point point = k < 3 ? triangle[static_cast<std::size_t>(k)] : point_on(triangle, random);
      const Enclosure at = distance(point, 0.1 * tolerance);
      EXPECT_LE(alone.smallest_distance.lo, at.hi + rounding);
      EXPECT_LE(whole.smallest_distance.lo, at.hi + rounding);
      if (alone.proven_within > 0) {
        EXPECT_GE(at.hi, -limit - rounding);
      }
    }
    for (const auto& [deep, index] : alone.too_deep) {
      EXPECT_EQ(index, 0U);
      EXPECT_LT(distance_to_triangle(deep, triangle), rounding);
      EXPECT_LT(distance(deep, 0.1 * tolerance).lo, -limit + rounding);
    }
  }
  EXPECT_GE(whole.smallest_distance.hi, smallest_hi - tolerance);
  EXPECT_LE(whole.smallest_distance.width(), tolerance);
  // Decisions may differ where one leaves a triangle open, not where both are proven.
  EXPECT_LE(whole.proven_too_deep + sum.proven_within, mesh.triangles.size());
  EXPECT_LE(sum.proven_too_deep + whole.proven_within, mesh.triangles.size());
}

TEST(MeshClearance, IsNeverAboveTheDistanceOfAPoint) {
  Random random(4);
  const Model stem{"",
                   {{"shaft", {{1.0, 1.4, 6.0}, {0.7, 0.9}}, {{0.0, 0.0, -3.0}, {1.0, 0.1, 0.0, 0.0}}, {}},
                    {"neck", {{0.8, 0.8, 3.0}, {0.4, 1.0}}, {{1.0, 0.5, 3.0}, {0.9, 0.3, -0.2, 0.1}}, {}}},
                   {}};
  for (int n = 0; n < 3; ++n) {
    std::vector<Triangle> triangles;
    triangles.reserve(25);
    for (int k = 0; k < 25; ++k) triangles.push_back(random_triangle(random, 4.0, random.uniform(0.1, 6.0)));
    expect_sound_at_points(stem, soup(triangles), random.uniform(0.0, 0.8), 0.05, random);
  }
}

TEST(MeshClearance, OfTaperedModelsIsEnclosedToo) {
  Random random(9);
  const Model stem{"",
                   {{"shaft", {{1.0, 1.4, 6.0}, {0.7, 0.9}, 2.0}, {{0.0, 0.0, -3.0}, {1.0, 0.1, 0.0, 0.0}}, {}},
                    {"neck", {{0.8, 0.8, 3.0}, {0.4, 1.0}, 0.7}, {{1.0, 0.5, 3.0}, {0.9, 0.3, -0.2, 0.1}}, {}}},
                   {}};
  std::vector<Triangle> triangles;
  for (int k = 0; k < 15; ++k) triangles.push_back(random_triangle(random, 4.0, random.uniform(0.1, 6.0)));
  expect_sound_at_points(stem, soup(triangles), 0.4, 0.05, random);
}

TEST(MeshClearance, OfBentModelsAndSetOperationsIsEnclosedToo) {
  Random random(5);
  RandomSolids solids(5);
  for (const ModelFamily family : {ModelFamily::bent, ModelFamily::plain_csg, ModelFamily::bent_csg}) {
    const Model model = solids.model(family);
    const double size = bounding_radius(model);
    Point centre{};
    for (const Primitive& primitive : model.primitives) {
      for (std::size_t i = 0; i < 3; ++i)
        centre[i] += primitive.pose.translation[i] / static_cast<double>(model.primitives.size());
    }
    std::vector<Triangle> triangles;
    for (int k = 0; k < 6; ++k) {
      Triangle triangle = random_triangle(random, 0.8 * size, 0.5 * size);
      for (Point& corner : triangle)
        for (std::size_t i = 0; i < 3; ++i) corner[i] += centre[i];
      triangles.push_back(triangle);
    }
    expect_sound_at_points(model, soup(triangles), 0.05 * size, 0.04 * size, random);
  }
}

// Where samples are as wide as they may be, and nothing but them is left.
TEST(MeshClearance, OfSinglePointsIsAsTrueAsItsSamples) {
  Random random(11);
  const SetExpression small{.primitive = 0};
  const SetExpression large{.primitive = 1};
  const Model lens{"",
                   {ball({}, 1.0), ball({0.1, 0.0, 0.0}, 3.0)},
                   SetExpression{.operands = {small, large}, .operation = SetOperation::intersect}};
  for (int n = 0; n < 200; ++n) {
    const Point point = random.point(1.2);
    const Real exact = distance_to_triangle({}, {point, point, point}) - 1;
    const double limit = std::max(0.0, -exact.convert_to<double>() + random.uniform(-1e-3, 1e-3));
    expect_sound(clearance(lens, {point, point, point}, limit, 0.1), exact, limit);
  }
}

// The middle of three equal points rounds, too.
TEST(MeshClearance, OfSinglePointsFarFromTheOrigin) {
  Random random(12);
  for (int n = 0; n < 200; ++n) {
    const Point far = random.point(1e9);
    const Point step = random.point(2.0);
    const Point point{far[0] + step[0], far[1] + step[1], far[2] + step[2]};
    const Real exact = distance_to_triangle(far, {point, point, point}) - 1;
    expect_sound(clearance(ball_model(far, 1.0), {point, point, point}, 0.0, 0.1), exact, 0.0);
  }
}

TEST(MeshClearance, OfAClosedSurfaceCountsEveryTriangleOnce) {
  const Mesh sphere = verisq::testing::sphere_mesh(3);
  const Model model = ball_model({0.5, 0.0, 0.0}, 0.6);  // out of the unit sphere by 0.1 at (1, 0, 0)
  const MeshClearance found = clearance(model, sphere, 0.05, 1e-2);
  EXPECT_EQ(counted(found), sphere.triangles.size());
  EXPECT_GT(found.proven_too_deep, 0U);
  EXPECT_GT(found.proven_within, found.proven_too_deep);
  Real exact = infinity;
  for (std::size_t n = 0; n < sphere.triangles.size(); ++n)
    exact = std::min(exact, Real(distance_to_triangle({0.5, 0.0, 0.0}, corners_of(sphere, n)) - Real(0.6)));
  EXPECT_LE(found.smallest_distance.lo, exact);
  EXPECT_GE(found.smallest_distance.hi, exact);
  for (const auto& [point, n] : found.too_deep) {
    EXPECT_LT(std::hypot(point[0] - 0.5, point[1], point[2]) - 0.6, -0.05);
    EXPECT_LT(distance_to_triangle(point, corners_of(sphere, n)), 1e-12);
  }
}

TEST(MeshClearance, IsValidWhereverItIsInterrupted) {
  Random random(6);
  std::vector<Triangle> triangles;
  triangles.reserve(40);
  for (int k = 0; k < 40; ++k) triangles.push_back(random_triangle(random, 2.0, 2.0));
  const Mesh mesh = soup(triangles);
  Real exact = infinity;
  for (const Triangle& triangle : triangles) exact = std::min(exact, Real(distance_to_triangle({}, triangle) - 1));
  for (int polls = 0; polls < 12; ++polls) {
    int polled = 0;
    const MeshClearance found = mesh_clearance(
        ball_model({}, 1.0), mesh, {.penetration_limit = 0.2, .tolerance = 1e-9, .device = "host", .interrupted = [&] {
                                      return polled++ >= polls;
                                    }});
    EXPECT_TRUE(found.interrupted || polled <= polls);
    EXPECT_EQ(counted(found), mesh.triangles.size());
    EXPECT_LE(found.smallest_distance.lo, exact);
    EXPECT_GE(found.smallest_distance.hi, exact);
    std::uint64_t too_deep = 0;
    for (const Triangle& triangle : triangles) too_deep += distance_to_triangle({}, triangle) - 1 < -0.2 ? 1 : 0;
    EXPECT_LE(found.proven_too_deep, too_deep);
    EXPECT_LE(found.proven_within, triangles.size() - too_deep);
    if (polls == 0) {
      EXPECT_TRUE(found.interrupted);
      EXPECT_EQ(found.smallest_distance, (Enclosure{-infinity, infinity}));
      EXPECT_EQ(found.undecided, triangles.size());
    }
  }
}

TEST(MeshClearance, IsValidWhereItRunsOutOfSamples) {
  Random random(7);
  for (const std::uint64_t most : {0U, 1U, 5U, 30U}) {
    const Triangle triangle = random_triangle(random, 0.3, 3.0);
    const MeshClearance found =
        mesh_clearance(ball_model({}, 1.0), soup({&triangle, 1}),
                       {.penetration_limit = 0.1, .tolerance = 1e-9, .most_samples = most, .device = "host"});
    expect_sound(found, distance_to_triangle({}, triangle) - 1, 0.1);
    EXPECT_LE(found.samples, most);
    EXPECT_FALSE(found.interrupted);
  }
}

TEST(MeshClearance, FarFromTheOrigin) {
  Random random(8);
  for (int n = 0; n < 60; ++n) {
    const Point far = random.point(1e9);
    Triangle triangle = random_triangle(random, 0.5, 3.0);
    for (Point& corner : triangle)
      for (std::size_t i = 0; i < 3; ++i) corner[i] += far[i];
    const MeshClearance found = clearance(ball_model(far, 1.0), triangle, 0.1, 1e-2);
    expect_decided(found, distance_to_triangle(far, triangle) - 1, 0.1, 1e-2);
  }
}

TEST(MeshClearance, OfSliversNeedlesAndPoints) {
  Random random(9);
  for (int n = 0; n < 120; ++n) {
    Triangle triangle = random_triangle(random, 0.5, 4.0);
    const double share = random.uniform(-0.2, 1.2);
    const double width = n % 4 == 0 ? 0.0 : std::pow(10.0, random.uniform(-18.0, -1.0));
    for (std::size_t i = 0; i < 3; ++i)
      triangle[2][i] = triangle[0][i] + share * (triangle[1][i] - triangle[0][i]) + width * random.uniform(-1.0, 1.0);
    if (n % 20 == 1) triangle[1] = triangle[2] = triangle[0];
    if (n % 20 == 2) triangle[1] = triangle[0];
    const MeshClearance found = clearance(ball_model({}, 1.0), triangle, 0.2, 1e-2);
    expect_decided(found, distance_to_triangle({}, triangle) - 1, 0.2, 1e-2);
    EXPECT_LT(found.samples, 40000U);
  }
}

/// Of size `size`, its sides all but one line that passes within 1 of the origin.
Triangle far_needle_by_the_origin(Random& random, double size) {
  const Point begin = random.point(size);
  const Point offset = random.point(0.5);
  const double ratio = random.uniform(0.5, 2.0);
  Triangle needle{begin, {}, begin};
  for (std::size_t i = 0; i < 3; ++i) needle[1][i] = offset[i] - ratio * begin[i];
  return needle;
}

// Midpoints round by parts of the far corners, which pieces near the origin no longer show.
TEST(MeshClearance, HoldsForPiecesFarSmallerThanTheirTriangle) {
  Random random(1);
  for (int n = 0; n < 40; ++n) {
    const Triangle needle = far_needle_by_the_origin(random, 0x1p40);
    const MeshClearance found = clearance(ball_model({}, 1.0), needle, 0.1, 1e-5);
    expect_sound(found, distance_to_triangle({}, needle) - 1, 0.1);
    EXPECT_LT(found.samples, 1000U);
  }
}

TEST(MeshClearance, SurvivesHugeAndTinyCoordinates) {
  for (const double size : {1e-320, 1e-310, 1e-160, 1e150, 1e200, 1e300}) {
    const Triangle triangle{{{size, -size, 0.0}, {size, size, -size}, {size, 0.0, size}}};
    const MeshClearance found = mesh_clearance(ball_model({}, 1.0), soup({&triangle, 1}),
                                               {.tolerance = 1e-3, .most_samples = 300, .device = "host"});
    expect_sound(found, distance_to_triangle({}, triangle) - 1, 0.0);
  }
}

TEST(MeshClearance, NothingIsWithinALimitThatIsNoNumber) {
  const Triangle wall{{{0.5, -4.0, -3.0}, {0.5, 5.0, -2.0}, {0.5, 0.0, 6.0}}};
  EXPECT_EQ(clearance(ball_model({}, 1.0), wall, std::nan(""), 1e-2).undecided, 1U);
}

TEST(MeshClearance, RefusesMeshesWithoutTriangles) {
  const Mesh points{.vertices = {{0.0, 0.0, 0.0}}, .triangles = {}};
  expect_error([&] { (void)clearance(ball_model({}, 1.0), points, 0.0, 0.1); }, ErrorKind::input,
               "the mesh has no triangles", "");
}

}  // namespace
}  // namespace verisq::oracle
