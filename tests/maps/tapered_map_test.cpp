/// Maps of triangles and of poses about tapered solids: the host makes them, and says why.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>

namespace verisq {
namespace {

using testing::HasSubstr;

const Model kModel{"",
                   {{"stem", {{0.5, 0.75, 2.0}, {0.7, 1.1}, 0.25}, {{0.5, 0.25, 0.125}, {1.0, 0.5, -0.25, 0.125}}},
                    {"ball", {{0.5, 0.5, 0.5}, {1.0, 1.0}}, {{2.0, 0.0, 0.0}}}}};

struct Rows {
  std::vector<MapResult> rows;
  std::vector<Certificate> certificates;
  MapSummary summary;
};

template <class Query>
Rows mapped(Mapper<Query> mapper, std::span<const Query> queries) {
  Rows result;
  const Source<Query> source = [&](std::span<Query> chunk) {
    const std::size_t count = std::min(chunk.size(), queries.size());
    std::ranges::copy(queries.first(count), chunk.begin());
    queries = queries.subspan(count);
    return count;
  };
  const Sink<Query> sink = [&](std::span<const Query>, std::span<const MapResult> rows,
                               std::span<const Certificate> certificates) {
    result.rows.insert(result.rows.end(), rows.begin(), rows.end());
    result.certificates.insert(result.certificates.end(), certificates.begin(), certificates.end());
  };
  result.summary = mapper.map(source, sink);
  return result;
}

/// Without a device there is nothing to leave out.
void expect_made_by_host(const MapSummary& summary) {
  EXPECT_EQ(summary.device, "host");
  EXPECT_EQ(summary.device_verified, 0U);
  if (!test_devices().empty()) {
    EXPECT_THAT(summary.notice, HasSubstr("tapered"));
  }
}

TEST(TaperedMapTest, TrianglesHaveCertificatesThatProveThem) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0.0, 2.0);
  std::vector<Triangle> triangles(40);
  for (Triangle& triangle : triangles) {
    for (Point& corner : triangle) corner = {normal(random), normal(random), normal(random)};
  }
  const Rows map = mapped<Triangle>({kModel, {.tolerance = 1e-9, .certificates = true}}, triangles);
  expect_made_by_host(map.summary);
  ASSERT_EQ(map.rows.size(), triangles.size());
  const Checker check(kModel);
  const TriangleDistance distance(kModel);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Enclosure& found = map.rows[i].distance;
    EXPECT_EQ(map.rows[i].status, Status::host_verified);
    EXPECT_EQ(check(triangles[i], found, map.certificates.at(i)).verdict, Verdict::proved);
    const Enclosure alone = distance(triangles[i]);
    EXPECT_TRUE(found.lo <= alone.hi && alone.lo <= found.hi);
  }
}

TEST(TaperedMapTest, PosesAreTheHosts) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0.0, 3.0);
  std::vector<Pose> poses(20);
  for (Pose& pose : poses) {
    for (double& t : pose.translation) t = normal(random);
    for (double& q : pose.quaternion) q = normal(random);
  }
  const Rows map = mapped<Pose>({kModel, kModel, {.tolerance = 1e-9}}, poses);
  expect_made_by_host(map.summary);
  ASSERT_EQ(map.rows.size(), poses.size());
  const PairDistance distance(kModel, kModel);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(map.rows[i].status, Status::host_verified);
    EXPECT_EQ(map.rows[i].distance, distance(poses[i]).distance);
  }
}

}  // namespace
}  // namespace verisq
