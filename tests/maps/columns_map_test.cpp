/// Maps of what lies in memory: the rows that a sink is given, bit for bit, and the summary of these rows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/map_in_memory.hpp"
#include "tests/maps/summary_of_rows.hpp"

namespace verisq {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Model ball() {
  return {"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
}

/// Two primitives that overlap.
Model pair() {
  return {"",
          {{"a", {{1.0, 0.6, 0.5}, {0.8, 1.2}}, {{0.4, 0.0, 0.0}, {1.0, 0.1, 0.2, 0.3}}},
           {"b", {{0.9, 0.7, 0.6}, {1.0, 0.5}}, {{-0.3, 0.1, 0.0}, {1.0, -0.2, 0.1, 0.0}}}}};
}

std::vector<Point> random_points(std::size_t count, double reach) {
  std::mt19937_64 generator(count);
  std::uniform_real_distribution<double> within(-reach, reach);
  std::vector<Point> points(count);
  for (Point& point : points) point = {within(generator), within(generator), within(generator)};
  return points;
}

void expect_same_rows(std::span<const MapResult> a, std::span<const MapResult> b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].distance, b[i].distance) << i;
    ASSERT_EQ(a[i].status, b[i].status) << i;
  }
}

/// By columns and by rows, compared with what a sink is given.
void expect_rows_of_a_sink(const UncertainModel& model, const std::vector<Point>& points, const MapOptions& options) {
  const oracle::FinishedMap expected = oracle::map_in_memory(model, points, options);
  expect_summary_of_rows(expected.summary, expected.rows);
  PointMapper mapper(model, options);
  std::vector<MapResult> rows(points.size());
  expect_summary_of_rows(mapper.map(points, rows), expected.rows);
  expect_same_rows(rows, expected.rows);

  std::array<std::vector<double>, 3> coordinates;
  for (const Point& point : points)
    for (std::size_t i = 0; i < 3; ++i) coordinates[i].push_back(point[i]);
  std::vector<double> lo(points.size());
  std::vector<double> hi(points.size());
  std::vector<Status> status(points.size());
  const auto& [x, y, z] = coordinates;
  const MapSummary summary =
      mapper.map({std::span(x), std::span(y), std::span(z)}, {std::span(lo), std::span(hi), std::span(status)});
  expect_summary_of_rows(summary, expected.rows);
  EXPECT_EQ(summary.wide_inside, expected.summary.wide_inside);
  EXPECT_EQ(summary.device, expected.summary.device);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = {{lo[i], hi[i]}, status[i]};
  expect_same_rows(rows, expected.rows);
}

TEST(ColumnsMapTest, AreThoseOfASinkAtAnyTolerance) {
  for (const double tolerance : {0.0, 1e-13, 1e-6, 0.1}) {
    expect_rows_of_a_sink(ball(), random_points(500, 1.5), {.tolerance = tolerance});
    expect_rows_of_a_sink(pair(), random_points(40, 1.5), {.tolerance = std::max(tolerance, 1e-6)});
  }
}

TEST(ColumnsMapTest, AreThoseOfASinkOfAnyNumber) {
  for (const std::size_t count : {0U, 1U, 15U, 16U, 17U, 1024U, 1025U, 65535U, 65536U, 65537U, 140000U})
    expect_rows_of_a_sink(ball(), random_points(count, 100.0), {.tolerance = 1e-6});
}

TEST(ColumnsMapTest, AreThoseOfASinkOnTheHost) {
  expect_rows_of_a_sink(pair(), random_points(30, 1.5), {.tolerance = 1e-4, .device = "host"});
}

TEST(ColumnsMapTest, AreThoseOfASinkOfUncertainPoints) {
  expect_rows_of_a_sink(ball(), random_points(200, 2.0), {.tolerance = 0.3, .point_radius = 0.1});
}

/// Rows that one block in five leaves to the host do not disturb the others.
TEST(ColumnsMapTest, HostAndDeviceShareAChunk) {
  std::vector<Point> points = random_points(20000, 50.0);
  for (std::size_t i = 0; i < points.size(); i += 5000) points[i] = {0.1, 0.2, 0.3};
  expect_rows_of_a_sink(pair(), points, {.tolerance = 1e-4});
}

TEST(ColumnsMapTest, RefusePointsThatAreNotFiniteAsASinkDoes) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity}) {
    for (const char* const device : {"auto", "host"}) {
      std::vector<Point> points = random_points(70000, 10.0);
      points[69000][1] = bad;
      points[69001][2] = bad;
      if (std::string(device) == "host") points.erase(points.begin(), points.begin() + 68999);
      const MapOptions options{.tolerance = 1e-6, .device = device};
      std::string message;
      try {
        (void)oracle::map_in_memory(ball(), points, options);
      } catch (const Error& error) {
        message = error.what();
      }
      EXPECT_THAT(message, HasSubstr("is not finite"));
      PointMapper mapper(ball(), options);
      std::vector<MapResult> rows(points.size());
      EXPECT_THAT([&] { (void)mapper.map(points, rows); }, ThrowsMessage<Error>(message));
      points.resize(10, {2.0, 0.0, 0.0});
      points[0] = points[1] = points[2] = {2.0, 0.0, 0.0};
      EXPECT_EQ(mapper.map(points, std::span(rows).first(10)).points, 10U);
    }
  }
}

TEST(ColumnsMapTest, RefuseColumnsThatDoNotFit) {
  PointMapper mapper(ball(), {.tolerance = 1e-6, .device = "host"});
  const std::vector<Point> points = random_points(3, 2.0);
  std::vector<MapResult> rows(2);
  EXPECT_THAT([&] { (void)mapper.map(points, rows); }, ThrowsMessage<Error>(HasSubstr("2 rows")));
  const std::vector<double> two(2);
  const std::vector<double> three(3);
  EXPECT_THROW(PointColumns(two, three, three), Error);
  std::vector<double> ends(2);
  std::vector<Status> status(3);
  EXPECT_THROW(ResultColumns(ends, ends, status), Error);
  PointMapper certified(ball(), {.tolerance = 1e-6, .certificates = true});
  EXPECT_THAT([&] { (void)certified.map(std::span(points).first(2), rows); },
              ThrowsMessage<Error>(HasSubstr("certificates")));
}

/// Rows are written while points are read.
TEST(ColumnsMapTest, RefuseRowsInTheMemoryOfPointsOrOfEachOther) {
  PointMapper mapper(ball(), {.tolerance = 1e-6, .device = "host"});
  std::vector<double> x(4, 2.0);
  std::vector<double> y(4, 0.0);
  std::vector<double> z(4, 0.0);
  std::vector<double> ends(8);
  std::vector<Status> status(4);
  const std::span lo = std::span(ends).first(4);
  const auto refused = ThrowsMessage<Error>(HasSubstr("share memory"));
  EXPECT_THAT([&] { (void)mapper.map(PointColumns(x, y, z), ResultColumns(lo, x, status)); }, refused);
  EXPECT_THAT([&] { (void)mapper.map(PointColumns(x, y, z), ResultColumns(lo, lo, status)); }, refused);
  const ResultColumns shifted(4, {ends.data()}, {ends.data() + 3}, {status.data()});
  EXPECT_THAT([&] { (void)mapper.map(PointColumns(x, y, z), shifted); }, refused);
  const ResultColumns unlike(2, {ends.data(), 3}, {ends.data() + 1, 2}, {status.data()});
  EXPECT_THAT([&] { (void)mapper.map(PointColumns(x, y, z).subspan(0, 2), unlike); }, refused);
  EXPECT_EQ(mapper.map(PointColumns(x, y, z), ResultColumns(lo, std::span(ends).last(4), status)).points, 4U);
}

/// One record a point, also from the last to the first.
TEST(ColumnsMapTest, PointsAndRowsInterleave) {
  struct Record {
    Point point;
    MapResult row;
  };
  const std::vector<Point> points = random_points(3000, 2.0);
  std::vector<Record> records;
  records.reserve(points.size());
  for (const Point& point : points) records.push_back({point, {}});
  constexpr auto stride = static_cast<std::ptrdiff_t>(sizeof(Record) / sizeof(double));
  for (const std::ptrdiff_t direction : {1, -1}) {
    Record& first = direction > 0 ? records.front() : records.back();
    const std::ptrdiff_t step = direction * stride;
    double* const at = first.point.data();
    const PointColumns queries(records.size(), {at, step}, {at + 1, step}, {at + 2, step});
    const ResultColumns rows(records.size(), {&first.row.distance.lo, step}, {&first.row.distance.hi, step},
                             {&first.row.status, direction * static_cast<std::ptrdiff_t>(sizeof(Record))});
    PointMapper mapper(ball(), {.tolerance = 1e-9});
    EXPECT_EQ(mapper.map(queries, rows).wide, 0U);
    for (std::size_t i = 0; i < records.size(); i += 500) EXPECT_TRUE(verified(rows[i].distance, 1e-9)) << i;
  }
}

/// Too far apart for one buffer of a device.
TEST(ColumnsMapTest, ColumnsMayBeSpreadWidely) {
  constexpr std::ptrdiff_t stride = 5000;
  std::vector<double> spread(200 * stride, 0.0);
  for (std::size_t i = 0; i < 200; ++i) spread[i * stride] = 2.0 + static_cast<double>(i);
  std::vector<MapResult> rows(200);
  const PointColumns queries(200, {spread.data(), stride}, {spread.data() + 1, stride}, {spread.data() + 2, stride});
  PointMapper mapper(ball(), {.tolerance = 1e-9});
  EXPECT_EQ(mapper.map(queries, rows).wide, 0U);
}

/// Interrupted between two chunks: those before are there, and counted.
TEST(ColumnsMapTest, TellHowFarAnInterruptedMapCame) {
  bool begun = false;  // kernels that are compiled before may be given up, too
  int polls = 0;
  MapOptions options{.tolerance = 1e-6};
  options.interrupted = [&] { return begun && ++polls > 1; };
  PointMapper mapper(ball(), options);
  if (PointMapper(ball(), {.tolerance = 1e-6}).map(std::vector<Point>(), std::span<MapResult>()).device == "host")
    GTEST_SKIP();
  // More than two chunks of a graphics processor.
  const std::vector<Point> points = random_points(std::size_t{5} << 19U, 100.0);
  std::vector<MapResult> rows(points.size(), {{5.0, -5.0}, Status::wide});
  begun = true;
  const MapSummary summary = mapper.map(points, rows);
  EXPECT_TRUE(summary.interrupted);
  EXPECT_GT(summary.points, 0U);
  EXPECT_LT(summary.points, points.size());
  for (std::size_t i = 0; i < summary.points; ++i) ASSERT_EQ(rows[i].status, Status::device_verified) << i;
}

/// Every row is valid at a time limit.
TEST(ColumnsMapTest, AreFilledAtATimeLimit) {
  bool passed = false;
  MapOptions options{.tolerance = 1e-9};
  options.out_of_time = [&passed] { return passed; };
  PointMapper mapper(pair(), options);
  passed = true;
  const std::vector<Point> points = random_points(300, 2.0);
  std::vector<MapResult> rows(points.size(), {{5.0, -5.0}, Status::device_verified});
  const MapSummary summary = mapper.map(points, rows);
  EXPECT_EQ(summary.points, points.size());
  EXPECT_TRUE(summary.out_of_time);
  for (const MapResult& row : rows) EXPECT_LE(row.distance.lo, row.distance.hi);
}

TEST(ColumnsMapTest, TakeTrianglesAndPoses) {
  const std::vector<Triangle> triangles{{Point{2.0, 0.0, 0.0}, Point{2.0, 1.0, 0.0}, Point{2.0, 0.0, 1.0}},
                                        {Point{0.0, 0.0, 3.0}, Point{0.0, 1.0, 3.0}, Point{1.0, 0.0, 3.0}}};
  std::vector<MapResult> rows(2);
  TriangleMapper on_triangles(ball(), {.tolerance = 1e-6});
  expect_summary_of_rows(on_triangles.map(triangles, rows), rows);
  EXPECT_TRUE(rows[0].distance.contains(1.0) && rows[1].distance.contains(2.0));
  const std::vector<Pose> poses{{{3.0, 0.0, 0.0}}, {{0.0, 5.0, 0.0}}};
  PoseMapper on_poses(ball(), ball(), {.tolerance = 1e-6});
  expect_summary_of_rows(on_poses.map(poses, rows), rows);
  EXPECT_TRUE(rows[0].distance.contains(1.0) && rows[1].distance.contains(3.0));
}

}  // namespace
}  // namespace verisq
