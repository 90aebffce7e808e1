/// Maps of points to closed meshes as solids, in order, by chunks, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/error.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {
namespace {

using testing::HasSubstr;

/// The surface of [-1, 1]^3.
Mesh cube() {
  Mesh mesh;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) mesh.vertices.push_back({x, y, z});
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

/// Delivers them in chunks of at most 1,000, so that the map's own chunks are filled in part.
class PointsInChunks {
 public:
  explicit PointsInChunks(std::span<const Point> points) : points_(points) {}

  std::size_t operator()(std::span<Point> chunk) {
    const std::size_t count = std::min({chunk.size(), points_.size() - next_, std::size_t{1000}});
    std::copy_n(points_.begin() + static_cast<std::ptrdiff_t>(next_), count, chunk.begin());
    next_ += count;
    return count;
  }

 private:
  std::span<const Point> points_;
  std::size_t next_ = 0;
};

struct Rows {
  std::vector<Point> points;
  std::vector<MapResult> results;
  std::vector<Certificate> certificates;
  MapSummary summary;
};

Model model_of(const Mesh& mesh, const Pose& pose = {}) {
  return {"", {mesh_primitive("solid", mesh, pose)}};
}

Rows mapped(const Model& model, const MapOptions& options, std::span<const Point> points) {
  Rows rows;
  rows.summary = PointMapper(model, options)
                     .map(PointsInChunks(points), [&](std::span<const Point> some, std::span<const MapResult> results,
                                                      std::span<const Certificate> certificates) {
                       rows.points.insert(rows.points.end(), some.begin(), some.end());
                       rows.results.insert(rows.results.end(), results.begin(), results.end());
                       rows.certificates.insert(rows.certificates.end(), certificates.begin(), certificates.end());
                     });
  return rows;
}

Rows mapped(const Mesh& mesh, const MapOptions& options, std::span<const Point> points) {
  return mapped(model_of(mesh), options, points);
}

std::vector<Point> points_about_cube(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
  std::vector<Point> points(count);
  for (Point& point : points) point = {coordinate(random), coordinate(random), coordinate(random)};
  return points;
}

double distance_to_cube(const Point& point) {
  double outside = 0.0;
  double inside = -std::numeric_limits<double>::infinity();
  for (const double x : point) {
    outside = std::hypot(outside, std::max(0.0, std::abs(x) - 1.0));
    inside = std::max(inside, std::abs(x) - 1.0);
  }
  return outside > 0.0 ? outside : inside;
}

std::string refusal(const Mesh& mesh, const MapOptions& options) try {
  const PointMapper mapper(model_of(mesh), options);
  return "";
} catch (const Error& error) {
  return error.what();
}

TEST(MeshMap, EnclosesTheDistanceOfEveryPointInOrder) {
  const std::vector<Point> points = points_about_cube(70'000);
  const Rows rows = mapped(cube(), {.tolerance = 1e-9}, points);
  ASSERT_EQ(rows.points, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double exact = distance_to_cube(points[i]);
    ASSERT_LE(rows.results[i].distance.lo, exact + 1e-15) << i;
    ASSERT_GE(rows.results[i].distance.hi, exact - 1e-15) << i;
  }
  EXPECT_EQ(rows.summary.host_verified, points.size());
  EXPECT_EQ(rows.summary.device, "host");
  EXPECT_EQ(rows.summary.notice, "");
}

/// A turn by a right angle about z leaves the cube in place, but for its centre.
TEST(MeshMap, AsksAMeshWhereItsPosePlacesIt) {
  const Pose pose{.translation = {10.0, 20.0, -5.0}, .quaternion = {1.0, 0.0, 0.0, 1.0}};
  const std::vector<Point> about_cube = points_about_cube(1000);
  std::vector<Point> points = about_cube;
  for (Point& point : points) point = {point[0] + 10.0, point[1] + 20.0, point[2] - 5.0};
  const Rows rows = mapped(model_of(cube(), pose), {.tolerance = 1e-9}, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double exact = distance_to_cube(about_cube[i]);
    ASSERT_LE(rows.results[i].distance.lo, exact + 1e-14) << i;
    ASSERT_GE(rows.results[i].distance.hi, exact - 1e-14) << i;
    ASSERT_LE(rows.results[i].distance.width(), 1e-12) << i;
  }
}

/// Turning so far a point overflows: nothing is said then, and nothing ends the map.
TEST(MeshMap, AnswersForPointsAndPlacesAtTheEndOfAllNumbers) {
  const std::vector<Point> points{{1e308, 1e308, -1e308}, {-1.7e308, 1.7e308, 0.0}, {4.0, 0.0, 0.0}, {1e300, 0.0, 0.0}};
  for (const Point& place : {Point{}, Point{1.0, 0.0, 0.0}, Point{1e307, -1e308, 1.7e308}}) {
    const Pose pose{.translation = place, .quaternion = {0.3, 0.5, -0.7, 0.2}};
    const Rows rows = mapped(model_of(cube(), pose), {.tolerance = 1e-9}, points);
    ASSERT_EQ(rows.results.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double farthest = 2.0 * std::max({std::abs(points[i][0]), std::abs(points[i][1]), std::abs(points[i][2]),
                                              std::abs(place[1]), std::abs(place[2]), 2.0});
      EXPECT_LE(rows.results[i].distance.lo, farthest) << i;
      EXPECT_GE(rows.results[i].distance.hi, 0.0) << i;
    }
  }
}

/// A ball beside the cube, within it in part.
Model cube_and_ball() {
  Model model = model_of(cube());
  model.primitives.insert(model.primitives.begin(), {"ball", {{0.5, 0.5, 0.5}, {1.0, 1.0}}, {{1.0, 0.0, 0.0}}});
  return model;
}

TEST(MeshMap, JoinsMeshesAndSuperquadrics) {
  const std::vector<Point> points = points_about_cube(2000);
  const Rows rows = mapped(cube_and_ball(), {.tolerance = 1e-9, .device = "host"}, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [x, y, z] = points[i];
    const double least = std::min(distance_to_cube(points[i]), std::hypot(x - 1.0, y, z) - 0.5);
    const Enclosure& found = rows.results[i].distance;
    ASSERT_GE(found.hi, least > 0.0 ? least - 1e-15 : -2.0) << i;
    ASSERT_LE(found.hi, least + 1e-9) << i << ": no primitive is nearer";
    if (least > 1e-9) {
      ASSERT_GE(found.lo, least - 1e-9) << i;
    }
    ASSERT_LE(found.lo, least + 1e-15) << i;
    if (least < -0.5) {
      ASSERT_GE(found.lo, -2.0) << i << ": a way out is known";
    }
  }
}

/// The cube without a ball about its corner.
TEST(MeshMap, SearchesOtherSetOperations) {
  Model model = cube_and_ball();
  model.primitives[0].pose.translation = {1.0, 1.0, 1.0};
  model.csg = SetExpression{{{.primitive = 1}, {.primitive = 0}}, SetOperation::subtract};
  const std::vector<Point> points{{1.0, 1.0, 1.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.625, 0.625, 0.625}};
  const Rows rows = mapped(model, {.tolerance = 1e-3, .device = "host"}, points);
  const std::vector<double> expected{0.5, 1.0, -1.0, -(std::sqrt(3.0) * 0.375 - 0.5)};
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE(rows.results[i].distance.lo, expected[i] + 1e-12) << i;
    EXPECT_GE(rows.results[i].distance.hi, expected[i] - 1e-12) << i;
    EXPECT_LE(rows.results[i].distance.width(), 1e-3) << i;
  }
}

/// Where both touch, along the face of the cube, a point lies inside of the union, and on both surfaces.
TEST(MeshMap, SeesThatTouchingSolidsCoverTheirCommonFace) {
  Model model = model_of(cube());
  model.primitives.push_back(mesh_primitive("beside", cube(), {.translation = {2.0, 0.0, 0.0}}));
  const std::vector<Point> points{{1.0, 0.0, 0.0}, {1.0, 0.25, 0.5}, {3.5, 0.0, 0.0}};
  const Rows rows = mapped(model, {.tolerance = 1e-9}, points);
  EXPECT_LE(rows.results[0].distance.lo, -1.0) << "the depth of the union is 1";
  EXPECT_LE(rows.results[1].distance.lo, -0.5);
  EXPECT_NEAR(rows.results[2].distance.lo, 0.5, 1e-13);
}

TEST(MeshMap, CallsRowsWideThatAreWiderThanTheTolerance) {
  EXPECT_GT(mapped(cube(), {.tolerance = 1e-300}, points_about_cube(100)).summary.wide, 50);
  EXPECT_EQ(mapped(cube(), {.tolerance = 0.0}, points_about_cube(100)).summary.wide, 0);
}

TEST(MeshMap, WidensRowsOfUncertainPointsAndPlaces) {
  const std::vector<Point> points{{2.0, 0.0, 0.0}};
  const Enclosure of_ball = mapped(cube(), {.tolerance = 1.0, .point_radius = 0.25}, points).results[0].distance;
  EXPECT_NEAR(of_ball.lo, 0.75, 1e-12);
  EXPECT_NEAR(of_ball.hi, 1.25, 1e-12);
  const MapOptions shifted{.tolerance = 1.0, .pose_uncertainty = PoseUncertainty{.translation = {0.5, 0.0, 0.0}}};
  const Enclosure of_places = mapped(cube(), shifted, points).results[0].distance;
  EXPECT_NEAR(of_places.lo, 0.5, 1e-12);
  EXPECT_NEAR(of_places.hi, 1.5, 1e-12);
}

TEST(MeshMap, SaysWhereDepthsAreNotExact) {
  Mesh crossing = cube();
  for (const Point& vertex : cube().vertices)
    crossing.vertices.push_back({vertex[0] + 1.0, vertex[1], vertex[2] + 0.5});
  for (const auto& [a, b, c] : cube().triangles) crossing.triangles.push_back({a + 8, b + 8, c + 8});
  const Rows rows = mapped(crossing, {.tolerance = 1e-9}, points_about_cube(10));
  EXPECT_THAT(rows.summary.notice, HasSubstr("solid: "));
  EXPECT_THAT(rows.summary.notice, HasSubstr("of 24 triangles may cross"));
}

TEST(MeshMap, ItsCertificatesProveItsRows) {
  const std::vector<Point> points = points_about_cube(500);
  for (const Model& model : {model_of(cube()), cube_and_ball()}) {
    const Rows rows = mapped(model, {.tolerance = 1e-9, .device = "host", .certificates = true}, points);
    ASSERT_EQ(rows.certificates.size(), points.size());
    const Checker checker(model);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Enclosure& claimed = rows.results[i].distance;
      ASSERT_EQ(checker(points[i], claimed, rows.certificates[i]).verdict, Verdict::proved)
          << i << ": [" << claimed.lo << ", " << claimed.hi << "]";
    }
  }
}

TEST(MeshMap, RefusesWhatIsNoSolid) {
  Mesh opened = cube();
  opened.triangles.pop_back();
  EXPECT_THAT(refusal(opened, {.tolerance = 1e-9}), HasSubstr("3"));
  EXPECT_NE(refusal(Mesh{}, {.tolerance = 1e-9}), "");
  EXPECT_EQ(refusal(cube(), {.tolerance = 1e-9}), "");
}

TEST(MeshMap, RefusesWhatItDoesNotHaveYet) {
  EXPECT_THAT(refusal(cube(), {.tolerance = 1e-9, .device = "0"}), HasSubstr("device"));
  EXPECT_THAT(refusal(cube(), {.tolerance = 1e-9, .method = Method::published}), HasSubstr("published"));
}

TEST(MeshMap, EndsBetweenChunksWhenInterrupted) {
  const Rows rows = mapped(cube(), {.tolerance = 1e-9, .interrupted = [] { return true; }}, points_about_cube(10));
  EXPECT_TRUE(rows.summary.interrupted);
  EXPECT_EQ(rows.summary.points, 0);
}

}  // namespace
}  // namespace verisq
