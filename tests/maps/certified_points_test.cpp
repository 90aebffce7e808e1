/// What a device proves of points outside it also certifies: certificates are no reason to leave rows to the host.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/device.hpp>
#include <verisq/map.hpp>

namespace verisq {
namespace {

Model two_solids() {
  return {"",
          {{"a", {{1.0, 0.6, 0.5}, {0.8, 1.2}}, {{0.4, 0.0, 0.0}, {1.0, 0.1, 0.2, 0.3}}},
           {"b", {{0.9, 0.7, 0.6}, {1.0, 0.5}}, {{-0.3, 0.1, 2.0}, {1.0, -0.2, 0.1, 0.0}}}}};
}

std::vector<Point> points_around(std::size_t count) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> component;
  std::vector<Point> points(count);
  for (Point& point : points) {
    const Point away{component(generator), component(generator), component(generator)};
    const double length = std::hypot(away[0], away[1], away[2]);
    const double reach = 3.5 + std::abs(component(generator));
    point = {reach * away[0] / length, reach * away[1] / length, 1.0 + reach * away[2] / length};
  }
  return points;
}

TEST(CertifiedPointsTest, OfPointsOutsideAreTheDevicesOwn) {
  if (std::ranges::none_of(test_devices(), &DeviceReport::passed)) GTEST_SKIP() << "no OpenCL device";
  const std::vector<Point> points = points_around(2000);
  std::span<const Point> rest = points;
  const Source<Point> source = [&](std::span<Point> queries) {
    const std::size_t size = std::min(queries.size(), rest.size());
    std::copy_n(rest.begin(), size, queries.begin());
    rest = rest.subspan(size);
    return size;
  };
  Checker checker(two_solids());
  std::size_t unproved = 0;
  const Sink<Point> sink = [&](std::span<const Point> queries, std::span<const MapResult> rows,
                               std::span<const Certificate> certificates) {
    for (std::size_t i = 0; i < queries.size(); ++i)
      unproved += checker(queries[i], rows[i].distance, certificates[i]).verdict == Verdict::proved ? 0 : 1;
  };
  PointMapper mapper(two_solids(), {.tolerance = 1e-12, .certificates = true});
  const MapSummary summary = mapper.map(source, sink);
  EXPECT_EQ(unproved, 0U);
  EXPECT_EQ(summary.wide, 0U);
  EXPECT_LE(summary.host_verified, points.size() / 100);
}

}  // namespace
}  // namespace verisq
