/// The choice of models and triangles.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/mutation/triangle_judge.hpp"
#include "tests/oracle/random_triangles.hpp"

namespace verisq::mutation {
namespace {

using oracle::PosedSolid;
using oracle::RandomCases;

/// In a random pose, its largest semi-axis in [1, 2).
Primitive random_solid(RandomCases& random) {
  Superquadric superquadric = random.solid().superquadric;
  const int exponent = std::ilogb(std::ranges::max(superquadric.semi_axes));
  for (double& axis : superquadric.semi_axes) axis = std::ldexp(axis, -exponent);
  return random.solid(superquadric);
}

Point moved(const Point& x, const Point& direction, double distance) {
  return {x[0] + distance * direction[0], x[1] + distance * direction[1], x[2] + distance * direction[2]};
}

/// From the solid's own frame.
Triangle posed(const Primitive& solid, Triangle triangle) {
  const PosedSolid frame(solid.superquadric, solid.pose);
  for (Point& corner : triangle) corner = oracle::rounded(frame.from_own_frame(oracle::widened(corner)));
  return triangle;
}

/// The first corner `gap` away from a boundary point along its normal, the others farther out; in any order.
Triangle corner_towards(RandomCases& random, const Primitive& solid, double gap, double extent) {
  const oracle::BoundaryPoint foot = random.boundary_point(solid.superquadric);
  Triangle triangle{};
  triangle[0] = moved(foot.point, foot.normal, gap);
  for (std::size_t k = 1; k < 3; ++k)
    triangle[k] = moved(moved(triangle[0], foot.normal, extent), random.direction(), 0.9 * extent);
  std::rotate(triangle.begin(), triangle.begin() + static_cast<std::ptrdiff_t>(random.choice(3)), triangle.end());
  return posed(solid, triangle);
}

TriangleScene random_solid_scene(std::uint64_t seed) {
  RandomCases random(seed);
  TriangleScene scene{"random solid " + std::to_string(seed), {"", {random_solid(random)}}, {}};
  for (int i = 0; i < 60; ++i)
    scene.triangles.push_back(oracle::random_triangle(random, scene.model.primitives[0]).triangle);
  return scene;
}

/// Solids that overlap.
TriangleScene random_union(std::uint64_t seed) {
  RandomCases random(seed);
  TriangleScene scene{"random union " + std::to_string(seed), {}, {}};
  for (int i = 0; i < 3; ++i) {
    Primitive next = random_solid(random);
    for (double& coordinate : next.pose.translation) coordinate = random.uniform(-1.5, 1.5);
    scene.model.primitives.push_back(next);
  }
  for (int i = 0; i < 60; ++i)
    scene.triangles.push_back(oracle::random_triangle(random, scene.model.primitives[random.choice(3)]).triangle);
  return scene;
}

/// By as little as the pessimistic arithmetics are off: what seems to meet the solid but does not.
TriangleScene nearly_touching(std::uint64_t seed) {
  RandomCases random(seed);
  const Superquadric superquadric{{1.0, random.uniform(0.5, 1.0), random.uniform(0.5, 1.0)},
                                  {random.uniform(0.5, 1.5), random.uniform(0.5, 1.5)}};
  TriangleScene scene{"nearly touching " + std::to_string(seed), {"", {random.solid(superquadric)}}, {}};
  for (int i = 0; i < 120; ++i)
    scene.triangles.push_back(
        corner_towards(random, scene.model.primitives[0], random.log_uniform(1e-9, 1e-5), random.uniform(0.01, 1.0)));
  return scene;
}

/// There the coordinates of the triangles decide, and the solid hardly matters.
TriangleScene far_away(std::uint64_t seed) {
  RandomCases random(seed);
  const Superquadric superquadric{{1.0, 0.6, 0.8}, {1.0, 0.7}};
  TriangleScene scene{"far away " + std::to_string(seed), {"", {random.solid(superquadric)}}, {}};
  for (int i = 0; i < 120; ++i)
    scene.triangles.push_back(
        corner_towards(random, scene.model.primitives[0], random.log_uniform(10.0, 1e4), random.log_uniform(1.0, 1e4)));
  for (int i = 0; i < 120; ++i) {  // nearest somewhere in their middle
    const double size = random.log_uniform(10.0, 1e4);
    const Point centre = moved({}, random.direction(), 2.0 * size);
    Triangle triangle;
    for (Point& corner : triangle) corner = moved(centre, random.direction(), size);
    scene.triangles.push_back(triangle);
  }
  return scene;
}

/// A needle at whose tip its bounding sphere touches it, triangles straight before the tip, and a ball beside each
/// triangle's middle: the needle is passed over, and its bound by the sphere is the distance of the nearest corner. One
/// of the tips for each of the corners that may be nearest.
TriangleScene before_the_tip(std::size_t nearest_corner) {
  RandomCases random(nearest_corner);
  const Primitive needle{"needle", {{1.5, 1e-4, 1e-4}, {1.0, 1.0}}, {{}, {1.0, -2.0, 3.0, 0.5}}};
  const Superquadric unit_ball{{1.0, 1.0, 1.0}, {1.0, 1.0}};
  const double side = nearest_corner == 1 ? 1.0 : -1.0;
  const Point middle = posed(needle, {Point{side * 500.0, 1.5, 0.0}, Point{}, Point{}})[0];
  TriangleScene scene{"before the tip, corner " + std::to_string(nearest_corner),
                      {"", {{"ball", unit_ball, {middle, {1.0, 0.0, 0.0, 0.0}}}, needle}},
                      {}};
  for (int i = 0; i < 120; ++i) {
    Triangle triangle;
    triangle[0] = {side * random.uniform(900.0, 1100.0), 0.0, 0.0};
    triangle[nearest_corner] = {side * (1.5 + random.uniform(2.0, 4.0)), 0.0, 0.0};
    triangle[3 - nearest_corner] = {side * 900.0, random.uniform(-0.1, 0.1), 1.0};
    scene.triangles.push_back(posed(needle, triangle));
  }
  return scene;
}

/// Beside a long solid, the corner that is nearest to it the farthest from its centre: the corners' errors differ.
TriangleScene along_a_rod() {
  RandomCases random(6);
  const Primitive rod{"rod", {{1.9, 0.02, 0.02}, {0.1, 0.1}}, {{}, {0.3, 0.5, -0.7, 0.2}}};
  TriangleScene scene{"along a rod", {"", {rod}}, {}};
  for (int i = 0; i < 40; ++i) {
    const double gap = random.log_uniform(1e-6, 1e-3);
    scene.triangles.push_back(posed(rod, {Point{random.uniform(1.0, 1.6), 0.02 + gap, 0.0},
                                          Point{0.01, 0.02 + 2.0 * gap, 0.01}, Point{0.0, 0.02 + 2.0 * gap, 0.0}}));
  }
  return scene;
}

/// Where products overflow, or the coordinates themselves.
TriangleScene beyond_the_range(const Pose& pose) {
  TriangleScene scene{"beyond the range of binary64", {"", {{"solid", {{1.0, 1.5, 0.8}, {0.8, 1.2}}, pose}}}, {}};
  for (const double x : {1e150, 1e200, 1e300, 1.7e308}) {
    scene.triangles.push_back({Point{x, x, x}, Point{x, -x, x}, Point{x, x, -x}});
    scene.triangles.push_back({Point{x, 1.0, 1.0}, Point{1.0, x, 1.0}, Point{1.0, 1.0, x}});
    scene.triangles.push_back({Point{x, 0.0, 0.0}, Point{-x, x, 0.0}, Point{x, x, 0.0}});
    scene.triangles.push_back({Point{-x, 9.0, 1.0}, Point{x, 9.0, 1.0}, Point{1.0, 9.0, 2.0}});
  }
  return scene;
}

}  // namespace

std::vector<TriangleScene> triangle_scenes() {
  std::vector<TriangleScene> all;
  for (std::uint64_t seed = 0; seed < 8; ++seed) all.push_back(random_solid_scene(seed));
  for (std::uint64_t seed = 0; seed < 3; ++seed) all.push_back(random_union(seed));
  for (std::uint64_t seed = 0; seed < 3; ++seed) all.push_back(nearly_touching(seed));
  for (std::uint64_t seed = 0; seed < 2; ++seed) all.push_back(far_away(seed));
  for (const std::size_t corner : {1, 2}) all.push_back(before_the_tip(corner));
  all.push_back(along_a_rod());
  all.push_back(beyond_the_range({{1.0, 2.0, 3.0}, {1.0, 2.0, 3.0, 4.0}}));
  all.push_back(beyond_the_range({}));
  return all;
}

}  // namespace verisq::mutation
