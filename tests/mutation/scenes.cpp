/// The choice of models and points.
#include "tests/mutation/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/oracle/random_cases.hpp"

namespace verisq::mutation {
namespace {

double size_of(const Primitive& primitive) {
  return std::ranges::max(primitive.superquadric.semi_axes);
}

/// Where the pose's rotation takes a vector.
Point turned_by(const Pose& pose, const Point& v) {
  const auto [w, x, y, z] = pose.quaternion;
  const double n = w * w + x * x + y * y + z * z;
  const Point t{2.0 * (y * v[2] - z * v[1]) / n, 2.0 * (z * v[0] - x * v[2]) / n, 2.0 * (x * v[1] - y * v[0]) / n};
  return {v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
          v[2] + w * t[2] + x * t[1] - y * t[0]};
}

Scene random_solid(std::uint64_t seed, std::size_t points, double relative_tolerance) {
  oracle::RandomCases random(seed);
  const Primitive solid = random.solid();
  Scene scene{"random solid " + std::to_string(seed), {"", {solid}}, relative_tolerance * size_of(solid), {}};
  for (std::size_t i = 0; i < points; ++i) scene.points.push_back(random.point(solid).point);
  return scene;
}

/// Solids of like size that overlap.
Scene random_union(std::uint64_t seed, std::size_t points) {
  oracle::RandomCases random(seed);
  Scene scene{"random union " + std::to_string(seed), {}, 1e-6, {}};
  for (int i = 0; i < 3; ++i) {
    Primitive next = random.solid();
    const double scale = 1.0 / size_of(next);
    for (double& axis : next.superquadric.semi_axes) axis *= scale;
    for (double& coordinate : next.pose.translation) coordinate = random.uniform(-0.5, 0.5);
    scene.model.primitives.push_back(next);
  }
  for (std::size_t i = 0; i < points; ++i)
    scene.points.push_back(random.point(scene.model.primitives[random.choice(3)]).point);
  return scene;
}

/// The centre and points near it: their nearest boundary points lie on an axis, at a corner of the octant, which the
/// first tangent planes miss.
Scene near_the_centre(std::size_t shortest) {
  Superquadric solid{{1.3, 1.2, 1.1}, {1.0, 1.0}};
  solid.semi_axes[shortest] = 1.0;
  Scene scene{"near the centre, axis " + std::to_string(shortest), {"", {{"solid", solid, {}}}}, 1e-6, {}};
  for (const double offset : {0.0, 1e-9, 1e-3, 0.01, 0.03, 0.1}) {
    scene.points.push_back({offset, 0.7 * offset, 0.4 * offset});
    scene.points.push_back({0.2 * offset, offset, 0.9 * offset});
  }
  return scene;
}

/// Small tolerances are not reached on the pessimistic arithmetic: the branch and bound then goes to its limit, and
/// what it proves is as much as the rounding allows.
Scene deep_inside(std::uint64_t seed) {
  oracle::RandomCases random(seed);
  const Superquadric solid{{1.0, random.uniform(0.5, 1.0), random.uniform(0.5, 1.0)},
                           {random.uniform(0.5, 1.5), random.uniform(0.5, 1.5)}};
  Scene scene{"deep inside " + std::to_string(seed), {"", {{"solid", solid, {}}}}, 0.0, {}};
  for (int i = 0; i < 12; ++i)
    scene.points.push_back({random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)});
  return scene;
}

/// Blunt corners between flat faces: the nearest face is easily missed.
Scene between_faces() {
  oracle::RandomCases random(5);
  Scene scene{"between flat faces", {"", {{"solid", {{1.0, 0.98, 0.84}, {1.6, 1.9}}, {}}}}, 1e-9, {}};
  for (int i = 0; i < 120; ++i)
    scene.points.push_back({random.uniform(-0.2, 0.2), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)});
  return scene;
}

/// Of one point in ten the first descent ends at another face than the nearest, with a cap about its normal.
Scene at_another_face() {
  oracle::RandomCases random(7);
  Scene scene{"at another face", {"", {{"solid", {{0.43, 0.6, 1.9}, {1.5, 0.4}}, {}}}}, 1e-6, {}};
  for (int i = 0; i < 100; ++i)
    scene.points.push_back({random.uniform(-0.2, 0.2), random.uniform(-0.3, 0.3), random.uniform(-0.9, 0.9)});
  return scene;
}

/// Far from the origin the error of the local point is large.
Scene far_away() {
  oracle::RandomCases random(3);
  const Primitive solid{"solid", {{1.0, 0.5, 0.8}, {1.3, 0.6}}, {{3e4, -2e4, 5e4}, {0.3, 0.5, -0.7, 0.2}}};
  Scene scene{"far from the origin", {"", {solid}}, 1e-6, {}};
  for (int i = 0; i < 100; ++i) scene.points.push_back(random.point(solid).point);
  return scene;
}

/// Two octahedra that share a part of a face; points on the shared part lie inside the union.
Scene shared_face() {
  const Superquadric octahedron{{1.0, 1.0, 1.0}, {2.0, 2.0}};
  Scene scene{"shared face",
              {"", {{"one", octahedron, {}}, {"other", octahedron, {{0.75, 0.75, 0.5}, {1.0, 0.0, 0.0, 0.0}}}}},
              1e-6,
              {}};
  for (const double x : {0.25, 0.3125, 0.375})
    for (const double y : {0.3125, 0.375, 0.4375}) scene.points.push_back({x, y, 1.0 - x - y});
  return scene;
}

/// A solid in one that is hardly larger: what lies just beyond the one is still in the other.
Scene hardly_larger() {
  oracle::RandomCases random(6);
  const Superquadric inner{{1.3, 1.2, 1.1}, {1.0, 0.8}};
  Superquadric outer = inner;
  for (double& axis : outer.semi_axes) axis *= 1.0 + 0x1p-21;
  Scene scene{"in one hardly larger", {"", {{"inner", inner, {}}, {"outer", outer, {}}}}, 1e-8, {}};
  for (int i = 0; i < 40; ++i)
    scene.points.push_back({random.uniform(-0.7, 0.7), random.uniform(-0.6, 0.6), random.uniform(-0.5, 0.5)});
  return scene;
}

/// The sphere about the box touches its corner, behind which the points lie, as far from the box as from the ball: an
/// error in the sphere's bound passes over the nearer of the two.
Scene equally_far() {
  oracle::RandomCases random(4);
  const Pose turned{{}, {1.0, 2.0, 3.0, 4.0}};
  Scene scene{"a ball and a corner equally far away",
              {"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}, {"box", {{1.0, 1.0, 1.0}, {1e-4, 1e-4}}, turned}}},
              1e-6,
              {}};
  // Seen from the points, the box lies behind its corner (1, 1, 1), the ball at a right angle to that.
  const double distance = 1e4;
  const double third = std::sqrt(1.0 / 3.0);
  const Point corner = turned_by(turned, {third, third, third});
  const Point across = turned_by(turned, {std::sqrt(0.5), -std::sqrt(0.5), 0.0});
  const double corner_distance = std::sqrt(3.0);
  Point& centre = scene.model.primitives[0].pose.translation;
  for (std::size_t k = 0; k < 3; ++k)
    centre[k] = (corner_distance + distance) * corner[k] + (distance + 1.0) * across[k];
  for (int i = 0; i < 40; ++i) {
    const double nearer = random.log_uniform(1e-6, 1e-1);
    const double along = corner_distance + distance - nearer;
    for (int copy = 0; copy < 4; ++copy)  // lanes that are passed over together
      scene.points.push_back({along * corner[0], along * corner[1], along * corner[2]});
  }
  return scene;
}

/// Where products overflow, or the coordinates themselves in units of the solid.
Scene beyond_the_range(double size, const Pose& pose) {
  Scene scene{
      "beyond the range of binary64", {"", {{"solid", {{size, 2.0 * size, 1.5 * size}, {0.8, 1.2}}, pose}}}, 1e-6, {}};
  for (const double x : {1e150, 1e200, 1e300, 1.7e308})
    for (const double sign : {1.0, -1.0}) {
      scene.points.push_back({x, 0.0, 0.0});
      scene.points.push_back({x, sign * x, 0.5 * x});
      scene.points.push_back({sign, sign * x, -x});
    }
  return scene;
}

}  // namespace

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (std::uint64_t seed = 0; seed < 10; ++seed) all.push_back(random_solid(seed, 50, 1e-6));
  for (std::uint64_t seed = 0; seed < 4; ++seed) all.push_back(random_union(seed, 40));
  for (std::size_t axis = 0; axis < 3; ++axis) all.push_back(near_the_centre(axis));
  for (std::uint64_t seed = 0; seed < 3; ++seed) all.push_back(deep_inside(seed));
  all.push_back(between_faces());
  all.push_back(at_another_face());
  all.push_back(far_away());
  all.push_back(shared_face());
  all.push_back(hardly_larger());
  all.push_back(equally_far());
  all.push_back(beyond_the_range(1.0, {{1.0, 2.0, 3.0}, {1.0, 2.0, 3.0, 4.0}}));
  all.push_back(beyond_the_range(1e-3, {}));
  return all;
}

}  // namespace verisq::mutation
