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
#include <verisq/error.hpp>
#include <verisq/map.hpp>

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
  MapSummary summary;
};

Rows mapped(const MeshMapper& mapper, std::span<const Point> points) {
  Rows rows;
  rows.summary = mapper.map(PointsInChunks(points), [&](std::span<const Point> some, std::span<const MapResult> results,
                                                        std::span<const Certificate>) {
    rows.points.insert(rows.points.end(), some.begin(), some.end());
    rows.results.insert(rows.results.end(), results.begin(), results.end());
  });
  return rows;
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
  const MeshMapper mapper(mesh, options);
  return "";
} catch (const Error& error) {
  return error.what();
}

TEST(MeshMapper, EnclosesTheDistanceOfEveryPointInOrder) {
  const std::vector<Point> points = points_about_cube(70'000);
  const Rows rows = mapped(MeshMapper(cube(), {.tolerance = 1e-9}), points);
  ASSERT_EQ(rows.points, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double exact = distance_to_cube(points[i]);
    ASSERT_LE(rows.results[i].distance.lo, exact + 1e-15) << i;
    ASSERT_GE(rows.results[i].distance.hi, exact - 1e-15) << i;
  }
  EXPECT_EQ(rows.summary.host_verified, points.size());
  EXPECT_EQ(rows.summary.device, "host");
}

TEST(MeshMapper, CallsRowsWideThatAreWiderThanTheTolerance) {
  const Rows rows = mapped(MeshMapper(cube(), {.tolerance = 1e-300}), points_about_cube(100));
  EXPECT_GT(rows.summary.wide, 50);
  const Rows tightest = mapped(MeshMapper(cube(), {.tolerance = 0.0}), points_about_cube(100));
  EXPECT_EQ(tightest.summary.wide, 0);
}

TEST(MeshMapper, SaysWhetherDepthsAreExact) {
  EXPECT_TRUE(MeshMapper(cube(), {.tolerance = 1e-9}).facts().is_depth_exact);
  Mesh crossing = cube();
  for (const Point& vertex : cube().vertices)
    crossing.vertices.push_back({vertex[0] + 1.0, vertex[1], vertex[2] + 0.5});
  for (const auto& [a, b, c] : cube().triangles) crossing.triangles.push_back({a + 8, b + 8, c + 8});
  const MeshMapper::Facts facts = MeshMapper(crossing, {.tolerance = 1e-9}).facts();
  EXPECT_FALSE(facts.is_depth_exact);
  EXPECT_GT(facts.unclean, 0);
  EXPECT_EQ(facts.triangles, 24);
}

TEST(MeshMapper, RefusesWhatIsNoSolid) {
  Mesh opened = cube();
  opened.triangles.pop_back();
  EXPECT_THAT(refusal(opened, {.tolerance = 1e-9}), HasSubstr("3"));
  EXPECT_NE(refusal(Mesh{}, {.tolerance = 1e-9}), "");
  EXPECT_EQ(refusal(cube(), {.tolerance = 1e-9}), "");
}

TEST(MeshMapper, RefusesWhatItDoesNotHaveYet) {
  EXPECT_THAT(refusal(cube(), {.tolerance = 1e-9, .certificates = true}), HasSubstr("certificates"));
  EXPECT_THAT(refusal(cube(), {.tolerance = 1e-9, .device = "0"}), HasSubstr("device"));
  EXPECT_THAT(refusal(cube(), {.tolerance = 1e-9, .point_radius = 0.5}), HasSubstr("exact"));
}

TEST(MeshMapper, EndsBetweenChunksWhenInterrupted) {
  const Rows rows =
      mapped(MeshMapper(cube(), {.tolerance = 1e-9, .interrupted = [] { return true; }}), points_about_cube(10));
  EXPECT_TRUE(rows.summary.interrupted);
  EXPECT_EQ(rows.summary.points, 0);
}

}  // namespace
}  // namespace verisq
