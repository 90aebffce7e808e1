/// The checker proves signed distances to closed meshes without a certificate, exactly to rounding, and nothing that is
/// false. VERISQ_MESH_POINTS sets the number of points about each mesh.
#include "verify/proof/mesh_solid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/fixtures/mesh_scenes.hpp"
#include "tests/fixtures/random.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/sample_meshes.hpp"
#include "tests/oracle/exact_mesh.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/checker.hpp"
#include "verisq/deviation.hpp"
#include "verisq/error.hpp"
#include "verisq/insertion.hpp"

namespace verisq::verify {
namespace {

using testing::join;
using testing::moved;
using testing::Random;
using testing::sphere_mesh;
using testing::star_mesh;
using testing::stretched;
using testing::tetrahedron;
using testing::torus_mesh;
using testing::turned;

/// Eight vertices: the bits of their index tell which end of each coordinate.
Mesh box(const Point& lower, const Point& upper) {
  Mesh mesh{.vertices = {},
            .triangles = {{0, 4, 6},
                          {0, 6, 2},
                          {1, 3, 7},
                          {1, 7, 5},
                          {0, 1, 5},
                          {0, 5, 4},
                          {2, 6, 7},
                          {2, 7, 3},
                          {0, 2, 3},
                          {0, 3, 1},
                          {4, 5, 7},
                          {4, 7, 6}}};
  for (unsigned k = 0; k < 8; ++k) {
    mesh.vertices.push_back({(k & 1U) != 0 ? upper[0] : lower[0], (k & 2U) != 0 ? upper[1] : lower[1],
                             (k & 4U) != 0 ? upper[2] : lower[2]});
  }
  return mesh;
}

/// A side of one has a vertex of the next on it; the triangle between has no area.
Mesh with_degenerate() {
  Mesh mesh = tetrahedron();
  mesh.vertices.push_back({0.5, 0, 0});
  mesh.triangles = {{0, 2, 4}, {4, 2, 1}, {0, 1, 3}, {0, 4, 1}, {0, 3, 2}, {1, 2, 3}, {1, 1, 2}};
  return mesh;
}

/// All in the plane z = 1: it encloses nothing, and no ray along z may miss that.
Mesh folded() {
  Mesh mesh = tetrahedron();
  mesh.vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0.25, 0.5, 1}};
  return mesh;
}

/// Opposed triangles beside a box, and in the plane of one of its faces.
Mesh with_fins() {
  Mesh mesh = box({0, 0, 0}, {1, 1, 1});
  mesh.vertices.insert(mesh.vertices.end(),
                       {{1, 0.5, 0.5}, {2, 0.5, 0.5}, {1.5, 1, 0.5}, {0, 0.25, 0.25}, {0, 0.75, 0.25}, {0, 0.25, 2}});
  for (const std::uint32_t k : {8U, 11U}) {
    mesh.triangles.push_back({k, k + 1, k + 2});
    mesh.triangles.push_back({k + 1, k, k + 2});
  }
  return mesh;
}

struct Scene {
  std::string name;
  Mesh mesh;
};

std::vector<Scene> scenes() {
  const Mesh sphere = sphere_mesh(1);
  return {
      {"cube", box({0, 0, 0}, {1, 1, 1})},
      {"star", star_mesh(2, 7)},
      {"inward_torus", turned(torus_mesh(2.0, 0.7, 12, 8))},
      {"nested_alike", join(sphere, moved(sphere, 0.5))},
      {"nested_thrice", join(join(moved(sphere, 2.0), turned(sphere)), moved(sphere, 0.5))},
      {"opposed_duplicates", join(join(sphere, turned(sphere)), moved(tetrahedron(), 0.5, {2, 0, 0}))},
      {"twice", join(star_mesh(1, 9), star_mesh(1, 9))},
      {"crossing_boxes", join(box({0, 0, 0}, {2, 2, 2}), box({1, 1, 1}, {3, 3, 3}))},
      {"touching_boxes", join(box({0, 0, 0}, {1, 1, 1}), box({1, 0, 0}, {2, 1, 1}))},
      {"needles", stretched(torus_mesh(2.0, 0.7, 20, 3), {1.0, 1e-6, 1e-3})},
      {"far_away", moved(star_mesh(1, 2), 1e-3, {1e9, -1e9, 1e9})},
      {"degenerate", with_degenerate()},
      {"folded", join(folded(), tetrahedron())},
      {"fins", with_fins()},
  };
}

Model model_of(const Mesh& mesh, const Pose& pose = {}) {
  return {"", {mesh_primitive("", mesh, pose)}};
}

/// The exact answer of one mesh.
struct Truth {
  oracle::Fraction squared;
  int side;  ///< 1 outside, 0 on a triangle, -1 inside

  [[nodiscard]] bool is_in(const Enclosure& claimed) const {
    if (!(claimed.lo <= claimed.hi)) return false;
    if (side == 0) return claimed.lo <= 0.0 && claimed.hi >= 0.0;
    const Enclosure distance = side > 0 ? claimed : Enclosure{-claimed.hi, -claimed.lo};
    if (distance.hi < 0.0) return false;
    return holds_root({std::clamp(distance.lo, 0.0, 0x1p99), std::min(distance.hi, 0x1p99)}, squared);
  }
};

Truth truth_at(const oracle::ExactMesh& mesh, const Point& point) {
  const oracle::Fraction squared = mesh.squared_distance(point);
  if (squared.numerator == 0) return {squared, 0};
  return {squared, mesh.winding_number(point) != 0 ? -1 : 1};
}

/// Points for which rays meet vertices, sides and planes, and others.
class Places {
 public:
  Places(const Mesh& mesh, unsigned seed) : triangles_(triangles_of(mesh)), random_(seed) {}

  Point next() {
    const Triangle& t = triangle();
    switch (count_++ % 9) {
      case 0: return aligned();
      case 1: return t[0];
      case 2: return middle(t[0], t[1]);
      case 3: return middle(middle(t[0], t[1]), t[2]);
      case 4: return step(t[1]);
      case 5: return step(middle(t[1], t[2]));
      case 6: return step(middle(middle(t[0], t[1]), t[2]));
      case 7: return middle(aligned(), aligned());
      default: return anywhere(t);
    }
  }

 private:
  const Triangle& triangle() {
    return triangles_[static_cast<std::size_t>(random_.uniform(0, static_cast<double>(triangles_.size())))];
  }
  /// Each coordinate is one of a vertex.
  Point aligned() { return {triangle()[0][0], triangle()[1][1], triangle()[2][2]}; }
  static Point middle(const Point& a, const Point& b) {
    return {a[0] / 2 + b[0] / 2, a[1] / 2 + b[1] / 2, a[2] / 2 + b[2] / 2};
  }
  /// To the next numbers, or not.
  Point step(Point x) {
    for (double& c : x) {
      const double way = std::floor(random_.uniform(-1, 2));
      if (way != 0 && std::abs(c) > 1e-12) c = std::nextafter(c, way * infinity);
    }
    return x;
  }
  Point anywhere(const Triangle& t) {
    const double reach = std::pow(10.0, random_.uniform(-6, 1));
    const Point by = random_.point(reach);
    return {t[0][0] + by[0], t[0][1] + by[1], t[0][2] + by[2]};
  }

  std::vector<Triangle> triangles_;
  Random random_;
  std::size_t count_ = 0;
};

std::size_t points_of_each() {
  return oracle::requested_count("VERISQ_MESH_POINTS", 900);
}

class AboutMesh : public ::testing::TestWithParam<Scene> {};

TEST_P(AboutMesh, DistanceIsExactToRounding) {
  const Mesh& mesh = GetParam().mesh;
  const MeshSolid solid(mesh_primitive("", mesh));
  const oracle::ExactMesh exact(triangles_of(mesh));
  Places places(mesh, 1);
  std::array<std::size_t, 3> sides{};
  for (std::size_t n = 0; n < points_of_each() && !HasFailure(); ++n) {
    const Point point = places.next();
    const Truth truth = truth_at(exact, point);
    const int place = truth.side + 1;
    ++sides[static_cast<std::size_t>(place)];
    const Enclosure found = solid.signed_distance(point);
    EXPECT_TRUE(truth.is_in(found)) << ::testing::PrintToString(point) << found.lo << " " << found.hi;
    const double size = std::max(std::abs(found.lo), std::abs(found.hi));
    EXPECT_LE(found.width(), 0x1p-51 * size) << ::testing::PrintToString(point) << found.lo << " " << found.hi;
    EXPECT_EQ(truth.side == 0, found == (Enclosure{0.0, 0.0})) << ::testing::PrintToString(point);
  }
  RecordProperty("inside_on_outside", ::testing::PrintToString(sides));
}

/// Moved by some of its own uncertainty, an enclosure is no longer one: no shift is too small.
TEST_P(AboutMesh, NothingFalseIsProved) {
  const Mesh& mesh = GetParam().mesh;
  const Checker check(model_of(mesh));
  const oracle::ExactMesh exact(triangles_of(mesh));
  const MeshSolid solid(mesh_primitive("", mesh));
  Places places(mesh, 2);
  Random random(3);
  std::size_t false_claims = 0;
  std::size_t proved = 0;
  for (std::size_t n = 0; n < points_of_each() / 9 && !HasFailure(); ++n) {
    const Point point = places.next();
    const Truth truth = truth_at(exact, point);
    const Enclosure honest = solid.signed_distance(point);
    const Certificate nonsense{{{0, random.point(1.0)}, {7, random.point(1.0)}}, random.point(3.0)};
    EXPECT_EQ(check(point, honest, nonsense).verdict, Verdict::proved);
    const double size = std::max(std::abs(honest.lo), 1e-9) * std::pow(10.0, random.uniform(-16, 0));
    // The oracle has no subnormal numbers.
    const auto up = [](double x) { return x == 0.0 ? 0x1p-300 : std::nextafter(x, infinity); };
    const auto down = [&](double x) { return -up(-x); };
    const std::vector<Enclosure> claims{{up(honest.lo), honest.hi},
                                        {honest.lo, down(honest.hi)},
                                        {up(honest.lo), up(up(honest.hi))},
                                        {honest.lo, honest.lo},
                                        {honest.hi, honest.hi},
                                        {down(honest.lo), down(honest.hi)},
                                        {-honest.hi, -honest.lo},
                                        {honest.lo + size, honest.hi},
                                        {honest.lo, honest.hi - size},
                                        {honest.lo + size, honest.hi + size},
                                        {honest.lo - size, honest.hi - size},
                                        {0.0, 0.0},
                                        {0.0, infinity},
                                        {-infinity, 0.0},
                                        {up(0.0), infinity},
                                        {-infinity, down(0.0)},
                                        {honest.hi, honest.lo}};
    for (const Enclosure& claim : claims) {
      const Verdict verdict = check(point, claim, nonsense).verdict;
      const bool holds = truth.is_in(claim);
      false_claims += holds ? 0 : 1;
      proved += verdict == Verdict::proved ? 1 : 0;
      EXPECT_FALSE(verdict == (holds ? Verdict::refuted : Verdict::proved)) << claim.lo << " " << claim.hi;
    }
  }
  EXPECT_GT(false_claims, points_of_each() * 4 / 5);  // in all scenes more than 10,000
  EXPECT_GT(proved, points_of_each() / 9);
}

INSTANTIATE_TEST_SUITE_P(MeshSolid, AboutMesh, ::testing::ValuesIn(scenes()),
                         [](const auto& scene) { return scene.param.name; });

/// Multiples of 2^-20, so that the products below are exact.
Point rounded(const Point& x) {
  Point result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = std::round(x[i] * 0x1p20) * 0x1p-20;
  return result;
}

/// n = |q|² times the rotation of q is a matrix of whole numbers.
struct WholeRotation {
  std::array<double, 4> quaternion;

  [[nodiscard]] double n() const {
    const auto& [w, x, y, z] = quaternion;
    return w * w + x * x + y * y + z * z;
  }
  [[nodiscard]] Point times_n(const Point& v) const {
    const auto& [w, x, y, z] = quaternion;
    return {(n() - 2 * (y * y + z * z)) * v[0] + 2 * (x * y - w * z) * v[1] + 2 * (x * z + w * y) * v[2],
            2 * (x * y + w * z) * v[0] + (n() - 2 * (x * x + z * z)) * v[1] + 2 * (y * z - w * x) * v[2],
            2 * (x * z - w * y) * v[0] + 2 * (y * z + w * x) * v[1] + (n() - 2 * (x * x + y * y)) * v[2]};
  }
};

/// The exact mesh is n R v, seen from n (x - t).
TEST(MeshSolid, PosesAreExactToRounding) {
  const Point t = rounded({0.3, -2.7, 1.1});
  Random random(5);
  for (const WholeRotation& rotation : {WholeRotation{{1, 2, 2, 4}}, WholeRotation{{3, 1, 0, 0}},
                                        WholeRotation{{1, 1, 0, 0}}, WholeRotation{{1, -1, 1, 1}}}) {
    const double n = rotation.n();
    for (Mesh mesh : {moved(box({-1, -1, -1}, {1, 1, 1}), n), star_mesh(1, 4), moved(with_fins(), n)}) {
      for (Point& vertex : mesh.vertices) vertex = rounded(vertex);
      Mesh larger = mesh;
      for (Point& vertex : larger.vertices) vertex = rotation.times_n(vertex);
      const oracle::ExactMesh exact(triangles_of(larger));
      const Pose pose{t, rotation.quaternion};
      const MeshSolid solid(mesh_primitive("", mesh, pose));
      const bool is_exact = n == 2.0 || n == 4.0;
      Places places(larger, 6);
      for (int k = 0; k < 250 && !HasFailure(); ++k) {
        // About the images of vertices, sides and faces, which are exact where n divides them.
        const Point about = places.next();
        Point point;
        Point seen;
        for (std::size_t i = 0; i < 3; ++i) {
          point[i] = std::round(about[i] / n * 0x1p20) * 0x1p-20 + t[i];
          seen[i] = n * (point[i] - t[i]);
        }
        Truth truth = truth_at(exact, seen);
        truth.squared.denominator *= static_cast<int>(n * n);
        const Enclosure found = solid.signed_distance(point);
        EXPECT_TRUE(truth.is_in(found)) << ::testing::PrintToString(point) << found.lo << " " << found.hi;
        if (truth.side == 0) {
          EXPECT_LE(found.hi, is_exact ? 0.0 : 1e-30) << ::testing::PrintToString(point);
        } else {
          EXPECT_TRUE(found.lo > 0.0 || found.hi < 0.0) << ::testing::PrintToString(point);
          EXPECT_LE(found.width(), 0x1p-51 * std::max(std::abs(found.lo), std::abs(found.hi)));
        }
      }
    }
  }
}

/// With a pose the surface passes through the enclosure of a point off it: nothing is known of its side.
TEST(MeshSolid, PosesLeaveSignsOpenThatTheyDoNotDecide) {
  const WholeRotation rotation{{1, 2, 2, 4}};
  const double n = rotation.n();
  const Mesh mesh = box({-2 * n, -2 * n, 0}, {2 * n, 2 * n, n});
  const MeshSolid solid(mesh_primitive("", mesh, {{}, rotation.quaternion}));
  Mesh larger = mesh;
  for (Point& vertex : larger.vertices) vertex = rotation.times_n(vertex);
  const oracle::ExactMesh exact(triangles_of(larger));
  const Point normal = rotation.times_n({0, 0, 1});  // of the face through the origin
  for (const double off : {0.0, 0x1p-200, -0x1p-200}) {
    const Point point{normal[1], -normal[0], off};
    Truth truth = truth_at(exact, {n * point[0], n * point[1], n * point[2]});
    truth.squared.denominator *= static_cast<int>(n * n);
    EXPECT_EQ(truth.side, off == 0.0 ? 0 : (off * normal[2] > 0.0 ? -1 : 1));
    const Enclosure found = solid.signed_distance(point);
    EXPECT_TRUE(truth.is_in(found)) << found.lo << " " << found.hi;
    EXPECT_EQ(found.lo, -found.hi);
    EXPECT_LT(found.hi, 1e-35);
  }
}

/// In a void, where every ray meets a side of the outer box, in which two triangles meet.
TEST(MeshSolid, PosedPointsWhoseRaysMeetSidesAreDecidedByPointsBeside) {
  const WholeRotation rotation{{1, 2, 2, 4}};
  const double n = rotation.n();
  for (const double c : {0.25 * n, 0x1p-60 * n}) {
    const double beside = c < 1.0 ? std::nextafter(c, 1.0) : 0.75 * n;
    const Mesh mesh = join(box({-2 * n, -2 * n, -2 * n}, {2 * n, 2 * n, 2 * n}),
                           turned(box({-n, -0.5 * n, -0.75 * n}, {beside, 0.75 * n, 0.5 * n})));
    Mesh larger = mesh;
    for (Point& vertex : larger.vertices) vertex = rotation.times_n(vertex);
    const Point seen = rotation.times_n({c, c, c});
    const Point point{seen[0] / n, seen[1] / n, seen[2] / n};
    ASSERT_EQ((Point{n * point[0], n * point[1], n * point[2]}), seen);
    const Enclosure found = MeshSolid(mesh_primitive("", mesh, {{}, rotation.quaternion})).signed_distance(point);
    const double distance = std::min(beside - c, 0.25 * n);
    EXPECT_LE(found.lo, distance);
    EXPECT_GE(found.hi, distance);
    EXPECT_EQ(found.lo > 0.0, c > 1.0) << found.lo << " " << found.hi;  // else no point beside is near enough
  }
}

// Unions: three boxes, two of which cross, and a ball far from them.

const std::vector<std::pair<Point, Point>>& boxes() {
  static const std::vector<std::pair<Point, Point>> all{
      {{0, 0, 0}, {4, 4, 4}}, {{2, 1, 1}, {7, 3, 3}}, {{0, -6, 0}, {2, -2, 5}}};
  return all;
}
constexpr Point centre{20, 1, 2};
constexpr double radius = 3.0;

Model boxes_and_ball() {
  Model model{"", {}};
  for (const auto& [lower, upper] : boxes()) model.primitives.push_back(mesh_primitive("", box(lower, upper)));
  Primitive ball{"", {{radius, radius, radius}, {1.0, 1.0}}, {}};
  ball.pose.translation = centre;
  model.primitives.insert(model.primitives.begin() + 1, ball);
  return model;
}
constexpr std::uint32_t ball_index = 1;

double distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Point nearest_in(const Point& x, const Point& lower, const Point& upper) {
  return {std::clamp(x[0], lower[0], upper[0]), std::clamp(x[1], lower[1], upper[1]),
          std::clamp(x[2], lower[2], upper[2])};
}

bool holds_cell(const Point& middle) {
  return std::ranges::any_of(boxes(), [&](const auto& b) { return nearest_in(middle, b.first, b.second) == middle; });
}

/// The nearest point of those cells, of all that the planes of the boxes' faces divide space into, that lie in the
/// boxes or, `inside` being false, in none.
Point nearest_of_cells(const Point& x, bool inside) {
  std::array<std::vector<double>, 3> planes;
  for (std::size_t i = 0; i < 3; ++i) {
    planes[i] = {-100, 100};
    for (const auto& [lower, upper] : boxes()) planes[i].insert(planes[i].end(), {lower[i], upper[i]});
    std::ranges::sort(planes[i]);
    const auto first = std::unique(planes[i].begin(), planes[i].end());
    const auto last = planes[i].end();
    planes[i].erase(first, last);
  }
  Point nearest{1e9, 1e9, 1e9};
  for (std::size_t i = 1; i < planes[0].size(); ++i) {
    for (std::size_t j = 1; j < planes[1].size(); ++j) {
      for (std::size_t k = 1; k < planes[2].size(); ++k) {
        const Point lower{planes[0][i - 1], planes[1][j - 1], planes[2][k - 1]};
        const Point upper{planes[0][i], planes[1][j], planes[2][k]};
        const Point middle{(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, (lower[2] + upper[2]) / 2};
        if (holds_cell(middle) != inside) continue;
        const Point near = nearest_in(x, lower, upper);
        if (distance(x, near) < distance(x, nearest)) nearest = near;
      }
    }
  }
  return nearest;
}

struct UnionTruth {
  double signed_distance;  ///< to rounding
  double deepest;          ///< no more than the signed distance to a single primitive that holds the point
  Certificate certificate;
};

UnionTruth union_truth(const Point& x) {
  const double to_centre = distance(x, centre);
  const bool in_box = holds_cell(x);
  const Point near = nearest_of_cells(x, !in_box);
  const Point beyond = to_centre < radius ? Point{centre[0] + (x[0] - centre[0]) / to_centre * radius,
                                                  centre[1] + (x[1] - centre[1]) / to_centre * radius,
                                                  centre[2] + (x[2] - centre[2]) / to_centre * radius}
                                          : near;
  UnionTruth truth{std::min(in_box ? -distance(x, near) : distance(x, near), to_centre - radius), 0.0, {}};
  truth.deepest = std::min(truth.signed_distance, to_centre - radius);
  if (in_box) {
    truth.deepest = 0.0;
    for (const auto& [lower, upper] : boxes()) {
      double depth = infinity;
      for (std::size_t i = 0; i < 3; ++i) depth = std::min({depth, x[i] - lower[i], upper[i] - x[i]});
      truth.deepest = std::min(truth.deepest, -depth);
    }
  }
  const double scale = std::abs(to_centre - radius) / to_centre;
  truth.certificate.normals = {
      {ball_index, {(x[0] - centre[0]) * scale, (x[1] - centre[1]) * scale, (x[2] - centre[2]) * scale}}};
  if (truth.signed_distance < 0.0) {
    Point escape;
    for (std::size_t i = 0; i < 3; ++i) escape[i] = x[i] + (beyond[i] - x[i]) * (1.0 + 1e-9);
    truth.certificate.escape = escape;
  }
  return truth;
}

Point union_place(Random& random, int n) {
  if (n % 3 == 0) {
    const Point by = random.point(1.6 * radius);
    return {centre[0] + by[0], centre[1] + by[1], centre[2] + by[2]};
  }
  return {random.uniform(-2, 9), random.uniform(-8, 6), random.uniform(-2, 7)};
}

TEST(MeshUnion, IsProvedByEscapesAndNormalsOfTheOthers) {
  const Checker check(boxes_and_ball());
  Random random(11);
  std::size_t inside = 0;
  for (int n = 0; n < 1500 && !HasFailure(); ++n) {
    const Point x = union_place(random, n);
    const UnionTruth truth = union_truth(x);
    const double d = truth.signed_distance;
    inside += d < 0.0 ? 1 : 0;
    const Enclosure claim{d - 2e-9 * std::abs(d) - 1e-13, (d < 0.0 ? truth.deepest : d) + 1e-12};
    EXPECT_EQ(check(x, claim, truth.certificate).verdict, Verdict::proved)
        << ::testing::PrintToString(x) << d << " " << truth.deepest;
  }
  EXPECT_GT(inside, 100U);
}

TEST(MeshUnion, NothingFalseIsProved) {
  const Checker check(boxes_and_ball());
  Random random(12);
  std::size_t false_claims = 0;
  for (int n = 0; n < 2500 && !HasFailure(); ++n) {
    const Point x = union_place(random, n);
    const UnionTruth truth = union_truth(x);
    const double d = truth.signed_distance;
    const double off = std::pow(10.0, random.uniform(-11, 1));
    const Point by = random.point(n % 2 == 0 ? std::abs(d) : 8.0);
    const Point elsewhere{x[0] + by[0], x[1] + by[1], x[2] + by[2]};
    Certificate forged = truth.certificate;
    forged.escape = elsewhere;
    forged.witness = elsewhere;
    forged.cover = {false};
    const auto vector = forged.normals[0].vector;
    for (const std::uint32_t primitive : {0U, 2U, 3U, 4U, 5U}) forged.normals.push_back({primitive, vector});
    forged.normals.push_back({ball_index, random.point(5.0)});
    for (const Enclosure& claim :
         {Enclosure{d + off, infinity}, Enclosure{-infinity, d - off}, Enclosure{d + off, d + 2.0 * off},
          Enclosure{-distance(x, elsewhere) * 1.001, infinity}, Enclosure{-d, std::max(-d, off)},
          Enclosure{0.0, infinity}, Enclosure{-infinity, 0.0}}) {
      const Verdict verdict = check(x, claim, forged).verdict;
      const bool holds = claim.lo <= d + 1e-12 && d - 1e-12 <= claim.hi;
      false_claims += holds ? 0 : 1;
      EXPECT_FALSE(verdict == (holds ? Verdict::refuted : Verdict::proved)) << d << " " << claim.lo << " " << claim.hi;
    }
  }
  EXPECT_GT(false_claims, 10000U);
}

TEST(MeshUnion, NormalsThatNameAMeshProveNothing) {
  const Checker check(boxes_and_ball());
  const Point x{16, 1, 2};  // one from the ball
  const Certificate right{{{ball_index, {-1, 0, 0}}}, std::nullopt};
  EXPECT_EQ(check(x, {0.999, 1.001}, right).verdict, Verdict::proved);
  for (const std::uint32_t other : {0U, 2U, 3U, 4U}) {
    const Finding finding = check(x, {0.999, 1.001}, {{{other, {-1, 0, 0}}}, std::nullopt});
    EXPECT_EQ(finding.verdict, Verdict::unproved);
    EXPECT_EQ(finding.proven.hi, 9.0);  // that of a box
  }
}

TEST(MeshUnion, ThinGapIsOutside) {
  const Model model{
      "", {mesh_primitive("", box({0, 0, 0}, {1, 1, 1})), mesh_primitive("", box({1 + 0x1p-40, 0, 0}, {2, 1, 1}))}};
  const Checker check(model);
  const Point gap{1 + 0x1p-41, 0.5, 0.5};
  EXPECT_EQ(check(gap, {0x1p-41, 0x1p-41}, {}).verdict, Verdict::proved);
  // One deep in a box is no deeper in the union than the gap is away.
  EXPECT_EQ(check(Point{0.75, 0.5, 0.5}, {-0.25 - 0x1p-40, -0.25}, {{}, gap}).verdict, Verdict::proved);
  EXPECT_EQ(check(Point{0.75, 0.5, 0.5}, {-0.25, -0.25}, {{}, Point{1.0, 0.5, 0.5}}).verdict, Verdict::unproved);
}

/// A single mesh that crosses itself: the distance to the nearest triangle, though the solid is deeper.
TEST(MeshSolid, SelfCrossingMeshHasTheDistanceToItsTriangles) {
  const Mesh crossing = join(box({0, 0, 0}, {2, 2, 2}), box({1, 0, 0}, {3, 2, 2}));
  EXPECT_EQ(Checker(model_of(crossing))(Point{1.25, 1, 1}, {-0.25, -0.25}, {}).verdict, Verdict::proved);
  EXPECT_EQ(Checker(model_of(crossing))(Point{1.25, 1, 1}, {-1, -1}, {{}, Point{1.25, 1, 2.001}}).verdict,
            Verdict::refuted);
}

TEST(MeshSolid, PointsOfARadiusAreAllWithinTheClaim) {
  const Checker check(model_of(box({0, 0, 0}, {1, 1, 1})), 0.125);
  EXPECT_EQ(check(Point{2, 0.5, 0.5}, {0.875, 1.125}, {}).verdict, Verdict::proved);
  EXPECT_EQ(check(Point{2, 0.5, 0.5}, {0.9375, 1.0625}, {}).verdict, Verdict::unproved);
  EXPECT_EQ(check(Point{2, 0.5, 0.5}, {1.25, 2.0}, {}).verdict, Verdict::refuted);
  EXPECT_EQ(check(Point{0.5, 0.5, 1}, {-0.125, 0.125}, {}).verdict, Verdict::proved);
  EXPECT_EQ(check(Point{0.5, 0.5, 1}, {0.0, 0.125}, {}).verdict, Verdict::unproved);
}

TEST(MeshSolid, SizesAtTheEndsOfBinary64AreNeverWrong) {
  for (const double scale : {0x1p-1060, 0x1p-500, 0x1p500, 0x1p1020}) {
    const MeshSolid solid(mesh_primitive("", moved(box({0, 0, 0}, {1, 1, 1}), scale)));
    EXPECT_EQ(solid.signed_distance({2 * scale, scale / 2, scale / 2}), (Enclosure{scale, scale}));
    EXPECT_EQ(solid.signed_distance({scale / 4, scale / 2, scale / 2}), (Enclosure{-scale / 4, -scale / 4}));
    EXPECT_EQ(solid.signed_distance({scale, scale / 2, scale / 2}), (Enclosure{0, 0}));
  }
  const Pose far{{1.5e308, -1.5e308, 1e308}, {1, 2, 3, 4}};
  const Enclosure beyond = MeshSolid(mesh_primitive("", tetrahedron(), far)).signed_distance({-1.5e308, 1e308, 0});
  EXPECT_EQ(beyond.hi, infinity);
}

template <class Act>
void expect_refused(const Act& act, const char* text) {
  EXPECT_THAT(act, ::testing::ThrowsMessage<Error>(::testing::HasSubstr(text))) << text;
}

TEST(MeshSolid, EverySphereHoldsItsMesh) {
  for (const Mesh& mesh : {tetrahedron(), sphere_mesh(1), torus_mesh(1.5, 0.25, 16, 8)}) {
    const EnclosingSphere sphere = MeshSolid(mesh_primitive("mesh", mesh)).sphere();
    for (const Point& vertex : mesh.vertices)
      EXPECT_LE(length<Real>(PreciseVector(precise(vertex) - sphere.centre)).upper(), sphere.radius.upper());
  }
}

/// The mesh is 0.75 from a binary64 number where those lie 1 apart: whichever it is moved to, the enclosure holds.
TEST(SeenTriangles, CountHowFarTheMoveIsRounded) {
  Mesh mesh = tetrahedron();
  for (Point& vertex : mesh.vertices) vertex = {0.75, vertex[1], vertex[2]};
  const SeenTriangles seen(mesh, {.translation = {0x1p53, 0.0, 0.0}});
  const Point& nearest = mesh.vertices.front();
  for (const double aside : {-10.0, 20.0}) {
    const Enclosure proven = seen.distance({-0x1p53 + aside, nearest[1], nearest[2]});
    EXPECT_LE(proven.lo, std::abs(aside - 0.75)) << aside;
    EXPECT_GE(proven.hi, std::abs(aside - 0.75)) << aside;
    EXPECT_LE(proven.width(), 64.0) << aside;
  }
  for (Point& vertex : mesh.vertices) vertex[0] = -1.7e308;
  EXPECT_EQ(SeenTriangles(mesh, {.translation = {1.7e308, 0.0, 0.0}}).distance({}), (Enclosure{0.0, infinity}));
}

TEST(MeshSolid, WhatIsNotCheckedIsRefused) {
  const Model cube = model_of(box({0, 0, 0}, {1, 1, 1}));
  Mesh open = tetrahedron();
  open.triangles.pop_back();
  Model unclosed = cube;
  unclosed.primitives[0].mesh = std::make_shared<const Mesh>(open);
  expect_refused([&] { Checker check(unclosed); }, "not closed: 3 of its edges");
  Model both = cube;
  both.primitives.push_back(Primitive{"", {{1, 1, 1}, {1, 1}}, {}});
  const SetExpression first{{}, SetOperation::unite, 0};
  const SetExpression second{{}, SetOperation::unite, 1};
  for (const SetOperation operation : {SetOperation::intersect, SetOperation::subtract}) {
    Model other = both;
    other.csg = SetExpression{{first, second}, operation};
    expect_refused([&] { Checker check(other); }, "only if it is the union of all its primitives");
    expect_refused([&] { Checker check(other, 0.5); }, "only if it is the union of all its primitives");
  }
  Model part = both;
  part.csg = first;
  expect_refused([&] { Checker check(part); }, "only if it is the union of all its primitives");
  UncertainModel uncertain(both);
  uncertain.primitives[1].semi_axes[0] = {0.5, 1.0};
  expect_refused([&] { Checker check(uncertain); }, "only if all of its numbers are exact");
  const Checker check(both);
  const Triangle triangle{Point{5, 0, 0}, Point{6, 0, 0}, Point{5, 1, 0}};
  EXPECT_EQ(check(triangle, {3, 5}, {{{1, {4, 0, 0}}}, std::nullopt}).verdict, Verdict::proved);
  EXPECT_EQ(check(triangle, {4.5, 5}, {{{1, {4, 0, 0}}}, std::nullopt}).verdict, Verdict::refuted);
  both.csg = SetExpression{{second, SetExpression{{first, second}, SetOperation::unite}}, SetOperation::unite};
  EXPECT_EQ(Checker(both)(Point{3, 0.5, 0.5}, {1, 3}, {{{1, {2, 0, 0}}}, std::nullopt}).verdict, Verdict::proved);
}

TEST(MeshSolid, OtherCheckersTakeNoMeshes) {
  const Model cube = model_of(box({0, 0, 0}, {1, 1, 1}));
  expect_refused([&] { ExactChecker check(cube); }, "mesh");
  expect_refused([&] { ContactChecker check(cube); }, "mesh");
  const std::array<Pose, 1> way{Pose{}};
  expect_refused([&] { InsertionChecker check(cube, way); }, "mesh");
}

}  // namespace
}  // namespace verisq::verify
