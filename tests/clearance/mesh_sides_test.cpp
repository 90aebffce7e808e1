/// On which side of a surface closed meshes lie: what is proved is true, also of shells, cavities, fins and thin necks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "verisq/clearance.hpp"
#include "verisq/distance.hpp"

namespace verisq {
namespace {

using verisq::oracle::Forgeries;
using verisq::oracle::requested_count;
using verisq::testing::crossed_torus;
using verisq::testing::cube_mesh;
using verisq::testing::cube_with_fins;
using verisq::testing::join;
using verisq::testing::moved;
using verisq::testing::Random;
using verisq::testing::sphere_mesh;
using verisq::testing::star_mesh;
using verisq::testing::stretched;
using verisq::testing::tetrahedron;
using verisq::testing::torus_mesh;
using verisq::testing::turned;

SideFinding finding(const Mesh& part, const Mesh& surface, SurfaceSide side, double limit = 0.0,
                    const Pose& pose = {}) {
  return SideChecker(Model{"", {mesh_primitive("part", part, pose)}}, surface, limit)({0, side});
}

Verdict verdict(const Mesh& part, const Mesh& surface, SurfaceSide side, double limit = 0.0, const Pose& pose = {}) {
  return verdict_of(finding(part, surface, side, limit, pose));
}

/// The triangles of a sphere below a height.
Mesh bowl(int rounds, double height) {
  Mesh mesh = sphere_mesh(rounds);
  std::erase_if(mesh.triangles, [&](const auto& corners) {
    return std::ranges::any_of(corners, [&](std::uint32_t v) { return mesh.vertices[v][2] > height; });
  });
  return mesh;
}

Mesh bead(const Point& centre, double radius = 0.2) {
  return moved(sphere_mesh(1), radius, centre);
}

/// The cube from -1 to 1, whose triangles share vertices.
Mesh cube() {
  return {
      .vertices = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}},
      .triangles = {{0, 2, 1},
                    {1, 2, 3},
                    {4, 5, 6},
                    {5, 7, 6},
                    {0, 1, 4},
                    {1, 5, 4},
                    {2, 6, 3},
                    {3, 6, 7},
                    {0, 4, 2},
                    {2, 4, 6},
                    {1, 3, 5},
                    {3, 7, 5}}};
}

/// Two beads, and between them a neck about so thick: one surface.
Mesh dumbbell(double thickness) {
  Mesh mesh = torus_mesh(1.0, 0.0, 16, 12);  // rings; the numbers below place them
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    const std::size_t ring = n / 12;
    const double along = static_cast<double>(ring) / 15.0;  // from one end to the other
    const double across = 2.0 * std::acos(-1.0) * static_cast<double>(n % 12) / 12.0;
    const double in_bead = std::max(0.0, 1.0 - std::pow((std::abs(along - 0.5) - 0.3) / 0.2, 2));
    const double radius = along == 0.0 || along == 1.0 ? 0.0 : std::max(thickness, 0.2 * std::sqrt(in_bead));
    mesh.vertices[n] = {radius * std::cos(across), radius * std::sin(across), along - 0.5};
  }
  // The last ring is not joined to the first, both of which are points.
  const auto joins_ends = [](const auto& t) {
    const auto [least, most] = std::ranges::minmax(t);
    return most / 12 == 15 && least / 12 == 0;
  };
  std::erase_if(mesh.triangles, joins_ends);
  return mesh;
}

TEST(MeshSides, TellInsideFromOutside) {
  const Pose pose{{0.1, 0.2, 0.3}, {0.9, 0.1, -0.3, 0.2}};
  for (const Mesh& surface : {sphere_mesh(3), turned(sphere_mesh(3))}) {
    for (const Mesh& part : {bead({}), turned(bead({})), moved(crossed_torus(), 0.1), moved(cube_with_fins(), 0.1)}) {
      EXPECT_EQ(verdict(part, surface, SurfaceSide::inside, 0.0, pose), Verdict::proved);
      EXPECT_NE(verdict(part, surface, SurfaceSide::outside, 0.0, pose), Verdict::proved);
      EXPECT_EQ(verdict(part, surface, SurfaceSide::any, 0.0, pose), Verdict::proved);
    }
    EXPECT_EQ(verdict(bead({}), surface, SurfaceSide::outside), Verdict::refuted);
    EXPECT_EQ(verdict(bead({0.1, 0.2, 1.5}), surface, SurfaceSide::inside), Verdict::refuted);
    EXPECT_EQ(verdict(bead({0.1, 0.2, 1.5}), surface, SurfaceSide::outside), Verdict::proved);
  }
}

TEST(MeshSides, LeaveWhatTheLimitAllows) {
  const Mesh through = moved(sphere_mesh(3), 0.2, {0.0, 0.0, 0.85});
  const Mesh surface = sphere_mesh(4);
  EXPECT_EQ(finding(through, surface, SurfaceSide::inside), SideFinding::enters_surface);
  EXPECT_EQ(verdict(through, surface, SurfaceSide::inside, 0.045), Verdict::unproved);
  EXPECT_EQ(verdict(through, surface, SurfaceSide::inside, 0.055), Verdict::proved);
  EXPECT_EQ(verdict(through, surface, SurfaceSide::outside, 0.055), Verdict::refuted);
  EXPECT_EQ(verdict(through, surface, SurfaceSide::inside, 0.25), Verdict::unproved) << "no point is as deep";
  EXPECT_EQ(verdict(turned(through), surface, SurfaceSide::inside, 0.055), Verdict::proved);
}

TEST(MeshSides, KeepOffTheOpenings) {
  const Mesh open = bowl(3, 0.3);
  EXPECT_EQ(verdict(bead({0.0, 0.0, -0.2}), open, SurfaceSide::inside), Verdict::proved);
  EXPECT_EQ(finding(stretched(bead({}), {1.0, 1.0, 2.0}), open, SurfaceSide::inside), SideFinding::reaches_through);
  EXPECT_EQ(verdict(bead({0.0, 0.0, 0.7}), open, SurfaceSide::inside), Verdict::refuted);
  EXPECT_EQ(verdict(bead({0.0, 0.0, 0.7}), open, SurfaceSide::outside), Verdict::proved);
}

/// One of the implant's shells tells nothing of another.
TEST(MeshSides, AreOfEveryShell) {
  const Mesh surface = sphere_mesh(3);
  const Mesh both_inside = join(bead({0.4, 0.0, 0.0}), bead({-0.4, 0.0, 0.0}));
  const Mesh one_outside = join(bead({0.4, 0.0, 0.0}), bead({-1.4, 0.0, 0.0}));
  EXPECT_EQ(verdict(both_inside, surface, SurfaceSide::inside), Verdict::proved);
  for (const double limit : {0.0, 0.01, 0.1}) {
    for (const SurfaceSide side : {SurfaceSide::inside, SurfaceSide::outside})
      EXPECT_NE(verdict(one_outside, surface, side, limit), Verdict::proved);
  }
  const Mesh bead_in_bead = join(bead({1.6, 0.0, 0.0}, 0.5), turned(bead({1.6, 0.0, 0.0}, 0.3)));
  EXPECT_EQ(verdict(bead_in_bead, surface, SurfaceSide::outside), Verdict::proved);
}

/// A surface in an implant's cavity is outside of the implant, one that is swallowed by it is not.
TEST(MeshSides, AreNotOfASurfaceWithin) {
  const Mesh surface = sphere_mesh(2);
  const Mesh shell = join(moved(sphere_mesh(2), 2.0), turned(moved(sphere_mesh(2), 1.5)));
  EXPECT_EQ(verdict(shell, surface, SurfaceSide::outside), Verdict::proved);
  EXPECT_NE(verdict(shell, surface, SurfaceSide::inside), Verdict::proved);
  const Mesh alike = join(moved(sphere_mesh(2), 2.0), moved(sphere_mesh(2), 1.5));  // winds twice within: no cavity
  for (const Mesh& around : {alike, moved(sphere_mesh(2), 2.0)}) {
    for (const double limit : {0.0, 0.1}) {
      for (const SurfaceSide side : {SurfaceSide::inside, SurfaceSide::outside})
        EXPECT_NE(verdict(around, surface, side, limit), Verdict::proved);
    }
  }
}

/// No point of the surface is inside of these implants, and their triangles hang together. Still they lie on both
/// sides.
TEST(MeshSides, AreNotProvedWhereTheSurfaceTouches) {
  const Mesh surface = moved(cube(), 1.0, {1.0, 0.0, 0.0});  // x = 0 is a face
  Mesh twins = join(moved(tetrahedron(), 0.2), moved(turned(tetrahedron()), -0.2));
  for (auto& triangle : twins.triangles) {
    for (std::uint32_t& corner : triangle) corner = corner == 4 ? 0 : corner;  // the origin, as one vertex
  }
  Mesh with_fin = moved(cube_mesh(2), 0.2, {0.3, 0.0, 0.0});
  with_fin.vertices.insert(with_fin.vertices.end(), {{-0.2, 0.03, 0.07}, {-0.1, 0.2, 0.1}});
  const auto tip = static_cast<std::uint32_t>(with_fin.vertices.size() - 2);
  with_fin.triangles.push_back({0, tip, tip + 1});
  with_fin.triangles.push_back({tip, 0, tip + 1});
  for (const Mesh& part : {twins, with_fin}) {
    EXPECT_EQ(verdict(part, surface, SurfaceSide::inside), Verdict::unproved);
    EXPECT_NE(verdict(part, surface, SurfaceSide::outside), Verdict::proved);
  }
}

/// In a dumbbell with a thin neck, the points deeper than the limit have two parts.
TEST(MeshSides, AreOfEveryDeepPart) {
  const Mesh part = dumbbell(0.03);
  const Mesh surface = moved(cube(), 2.0, {0.0, 0.0, 2.0});  // z = 0 is a face, across the neck
  for (const double limit : {0.0, 0.02, 0.05, 0.1}) {
    for (const SurfaceSide side : {SurfaceSide::inside, SurfaceSide::outside})
      EXPECT_NE(verdict(part, surface, side, limit), Verdict::proved) << limit;
  }
  // The lower bead is cut: deep, then no deeper than the limit.
  const Mesh peg = moved(part, 1.0, {0.0, 0.0, 0.33});
  EXPECT_NE(verdict(peg, surface, SurfaceSide::inside, 0.1), Verdict::proved);
  const Mesh higher = moved(part, 1.0, {0.0, 0.0, 0.46});
  EXPECT_NE(verdict(higher, surface, SurfaceSide::inside), Verdict::proved);
  EXPECT_EQ(verdict(higher, surface, SurfaceSide::inside, 0.1), Verdict::proved);
  EXPECT_NE(verdict(higher, surface, SurfaceSide::outside, 0.1), Verdict::proved);
}

TEST(MeshSides, AreOfOneSurface) {
  const Mesh two = join(sphere_mesh(2), moved(sphere_mesh(2), 1.0, {3.0, 0.0, 0.0}));
  EXPECT_EQ(finding(bead({}), two, SurfaceSide::inside), SideFinding::several_parts);
  EXPECT_EQ(finding(bead({1.5, 0.0, 0.0}), two, SurfaceSide::outside), SideFinding::several_parts);
}

TEST(MeshSides, SayNothingOnceInterrupted) {
  const SideChecker checker(Model{"", {mesh_primitive("part", bead({}))}}, sphere_mesh(3), 0.1);
  EXPECT_EQ(checker({0, SurfaceSide::inside}, {.interrupted = [] { return true; }}), SideFinding::enters_surface);
}

/// A part that begins inside the surface or beside it, and a vertex that it is moved towards.
struct Scene {
  Mesh part;
  Pose pose;
  Mesh surface;
  SurfaceSide side;
  double limit;
  Point target;
};

Scene random_scene(Random& random) {
  const bool inside = random.uniform(0.0, 1.0) < 0.5;
  const std::vector<Mesh> parts{star_mesh(1, static_cast<unsigned>(random.uniform(0.0, 1000.0))), sphere_mesh(1),
                                moved(crossed_torus(), 0.4), moved(cube_mesh(2), 1.0, {-0.5, -0.5, -0.5})};
  Scene scene{moved(parts[static_cast<std::size_t>(random.uniform(0.0, 4.0))], random.uniform(0.1, 0.25)),
              {},
              random.uniform(0.0, 1.0) < 0.4 ? bowl(2, 0.45) : sphere_mesh(2),
              inside ? SurfaceSide::inside : SurfaceSide::outside,
              random.uniform(0.0, 1.0) < 0.5 ? 0.0 : random.uniform(0.0, 0.04),
              {}};
  for (double& q : scene.pose.quaternion) q = random.uniform(-1.0, 1.0);
  scene.pose.translation = {random.uniform(-0.2, 0.2), inside ? random.uniform(-0.2, 0.2) : random.uniform(1.7, 2.2),
                            -0.2};
  const auto n = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(scene.surface.triangles.size())));
  scene.target = scene.surface.vertices[scene.surface.triangles[n][0]];
  return scene;
}

Pose on_the_way(const Scene& scene, double share) {
  Pose pose = scene.pose;
  for (std::size_t i = 0; i < 3; ++i) pose.translation[i] += share * (scene.target[i] - pose.translation[i]);
  return pose;
}

/// How far on its way the target is proven to be a little deeper in the part than the limit; nothing where it is not.
std::optional<double> share_that_is_too_deep(const Scene& scene) {
  const auto too_deep = [&](double share) {
    const Model model{"", {mesh_primitive("", scene.part, on_the_way(scene, share))}};
    return SignedDistance(model)(scene.target, 1e-12).hi < -scene.limit;
  };
  double low = 0.0;
  double high = 1.0;
  if (too_deep(low) || !too_deep(high)) return std::nullopt;
  for (int i = 0; i < 34; ++i) {
    const double middle = 0.5 * (low + high);
    (too_deep(middle) ? high : low) = middle;
  }
  return high;
}

/// A vertex that lies deeper than the limit, by some 10^-10 in the least case, has deep points on both of its sides.
TEST(MeshSides, AreNeverProvedOfAForgery) {
  Random random(37);
  Forgeries forgeries;
  std::size_t proved = 0;
  std::size_t scenes = 0;
  for (std::size_t i = 0; i < requested_count("VERISQ_FORGED_MESH_SIDES", 40); ++i) {
    const Scene scene = random_scene(random);
    const std::optional<double> share = share_that_is_too_deep(scene);
    if (!share) continue;
    ++scenes;
    const auto check = [&](const Mesh& part, double of_way, SurfaceSide side, double limit) {
      return verdict(part, scene.surface, side, limit, on_the_way(scene, of_way * *share));
    };
    const auto forge = [&](const Mesh& part, double of_way, SurfaceSide side, double limit, const char* what) {
      forgeries.expect_not_proved({check(part, of_way, side, limit), {}}, {}, what);
    };
    const SurfaceSide other = scene.side == SurfaceSide::inside ? SurfaceSide::outside : SurfaceSide::inside;
    for (const double of_way : {0.0, 0.5, 0.8}) {
      if (check(scene.part, of_way, scene.side, scene.limit) != Verdict::proved) continue;
      ++proved;
      forge(scene.part, of_way, other, scene.limit, "the other side");
      const Mesh with_another = join(scene.part, moved(sphere_mesh(1), 0.1, {0.0, 0.0, 9.0}));  // far outside
      if (scene.side == SurfaceSide::inside)
        forge(with_another, of_way, scene.side, scene.limit, "a shell on the other side");
    }
    for (const double of_way : {1.0, 1.0 + 1e-6, 1.01, 1.1}) {
      if (of_way * *share > 1.0) continue;
      forge(scene.part, of_way, scene.side, scene.limit, "a vertex too deep");
      forge(turned(scene.part), of_way, scene.side, scene.limit, "a vertex too deep, inside out");
      forge(scene.part, of_way, other, scene.limit, "a vertex too deep, the other side");
      forge(scene.part, of_way, scene.side, scene.limit * (1.0 - 1e-6), "a smaller limit");
    }
  }
  EXPECT_GT(forgeries.told(), 10 * scenes);
  EXPECT_GT(scenes, 10U);
  EXPECT_GT(proved, scenes) << "of " << 3 * scenes;
}

}  // namespace
}  // namespace verisq
