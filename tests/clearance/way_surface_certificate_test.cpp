/// What a whole surface's distance along a way in is found to be is proved again, and no forgery of that is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>

#include "tests/clearance/way_scenes.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/insertion.hpp"

namespace verisq::oracle {
namespace {

constexpr double tolerance = 0.03;

using WitnessWeights = std::array<double, 2>;

/// Poses and distances in plain floating point, by other formulas than of the proof.
class SampledWay {
 public:
  explicit SampledWay(const WayScene& scene) : path_(scene.path) {
    for (const Primitive& primitive : scene.implant.primitives)
      solids_.push_back(
          {verify::ApproximateMotion<double>::of_own_frame(primitive), verify::NearestNormal(primitive.superquadric)});
  }

  [[nodiscard]] double last_time() const { return static_cast<double>(path_.size() - 1); }

  /// Where the resting implant sees the point.
  [[nodiscard]] Point seen(const Point& x, double time) const {
    return verify::ApproximateMotion<double>(pose_at(time)).inverse_point(x);
  }

  /// About the signed distance, and no less where the point lies in several solids.
  [[nodiscard]] double distance(const Point& x, double time) const {
    const Point local = seen(x, time);
    double least = infinity;
    for (const auto& [motion, nearest] : solids_)
      least = std::min(least, nearest(motion.inverse_point(local)).distance);
    return least;
  }

 private:
  using Quaternion = std::array<double, 4>;

  static Quaternion unit(const Quaternion& q) {
    const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    return {q[0] / size, q[1] / size, q[2] / size, q[3] / size};
  }

  [[nodiscard]] Pose pose_at(double time) const {
    const auto k = std::min(static_cast<std::size_t>(time), path_.size() - 1);
    const double s = time - static_cast<double>(k);
    if (s == 0.0) return path_[k];
    Pose pose;
    for (std::size_t i = 0; i < 3; ++i)
      pose.translation[i] = (1.0 - s) * path_[k].translation[i] + s * path_[k + 1].translation[i];
    const Quaternion a = unit(path_[k].quaternion);
    Quaternion b = unit(path_[k + 1].quaternion);
    double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    if (cosine < 0.0)
      for (double& element : b) element = -element;
    cosine = std::min(std::abs(cosine), 1.0);
    const double angle = std::acos(cosine);
    const bool still = angle < 1e-8;
    const double of_a = still ? 1.0 - s : std::sin((1.0 - s) * angle) / std::sin(angle);
    const double of_b = still ? s : std::sin(s * angle) / std::sin(angle);
    for (std::size_t i = 0; i < 4; ++i) pose.quaternion[i] = of_a * a[i] + of_b * b[i];
    pose.quaternion = unit(pose.quaternion);
    return pose;
  }

  struct Solid {
    verify::ApproximateMotion<double> motion;
    verify::NearestNormal nearest;
  };

  std::vector<Pose> path_;
  std::vector<Solid> solids_;
};

Triangle corners_of(const Mesh& mesh, std::size_t n) {
  const auto& [a, b, c] = mesh.triangles[n];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

Point weighted(const Triangle& t, double first, double second) {
  Point x;
  for (std::size_t k = 0; k < 3; ++k) x[k] = t[0][k] + first * (t[1][k] - t[0][k]) + second * (t[2][k] - t[0][k]);
  return x;
}

bool is_of_one_solid(const WayScene& scene) {
  return scene.implant.primitives.size() == 1;
}

/// Points in several solids may lie deeper than samples tell.
double slack_of(const WayScene& scene) {
  return is_of_one_solid(scene) ? tolerance : 0.5;
}

/// The least distance of samples, and where it is, as `mesh_clearance_along` would tell of it.
MeshClearance sampled(const WayScene& scene, const Mesh& mesh, int divisions, int times) {
  const SampledWay way(scene);
  MeshClearance found;
  found.smallest_distance = {infinity, infinity};
  for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n) {
    const Triangle corners = corners_of(mesh, n);
    for (int i = 0; i <= divisions; ++i) {
      for (int j = 0; i + j <= divisions; ++j) {
        const Point x = weighted(corners, static_cast<double>(i) / divisions, static_cast<double>(j) / divisions);
        for (int k = 0; k <= times; ++k) {
          const double least = way.distance(x, way.last_time() * k / times);
          if (least >= found.smallest_distance.hi) continue;
          found.smallest_distance.hi = least;
          found.deepest = {x, n};
        }
      }
    }
  }
  found.smallest_distance.lo = found.smallest_distance.hi - slack_of(scene);
  return found;
}

/// Triangles here and there, of many sizes and shapes.
Mesh bone_of(std::uint64_t seed, std::size_t count, double largest) {
  RandomCases random(seed);
  Mesh mesh;
  for (std::uint32_t n = 0; n < count; ++n) {
    const Point at{random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0), random.uniform(-9.0, 8.0)};
    const double size = random.log_uniform(0.05 * largest, largest);
    for (std::size_t i = 0; i < 3; ++i) {
      const Point off = random.direction();
      mesh.vertices.push_back({at[0] + size * off[0], at[1] + size * off[1], at[2] + size * off[2]});
    }
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

std::vector<Enclosure> proven_vertices(const WayScene& scene, const std::vector<Point>& points) {
  const InsertionOptions options{.tolerance = tolerance, .device = "host"};
  const Insertion found = smallest_distance_along(scene.path, scene.implant, points, options);
  std::vector<Enclosure> proven;
  for (const MapResult& row : certified_insertion(scene.path, scene.implant, points, found, options).rows)
    proven.push_back(row.distance);
  return proven;
}

struct Proven {
  WayScene scene;
  Mesh bone;
  std::vector<Enclosure> of_vertices;
  CertifiedWaySurface surface;
};

Proven proven(const WayScene& scene, const Mesh& mesh) {
  Proven result{scene, mesh, proven_vertices(scene, mesh.vertices), {}};
  result.surface = certified_way_surface(scene.path, scene.implant, mesh, result.of_vertices,
                                         sampled(scene, mesh, 12, 60), {.tolerance = tolerance, .device = "host"});
  return result;
}

Verdict verdict_of(const Proven& proven, const Enclosure& claim, const WaySurfaceCertificate& certificate) {
  return WaySurfaceChecker(proven.scene.implant, proven.scene.path, proven.bone)(proven.of_vertices, claim, certificate)
      .verdict;
}

double lowest_vertex(const Proven& proven) {
  double lowest = infinity;
  for (const Enclosure& row : proven.of_vertices) lowest = std::min(lowest, row.hi);
  return lowest;
}

/// The implant turns about an axis beside it: points swing through it between poses that are far from it.
WayScene swinging() {
  Model implant = shaft;
  implant.primitives.front().pose = {{5.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
  std::vector<Pose> path;
  for (int k = -2; k <= 2; ++k) {
    const double half = 0.5 * k * 25.0 * std::numbers::pi / 180.0;
    path.push_back({{0.0, 0.0, 0.0}, {std::cos(half), 0.0, 0.0, std::sin(half)}});
  }
  return {"swinging", implant, path};
}

std::vector<WayScene> all_scenes() {
  std::vector<WayScene> scenes = way_scenes();
  scenes.push_back(swinging());
  return scenes;
}

TEST(WaySurfaceCertificate, ProvesWhatIsAboutAsTightAsAskedFor) {
  std::size_t deeper_between = 0;
  for (const WayScene& scene : all_scenes()) {
    for (const double largest : {0.8, 6.0}) {
      const Proven answer = proven(scene, bone_of(3, 6, largest));
      const auto& [claim, certificate, interrupted] = answer.surface;
      EXPECT_FALSE(interrupted);
      EXPECT_EQ(verdict_of(answer, claim, certificate), Verdict::proved) << scene.name << largest;
      EXPECT_LE(claim.width(), slack_of(scene) + (is_of_one_solid(scene) ? 0.1 : 0.5)) << scene.name << largest;
      deeper_between += claim.hi < lowest_vertex(answer) - tolerance ? 1 : 0;
    }
  }
  EXPECT_GE(deeper_between, 3U);
}

TEST(WaySurfaceCertificate, IsNowhereAboveWhatIsSampled) {
  for (const WayScene& scene : all_scenes()) {
    for (const std::uint64_t seed : {11U, 12U}) {
      const Proven answer = proven(scene, bone_of(seed, 4, 4.0));
      const double least = sampled(scene, answer.bone, 17, 101).smallest_distance.hi;
      EXPECT_LE(answer.surface.smallest_distance.lo, least + 1e-9) << scene.name << seed;
      EXPECT_GE(answer.surface.smallest_distance.hi, least - slack_of(scene)) << scene.name << seed;
    }
  }
}

/// Small triangles far from the deepest place are left to their vertices.
TEST(WaySurfaceCertificate, IsOfFewTriangles) {
  const Proven answer = proven(way_scenes().front(), bone_of(5, 16, 0.6));
  EXPECT_LE(answer.surface.certificate.triangles.size(), 6U);
}

TEST(WaySurfaceCertificate, KnowsThatTrianglesAreDeeperThanTheirVertices) {
  const WayScene scene{"at rest", shaft, {Pose{}}};
  const Mesh mesh{{{-4.0, -4.0, -3.0}, {8.0, -4.0, -3.1}, {-4.0, 8.0, -2.9}}, {{0, 1, 2}}};
  const Proven answer = proven(scene, mesh);
  const double at_vertices = lowest_vertex(answer);
  EXPECT_GT(at_vertices, 1.0);
  EXPECT_LT(answer.surface.smallest_distance.hi, -0.9);
  const WaySurfaceCertificate& own = answer.surface.certificate;
  WaySurfaceCertificate without_witness = own;
  without_witness.deepest.reset();
  for (const WaySurfaceCertificate& evidence : {own, WaySurfaceCertificate{}, without_witness})
    EXPECT_NE(verdict_of(answer, {at_vertices - tolerance, at_vertices + tolerance}, evidence), Verdict::proved);
}

/// A vertex of no triangle is no point of the surface.
TEST(WaySurfaceCertificate, IsOfVerticesOfTrianglesAlone) {
  const WayScene scene{"at rest", shaft, {Pose{}}};
  const Mesh mesh{{{0.0, 0.0, -3.0}, {8.0, -4.0, -3.0}, {8.0, 8.0, -3.0}, {8.0, 8.0, 0.0}}, {{1, 2, 3}}};
  const Proven answer = proven(scene, mesh);
  EXPECT_GT(answer.surface.smallest_distance.lo, 5.0);
  const Enclosure deep{answer.of_vertices[0].lo - 1.0, answer.of_vertices[0].hi};
  EXPECT_NE(verdict_of(answer, deep, answer.surface.certificate), Verdict::proved);
}

/// One cell of all of a triangle, clear where its corners begin and end.
WaySurfaceCertificate one_cell(const Point& normal) {
  return {std::nullopt, {{0, {WayCell::moved}, {{{0.0, 0.0, 0.0}, {{0, normal}}}}}}};
}

/// Between times that leave all corners outside one of them is deep inside for a while, at the axis of the turn the
/// others are not.
TEST(WaySurfaceCertificate, CountsHowFarWaysLeaveTheStraightOnes) {
  const WayScene scene = swinging();
  const SampledWay way(scene);
  const std::vector<Enclosure> nothing(3, {-infinity, infinity});
  for (std::size_t swings = 0; swings < 3; ++swings) {
    Mesh mesh{{{0.0, 0.0, 0.1}, {0.02, 0.01, 0.0}, {0.0, 0.03, 0.05}}, {{0, 1, 2}}};
    Point& vertex = mesh.vertices[swings];
    vertex[0] += 5.0;
    EXPECT_GT(way.distance(vertex, 0.0), 0.5);
    EXPECT_GT(way.distance(vertex, 4.0), 0.5);
    EXPECT_LT(way.distance(vertex, 2.0), -0.9);
    const WaySurfaceChecker check(scene.implant, scene.path, mesh);
    const Finding finding = check(nothing, {-0.8, infinity}, one_cell({-1.0, 0.0, 0.0}));
    EXPECT_EQ(finding.verdict, Verdict::unproved);
    EXPECT_LE(finding.proven.lo, -0.9);
    EXPECT_GT(finding.proven.lo, -infinity);
  }
}

/// Each corner, and each end of the way, of which the others say nothing.
TEST(WaySurfaceCertificate, CountsEachCornerAndBothEnds) {
  const std::vector<Enclosure> nothing(3, {-infinity, infinity});
  for (std::size_t deep = 0; deep < 3; ++deep) {
    Mesh mesh{{{4.0, 0.0, -3.0}, {4.0, 1.0, -3.0}, {4.0, 0.0, -2.0}}, {{0, 1, 2}}};
    mesh.vertices[deep] = {0.0, 0.0, -3.0};
    const std::vector<Pose> rest{Pose{}};
    const Finding finding = WaySurfaceChecker(shaft, rest, mesh)(nothing, {-0.5, infinity}, one_cell({1.0, 0.0, 0.0}));
    EXPECT_EQ(finding.verdict, Verdict::unproved) << deep;
    EXPECT_LE(finding.proven.lo, -0.9) << deep;
  }
  const Mesh mesh{{{0.0, 0.0, -3.0}, {0.0, 0.1, -3.0}, {0.0, 0.0, -3.1}}, {{0, 1, 2}}};
  const Pose away{{-4.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};
  for (const std::vector<Pose>& path : {std::vector{away, Pose{}}, std::vector{Pose{}, away}}) {
    const Finding finding = WaySurfaceChecker(shaft, path, mesh)(nothing, {-0.5, infinity}, one_cell({1.0, 0.0, 0.0}));
    EXPECT_EQ(finding.verdict, Verdict::unproved);
    EXPECT_LE(finding.proven.lo, -0.9);
  }
}

/// Of all solids one must not be forgotten, nor be shown clear by two normals that are each of a part.
TEST(WaySurfaceCertificate, CountsEachSolid) {
  const std::vector<Enclosure> nothing(3, {-infinity, infinity});
  const std::vector<Pose> rest{Pose{}};
  Model two = shaft;
  two.primitives.push_back(shaft.primitives.front());
  two.primitives.back().pose.translation = {6.0, 0.0, -3.0};
  const Mesh mesh{{{5.9, 0.0, -3.0}, {6.0, 0.1, -3.0}, {6.0, 0.0, -3.1}}, {{0, 1, 2}}};
  EXPECT_LE(WaySurfaceChecker(two, rest, mesh)(nothing, {-0.5, infinity}, one_cell({1.0, 0.0, 0.0})).proven.lo, -0.9);
  const Mesh across{{{-4.0, 0.0, -3.0}, {4.0, 0.0, -3.0}, {4.0, 0.1, -3.0}}, {{0, 1, 2}}};
  WaySurfaceCertificate both = one_cell({1.0, 0.0, 0.0});
  both.triangles.front().moved.front().normals.push_back({0, {-1.0, 0.0, 0.0}});
  EXPECT_LE(WaySurfaceChecker(shaft, rest, across)(nothing, {-0.5, infinity}, both).proven.lo, -0.9);
}

/// Nothing is proven where a part of the triangle, or of the way, is left out, or there is more than one.
TEST(WaySurfaceCertificate, IsOfAllPiecesAndParts) {
  using enum WayCell;
  const Mesh mesh{{{4.0, 0.0, -3.0}, {4.0, 1.0, -3.0}, {4.0, 0.0, -2.0}}, {{0, 1, 2}}};
  const std::vector<Pose> path{Pose{}, {{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0, 0.0}}};
  const WaySurfaceChecker check(shaft, path, mesh);
  const std::vector<Enclosure> nothing(3, {-infinity, infinity});
  const auto lower = [&](const std::vector<WayCell>& cells) {
    WaySurfaceCertificate certificate = one_cell({1.0, 0.0, 0.0});
    WayTriangle& triangle = certificate.triangles.front();
    triangle.cells = cells;
    triangle.moved.resize(cells.size(), triangle.moved.front());
    return check(nothing, {0.0, infinity}, certificate).proven.lo;
  };
  for (const std::vector<WayCell>& whole : {std::vector{moved},
                                            {halved, moved, moved},
                                            {quartered, moved, moved, moved, moved},
                                            {halved, quartered, moved, moved, moved, moved, moved}})
    EXPECT_GT(lower(whole), 1.0);
  for (const std::vector<WayCell>& part : {std::vector<WayCell>{},
                                           {moved, moved},
                                           {halved, moved},
                                           {quartered, moved, moved, moved},
                                           {quartered},
                                           {halved},
                                           {halved, moved, moved, moved},
                                           {quartered, moved, moved, moved, moved, moved}})
    EXPECT_EQ(lower(part), -infinity);
}

/// A point beside the triangle is none of the surface.
TEST(WaySurfaceCertificate, IsOfPointsOfTrianglesAlone) {
  const Mesh mesh{{{4.0, 0.0, -3.0}, {5.0, 0.0, -3.0}, {4.0, 1.0, -3.0}}, {{0, 1, 2}}};
  const std::vector<Pose> rest{Pose{}};
  const WaySurfaceChecker check(shaft, rest, mesh);
  const std::vector<Enclosure> nothing(3, {-infinity, infinity});
  for (const WitnessWeights& weights :
       {WitnessWeights{-4.0, 0.0}, WitnessWeights{-4.0, 0.1}, WitnessWeights{0.0, 0.5}, WitnessWeights{0.6, 0.6}}) {
    const Point x = weighted({mesh.vertices[0], mesh.vertices[1], mesh.vertices[2]}, weights[0], weights[1]);
    const CertifiedEnclosure there = SignedDistance(shaft).certified(x, 1e-3);
    const WaySurfaceCertificate certificate{WayWitness{0, weights, 0.0, there.certificate}, {}};
    const double hi = check(nothing, {-infinity, there.distance.hi + 1e-9}, certificate).proven.hi;
    const bool is_in = weights[0] >= 0.0 && weights[0] + weights[1] <= 1.0;
    EXPECT_EQ(hi < infinity, is_in) << weights[0];
  }
}

/// Of functions that fall from the vertices as steeply as they may, no value on a piece is below what is said of it.
TEST(WaySurfaceCertificate, KnowsHowFarAFunctionFallsBetweenVertices) {
  RandomCases random(21);
  for (int n = 0; n < 300; ++n) {
    Triangle whole;
    for (Point& corner : whole)
      corner = {random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0)};
    const double spread = n % 3 == 0 ? 0.0 : 2.0;
    const std::array<double, 3> at{random.uniform(0.0, spread), random.uniform(0.0, spread),
                                   random.uniform(0.0, spread)};
    const auto least = [&](const Triangle& piece) {
      double lowest = infinity;
      for (int i = 0; i <= 12; ++i) {
        for (int j = 0; i + j <= 12; ++j) {
          const Point x = weighted(piece, i / 12.0, j / 12.0);
          double value = -infinity;
          for (std::size_t k = 0; k < 3; ++k)
            value = std::max(value, at[k] - std::hypot(x[0] - whole[k][0], x[1] - whole[k][1], x[2] - whole[k][2]));
          lowest = std::min(lowest, value);
        }
      }
      return lowest;
    };
    EXPECT_LE(verify::least_on(whole, at), least(whole) + 1e-12);
    Triangle piece = whole;
    for (int depth = 0; depth < 4; ++depth) {
      piece = verify::quarters(piece)[random.choice(4)];
      EXPECT_LE(verify::least_on(piece, verify::quartering_error(whole), whole, at), least(piece) + 1e-12);
    }
  }
}

/// Claims that are false, or go beyond what is proven, with evidence that is changed, too, or not.
class WaySurfaceForger {
 public:
  explicit WaySurfaceForger(const Proven& proven)
      : proven_(proven), check_(proven.scene.implant, proven.scene.path, proven.bone) {}

  std::size_t operator()() {
    const Enclosure& truth = proven_.surface.smallest_distance;
    const WaySurfaceCertificate& own = proven_.surface.certificate;
    const double little = 1e-12 * std::abs(truth.lo);
    expect_not_proved({truth.lo + little, truth.hi}, own);
    const std::vector<Enclosure> claims{{truth.hi + 1e-12, truth.hi + 1.0}, {truth.hi + 1e-12, infinity},
                                        {truth.hi + 1e-6, truth.hi + 1e-3}, {truth.lo - 1.0, truth.lo - 1e-12},
                                        {-infinity, truth.lo - 1e-12},      {truth.hi + 1e-12, truth.lo - 1e-12}};
    for (const WaySurfaceCertificate& evidence : evidence_of(own))
      for (const Enclosure& claim : claims) expect_not_proved(claim, evidence);
    return tried_;
  }

 private:
  using Evidence = std::vector<WaySurfaceCertificate>;

  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  void expect_not_proved(const Enclosure& claim, const WaySurfaceCertificate& evidence) {
    EXPECT_NE(check_(proven_.of_vertices, claim, evidence).verdict, Verdict::proved) << proven_.scene.name;
    ++tried_;
  }

  [[nodiscard]] static Evidence evidence_of(const WaySurfaceCertificate& own) {
    Evidence evidence{own, {}};
    add_triangles(own, evidence);
    for (std::size_t n = 0; n < own.triangles.size(); ++n) {
      add_cells(own, n, evidence);
      add_moves(own, n, evidence);
    }
    if (own.deepest) add_witnesses(own, evidence);
    return evidence;
  }

  static void add_triangles(const WaySurfaceCertificate& own, Evidence& evidence) {
    for (std::size_t n = 0; n < own.triangles.size(); ++n) {
      for (const int by : {1, -1, 1000000}) {
        evidence.push_back(own);
        evidence.back().triangles[n].triangle += static_cast<std::uint32_t>(by);
      }
      evidence.push_back(own);
      evidence.back().triangles.erase(evidence.back().triangles.begin() + static_cast<std::ptrdiff_t>(n));
      evidence.push_back(own);
      evidence.back().triangles.push_back(own.triangles[n]);
    }
    evidence.push_back(own);
    std::ranges::reverse(evidence.back().triangles);
  }

  static void add_cells(const WaySurfaceCertificate& own, std::size_t n, Evidence& evidence) {
    const std::vector<WayCell>& cells = own.triangles[n].cells;
    const std::size_t step = std::max<std::size_t>(1, cells.size() / 8);
    for (std::size_t k = 0; k < cells.size(); k += step) {
      for (const WayCell letter : {WayCell::by_vertices, WayCell::moved, WayCell::quartered, WayCell::halved}) {
        evidence.push_back(own);
        evidence.back().triangles[n].cells[k] = letter;
      }
      evidence.push_back(own);
      evidence.back().triangles[n].cells.resize(k);
    }
    evidence.push_back(own);
    evidence.back().triangles[n].cells.push_back(WayCell::by_vertices);
    evidence.push_back(own);
    evidence.back().triangles[n].cells = {WayCell::moved};
  }

  static void add_moves(const WaySurfaceCertificate& own, std::size_t n, Evidence& evidence) {
    const auto each = [&](const std::function<void(MovedCell&)>& change) {
      evidence.push_back(own);
      std::ranges::for_each(evidence.back().triangles[n].moved, change);
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const double by : {1e-3, -1e-3, 1.0, 100.0, nan, infinity})
        each([&](MovedCell& cell) { cell.step[axis] += by; });
    for (const double factor : {0.0, 0.5, 0.99, -1.0, 3.0})
      each([&](MovedCell& cell) {
        for (double& c : cell.step) c *= factor;
      });
    each([](MovedCell& cell) { cell.normals.clear(); });
    for (const double value : {0.0, nan, infinity, -1.0})
      each([&](MovedCell& cell) {
        for (Normal& normal : cell.normals) normal.vector[0] = value;
      });
    each([](MovedCell& cell) {
      for (Normal& normal : cell.normals) normal.primitive += 1;
    });
    evidence.push_back(own);
    std::ranges::reverse(evidence.back().triangles[n].moved);
    evidence.push_back(own);
    evidence.back().triangles[n].moved.clear();
  }

  static void add_witnesses(const WaySurfaceCertificate& own, Evidence& evidence) {
    const auto with = [&](const std::function<void(WayWitness&)>& change) {
      evidence.push_back(own);
      change(*evidence.back().deepest);
    };
    for (const double w : {-0.5, 0.0, 0.5, 1.0, 1.5, nan, infinity}) {
      with([&](WayWitness& witness) { witness.weights[0] = w; });
      with([&](WayWitness& witness) { witness.weights = {0.5 * w, w}; });
      with([&](WayWitness& witness) { witness.time = w; });
    }
    with([](WayWitness& witness) { witness.triangle += 1; });
    with([](WayWitness& witness) { witness.triangle += 1000000; });
    with([](WayWitness& witness) { witness.certificate.normals.clear(); });
  }

  const Proven& proven_;
  WaySurfaceChecker check_;
  std::size_t tried_ = 0;
};

TEST(WaySurfaceCertificate, NeverProvesAForgery) {
  const std::size_t meshes = requested_count("VERISQ_FORGED_WAY_SURFACES", 1);
  std::size_t tried = 0;
  for (const WayScene& scene : all_scenes())
    for (std::size_t n = 0; n < meshes; ++n) tried += WaySurfaceForger(proven(scene, bone_of(100 + n, 3, 3.0)))();
  std::cout << "forged: " << tried << "\n";
  EXPECT_GE(tried, 500U * meshes);
}

TEST(WaySurfaceCertificate, IsOfNoOtherWayImplantOrMesh) {
  for (const WayScene& scene : {way_scenes()[1], swinging()}) {
    const Proven answer = proven(scene, bone_of(7, 3, 0.5));
    Proven moved = answer;
    for (Pose& pose : moved.scene.path) pose.translation[0] += 1.0;
    Proven larger = answer;
    for (Primitive& primitive : larger.scene.implant.primitives)
      for (double& axis : primitive.superquadric.semi_axes) axis *= 1.5;
    Proven elsewhere = answer;
    for (Point& vertex : elsewhere.bone.vertices) vertex[1] += 1.0;
    std::size_t apart = 0;
    for (Proven* other : {&moved, &larger, &elsewhere}) {
      other->of_vertices = proven_vertices(other->scene, other->bone.vertices);
      const double least = sampled(other->scene, other->bone, 12, 80).smallest_distance.hi;
      const Enclosure& claim = answer.surface.smallest_distance;
      if (claim.lo <= least && least <= claim.hi) continue;
      ++apart;
      EXPECT_NE(verdict_of(*other, claim, answer.surface.certificate), Verdict::proved) << scene.name;
    }
    EXPECT_GE(apart, 2U);
  }
}

TEST(WaySurfaceCertificate, ProvesLessOfVerticesThatAreProvenLess) {
  Proven answer = proven(way_scenes().front(), bone_of(8, 6, 0.5));
  for (Enclosure& row : answer.of_vertices) row.lo -= 0.5;
  EXPECT_EQ(verdict_of(answer, answer.surface.smallest_distance, answer.surface.certificate), Verdict::unproved);
}

TEST(WaySurfaceCertificate, RefusesWhatItDoesNotKnow) {
  Model bent = shaft;
  bent.primitives.front().superquadric.exponents = {1.0, 1.0};
  bent.primitives.front().bend = Bend{0.01, 0.0};
  const std::vector<Pose> path(1);
  const Mesh mesh = bone_of(1, 1, 1.0);
  EXPECT_THROW(WaySurfaceChecker(bent, path, mesh), Error);
  EXPECT_THROW(WaySurfaceChecker(shaft, {}, mesh), Error);
  EXPECT_THROW(WaySurfaceChecker(shaft, path, Mesh{mesh.vertices, {}}), Error);
}

TEST(WaySurfaceCertificate, ProvesNothingFromBelowWhenInterrupted) {
  const Proven answer = proven(way_scenes().front(), bone_of(3, 6, 6.0));
  ASSERT_FALSE(answer.surface.certificate.triangles.empty());
  const WaySurfaceChecker check(answer.scene.implant, answer.scene.path, answer.bone);
  const auto& [claim, certificate, interrupted] = answer.surface;
  EXPECT_NE(check(answer.of_vertices, claim, certificate, {.interrupted = [] { return true; }}).verdict,
            Verdict::proved);
}

/// Nothing is proven where numbers overflow.
TEST(WaySurfaceCertificate, BearsHugeWays) {
  const Mesh mesh = bone_of(9, 1, 4.0);
  for (const double length : {1e200, 1e308}) {
    const WayScene scene{"huge", shaft, straight_path({}, {0.0, 0.0, -1.0}, length, 1)};
    const std::vector<Enclosure> of_vertices = proven_vertices(scene, mesh.vertices);
    const WaySurfaceCertificate one = one_cell({1.0, 0.0, 0.0});
    const Finding finding = WaySurfaceChecker(scene.implant, scene.path, mesh)(of_vertices, {-infinity, infinity}, one);
    EXPECT_LE(finding.proven.lo, sampled(scene, mesh, 10, 4).smallest_distance.hi);
  }
}

}  // namespace
}  // namespace verisq::oracle
