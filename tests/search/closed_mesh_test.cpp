/// Closed meshes as solids: distances and sides of points against exact integers, and what is refused.
/// VERISQ_MESH_POINTS sets the number of points about each mesh. The full run is
///   VERISQ_MESH_POINTS=100000 build/release/tests/search_test --gtest_filter='*ClosedMesh*'
#include "verify/search/closed_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/exact_mesh.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {
namespace {

using testing::cube_mesh;
using testing::folded_and_crossing_in_corner;
using testing::join;
using testing::MeshScene;
using testing::moved;
using testing::PlacesAboutMesh;
using testing::Random;
using testing::sphere_mesh;
using testing::star_mesh;
using testing::tetrahedron;
using testing::tetrahedron_with_degenerate;
using testing::turned;
using Side = ClosedMesh::Side;
using Means = ClosedMesh::Means;

Enclosure unsigned_distance(const ClosedMesh::Distance& found) {
  const Enclosure& d = found.signed_distance;
  return found.side == Side::inside ? Enclosure{-d.hi, -d.lo} : d;
}

class AboutMesh : public ::testing::TestWithParam<MeshScene> {};

TEST_P(AboutMesh, DistancesAndSidesAreExact) {
  const Mesh& mesh = GetParam().mesh;
  // The oracle counts in multiples of 2^-300: of the huge and the tiny it sees the same mesh in other units.
  const double unit = GetParam().name == "tiny" ? 0x1p-130 : (GetParam().name == "huge" ? 0x1p196 : 1.0);
  const oracle::ExactMesh exact(triangles_of(moved(mesh, 1.0 / unit, {})));
  const ClosedMesh solid(mesh);
  PlacesAboutMesh places(mesh, 1);
  Random random(2);
  std::array<std::size_t, 4> by_means{};
  std::size_t wrong = 0;
  std::vector<double> widths;
  const std::size_t count = oracle::requested_count("VERISQ_MESH_POINTS", 5000);
  for (std::size_t n = 0; n < count && wrong < 5; ++n) {
    const Point point = places.next();
    const Point seen{point[0] / unit, point[1] / unit, point[2] / unit};
    const auto hint = static_cast<std::uint32_t>(random.uniform(0, static_cast<double>(mesh.triangles.size())));
    const ClosedMesh::Distance found = solid.signed_distance(point, n % 2 == 0 ? std::optional(hint) : std::nullopt);
    ++by_means[static_cast<std::size_t>(found.means)];
    const Enclosure distance = unsigned_distance(found);
    widths.push_back(distance.width());
    const oracle::Fraction squared = exact.squared_distance(seen);
    const bool on_surface = squared.numerator == 0;
    const Side side = on_surface ? Side::on_surface : (exact.winding_number(seen) != 0 ? Side::inside : Side::outside);
    const bool right = found.side == side && holds_root({distance.lo / unit, distance.hi / unit}, squared);
    if (right) continue;
    ++wrong;
    ADD_FAILURE() << n << ": (" << ::testing::PrintToString(point) << ") side " << static_cast<int>(found.side)
                  << " for " << static_cast<int>(side) << " by " << static_cast<int>(found.means) << ", " << distance.lo
                  << " to " << distance.hi;
  }
  std::ranges::sort(widths);
  RecordProperty("means", ::testing::PrintToString(by_means));
  RecordProperty("median_width", std::to_string(widths[widths.size() / 2]));
}

INSTANTIATE_TEST_SUITE_P(ClosedMesh, AboutMesh, ::testing::ValuesIn(testing::mesh_scenes()),
                         [](const auto& scene) { return scene.param.name; });

TEST(ClosedMesh, TellsWhatMeetsWhat) {
  const ClosedMesh::Facts sphere = ClosedMesh(sphere_mesh(3)).facts();
  EXPECT_EQ(sphere.outward, sphere.triangles);
  EXPECT_EQ(sphere.patches, 1U);
  EXPECT_TRUE(sphere.depth_is_exact());
  const ClosedMesh::Facts cube = ClosedMesh(cube_mesh(4)).facts();
  EXPECT_EQ(cube.outward, cube.triangles);
  const ClosedMesh::Facts inward = ClosedMesh(turned(star_mesh(2, 1))).facts();
  EXPECT_EQ(inward.inward, inward.triangles);
  EXPECT_TRUE(inward.depth_is_exact());
  const ClosedMesh::Facts nested = ClosedMesh(join(sphere_mesh(2), moved(sphere_mesh(1), 0.5, {}))).facts();
  EXPECT_EQ(nested.unclean, 0U);
  EXPECT_EQ(nested.within, 32U);
  EXPECT_FALSE(nested.depth_is_exact());
  const ClosedMesh::Facts twice = ClosedMesh(join(sphere_mesh(1), sphere_mesh(1))).facts();
  EXPECT_EQ(twice.unclean, twice.triangles);
  const ClosedMesh::Facts crossing = ClosedMesh(join(sphere_mesh(3), moved(sphere_mesh(3), 1.0, {0.5, 0, 0}))).facts();
  EXPECT_GT(crossing.unclean, 50U);
  EXPECT_LT(crossing.unclean, crossing.triangles / 2);
  EXPECT_GT(crossing.within, 100U);
  const ClosedMesh::Facts folded = ClosedMesh(folded_and_crossing_in_corner()).facts();
  EXPECT_EQ(folded.unclean, 13U);  // eight in planes, the three that come through two others
  const ClosedMesh::Facts needle = ClosedMesh(tetrahedron_with_degenerate()).facts();
  EXPECT_EQ(needle.degenerate, 1U);
}

/// Corners on a line, to rounding, far from the origin: whatever shares are proposed, the ends are right.
TEST(ClosedMesh, NeedlesAreBounded) {
  Random random(8);
  for (int n = 0; n < 3000; ++n) {
    const double far = std::ldexp(1.0, n % 40);
    Point a, b, c, q;
    const double share = random.uniform(-1.0, 2.0);
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = far + random.uniform(0, 1);
      b[i] = far + random.uniform(0, 1);
      c[i] = n % 7 == 0 ? b[i] : a[i] + share * (b[i] - a[i]);
      q[i] = n % 3 == 0 ? a[i] + 0.3 * (b[i] - a[i]) : far + random.uniform(-2, 2);
    }
    const Triangle triangle{a, b, c};
    const DistanceBounds bounds = distance_bounds(q, triangle);
    const oracle::Fraction exact = oracle::ExactMesh(std::array<Triangle, 1>{triangle}).squared_distance(q);
    EXPECT_TRUE(oracle::holds_root({bounds.lower, bounds.upper}, exact)) << n;
  }
}

TEST(ClosedMesh, AllThatMayBeNearestAreListedOrItIsSaid) {
  const Mesh mesh = sphere_mesh(3);
  const std::vector<Triangle> triangles = triangles_of(mesh);
  const WideTree tree(triangles);
  Mesh octahedra = sphere_mesh(0);
  for (int n = 0; n < 4; ++n) octahedra = join(octahedra, sphere_mesh(0));
  EXPECT_FALSE(WideTree(triangles_of(octahedra)).nearest({0, 0, 0}).complete);
  PlacesAboutMesh places(mesh, 6);
  for (int n = 0; n < 300; ++n) {
    const Point point = places.next();
    const WideTree::Nearest found = tree.nearest(point, static_cast<std::uint32_t>(n));
    std::vector<std::uint32_t> within;
    tree.within(point, found.distance.hi, within);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const DistanceBounds bounds = distance_bounds(point, triangles[t]);
      if (bounds.upper > found.distance.hi * (1.0 + 1e-13)) continue;
      EXPECT_THAT(within, ::testing::Contains(t));
      if (!found.complete) continue;
      EXPECT_TRUE(std::any_of(found.near.begin(), found.near.begin() + static_cast<std::ptrdiff_t>(found.count),
                              [t](const WideTree::Near& near) { return near.triangle == t; }));
    }
  }
}

/// Rows of parts are those of the whole: what came before changes no bit.
TEST(ClosedMesh, TheTriangleToBeginWithChangesNothing) {
  for (const Mesh& mesh : {star_mesh(3, 1), cube_mesh(4), tetrahedron_with_degenerate(), sphere_mesh(3)}) {
    const WideTree tree(triangles_of(mesh));
    PlacesAboutMesh places(mesh, 9);
    Random random(9);
    for (int n = 0; n < 300; ++n) {
      const Point point = n == 0 ? Point{} : places.next();
      const WideTree::Nearest alone = tree.nearest(point);
      for (int k = 0; k < 4; ++k) {
        const auto hint = static_cast<std::uint32_t>(random.uniform(0, 0.999) * static_cast<double>(tree.size()));
        const WideTree::Nearest found = tree.nearest(point, hint);
        EXPECT_EQ(found.distance.lo, alone.distance.lo);
        EXPECT_EQ(found.distance.hi, alone.distance.hi);
        EXPECT_EQ(found.triangle, alone.triangle);
        EXPECT_EQ(found.way, alone.way);
        EXPECT_EQ(found.count, alone.count);
        EXPECT_EQ(found.complete, alone.complete);
      }
    }
  }
}

/// Bounds by lanes, and by boxes and planes of all triangles, beside exact distances and sides; also from far away.
TEST(ClosedMesh, NearTrianglesAreBoundedAndTheirSidesAreRight) {
  const Mesh mesh = star_mesh(2, 3);
  const std::vector<Triangle> triangles = triangles_of(mesh);
  const WideTree tree(triangles);
  const oracle::ExactMesh exact(triangles);
  PlacesAboutMesh places(mesh, 10);
  for (int n = 0; n < 400; ++n) {
    Point point = places.next();
    const double factor = n % 4 == 0 ? std::ldexp(1.0, n % 30) : 1.0;
    for (double& x : point) x *= factor;
    const WideTree::Nearest found = tree.nearest(point);
    EXPECT_TRUE(oracle::holds_root(found.distance, exact.squared_distance(point))) << n;
    for (std::size_t i = 0; i < found.count; ++i) {
      const WideTree::Near& near = found.near[i];
      const Triangle& triangle = triangles[near.triangle];
      EXPECT_TRUE(near.side == 0 || near.side == orientation(triangle, point)) << n;
      const oracle::Fraction own = oracle::ExactMesh(std::array<Triangle, 1>{triangle}).squared_distance(point);
      EXPECT_TRUE(oracle::holds_root({near.lower, 2.0 * found.distance.hi + 1.0}, own)) << n;
    }
  }
}

TEST(ClosedMesh, PlanesDecideNearSmoothSurfacesAndRaysTheRest) {
  const ClosedMesh smooth(sphere_mesh(3));
  PlacesAboutMesh places(sphere_mesh(3), 4);
  std::size_t rays = 0;
  for (int n = 0; n < 1000; ++n) rays += smooth.signed_distance(places.next()).means == Means::ray ? 1 : 0;
  EXPECT_LT(rays, 300U);  // of ten points three lie beside a corner or a side, to rounding
}

TEST(ClosedMesh, WidthIsThatOfRounding) {
  const ClosedMesh solid(star_mesh(3, 1));
  Random random(3);
  std::vector<double> widths;
  for (int n = 0; n < 2000; ++n) widths.push_back(solid.signed_distance(random.point(2.0)).signed_distance.width());
  std::ranges::sort(widths);
  EXPECT_LT(widths[1000], 1e-14);
  EXPECT_LT(widths.back(), 1e-12);
}

TEST(ClosedMesh, ManyPointsAreThoseOneByOne) {
  const ClosedMesh solid(star_mesh(3, 1));
  Random random(3);
  std::vector<Point> points;
  for (int n = 0; n < 500; ++n) points.push_back(random.point(2.0));
  std::vector<ClosedMesh::Distance> distances(points.size());
  solid.signed_distances(points, distances);
  for (std::size_t n = 0; n < points.size(); ++n) {
    const ClosedMesh::Distance one = solid.signed_distance(points[n]);
    EXPECT_EQ(distances[n].side, one.side);
    EXPECT_LE(std::max(distances[n].signed_distance.lo, one.signed_distance.lo),
              std::min(distances[n].signed_distance.hi, one.signed_distance.hi));
  }
  solid.signed_distances({}, {});
}

TEST(ClosedMesh, ClosestPointAndNormalBelongToTheDistance) {
  const ClosedMesh solid(cube_mesh(1));
  const ClosedMesh::Distance outside = solid.signed_distance({0.25, 0.25, 3.0});
  EXPECT_THAT(outside.closest, ::testing::ElementsAre(0.25, 0.25, 1.0));
  EXPECT_NEAR(outside.normal[2], 1.0, 1e-12);
  const ClosedMesh::Distance inside = solid.signed_distance({0.3, 0.4, 0.9});
  EXPECT_NEAR(inside.signed_distance.hi, -0.1, 1e-14);
  EXPECT_NEAR(inside.normal[2], 1.0, 1e-12);
  EXPECT_TRUE(inside.alone);
}

TEST(ClosedMesh, PointsFarAwayAreOutside) {
  const Mesh mesh = star_mesh(2, 1);
  const ClosedMesh solid(mesh);
  for (double reach = 1.0; reach < 1e307; reach *= 3e3) {
    const Point point{2.0 * reach, -reach, 1.5 * reach};
    const ClosedMesh::Distance found = solid.signed_distance(point);
    EXPECT_EQ(found.side, Side::outside);
    double nearest = infinity;
    for (const Point& v : mesh.vertices) {
      nearest = std::min(nearest, std::hypot(point[0] - v[0], point[1] - v[1], point[2] - v[2]));
    }
    EXPECT_LE(found.signed_distance.lo, nearest * (1 + 1e-15)) << reach;
    EXPECT_GE(found.signed_distance.hi, nearest * (1 - 1e-9)) << reach;
    EXPECT_LE(found.signed_distance.width(), nearest * (reach < 1e13 ? 1e-14 : 1e-12)) << reach;
  }
  const double most = std::numeric_limits<double>::max();
  EXPECT_EQ(solid.signed_distance({most, most, -most}).signed_distance.hi, infinity);
}

TEST(ClosedMesh, RefusesWhatIsNoSolid) {
  const auto refusal = [](const Mesh& mesh) {
    try {
      ClosedMesh{mesh};
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(refusal({}), "the mesh has no triangles");
  Mesh open = tetrahedron();
  open.triangles.pop_back();
  EXPECT_THAT(refusal(open), ::testing::HasSubstr("not closed: 3 of its edges"));
  Mesh twisted = tetrahedron();
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  EXPECT_THAT(refusal(twisted), ::testing::HasSubstr("not closed: 6 of its edges"));
  EXPECT_THAT(refusal(moved(tetrahedron(), 1e150, {})), ::testing::HasSubstr("largest coordinate is 1e+150"));
  EXPECT_THAT(refusal(moved(tetrahedron(), 1e-150, {})), ::testing::HasSubstr("largest coordinate is 1e-150"));
  EXPECT_THAT(refusal(moved(tetrahedron(), 0.0, {})), ::testing::HasSubstr("largest coordinate is 0"));
}

}  // namespace
}  // namespace verisq::verify
