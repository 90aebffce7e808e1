/// Maps of triangles about bent solids and set operations, by a device and by the host.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/random.hpp"

namespace verisq {
namespace {

using ::testing::HasSubstr;

const Model& bent_stem() {
  static const Model model = read_model(places::example("bent_stem.json"));
  return model;
}

/// Around the stem, of the size that a mesh has; some meet it.
std::vector<Triangle> triangles_about_the_stem(std::size_t count, double size) {
  testing::Random random(1);
  std::vector<Triangle> triangles(count);
  for (Triangle& triangle : triangles) {
    Point at = random.point(0.4);
    at[2] -= 0.2;
    for (Point& corner : triangle) {
      const Point off = random.point(size);
      for (std::size_t i = 0; i < 3; ++i) corner[i] = at[i] + off[i];
    }
  }
  return triangles;
}

struct Rows {
  std::vector<MapResult> results;
  std::vector<Certificate> certificates;
  MapSummary summary;
};

Rows mapped(const Model& model, std::span<const Triangle> triangles, const MapOptions& options) {
  Rows rows;
  std::size_t delivered = 0;
  const Source<Triangle> source = [&](std::span<Triangle> chunk) {
    const std::size_t count = std::min(chunk.size(), triangles.size() - delivered);
    std::ranges::copy(triangles.subspan(delivered, count), chunk.begin());
    delivered += count;
    return count;
  };
  const Sink<Triangle> sink = [&](std::span<const Triangle>, std::span<const MapResult> results,
                                  std::span<const Certificate> certificates) {
    rows.results.insert(rows.results.end(), results.begin(), results.end());
    rows.certificates.insert(rows.certificates.end(), certificates.begin(), certificates.end());
  };
  rows.summary = TriangleMapper(model, options).map(source, sink);
  return rows;
}

void expect_device_meets_host(const Model& model, double tolerance) {
  const std::vector<Triangle> triangles = triangles_about_the_stem(2000, 0.01);
  const Rows rows = mapped(model, triangles, {tolerance, "0"});
  EXPECT_EQ(rows.summary.device_verified, triangles.size());
  EXPECT_LE(rows.summary.largest_width, tolerance);
  const TriangleSearch host(model);
  const auto meets_host = [&](std::size_t i) {
    const Enclosure again = host(triangles[i], tolerance);
    return rows.results[i].distance.lo <= again.hi && again.lo <= rows.results[i].distance.hi;
  };
  for (std::size_t i = 0; i < triangles.size(); i += 100) EXPECT_TRUE(meets_host(i)) << i;
}

class SolidTriangleMapTest : public ::testing::Test {
 protected:
  double radius = bounding_radius(bent_stem());
  double tolerance = 1e-6 * radius;
};

TEST_F(SolidTriangleMapTest, TheDeviceVerifiesThemAndMeetsTheHost) {
  if (test_devices().empty()) GTEST_SKIP() << "NO OPENCL DEVICE: maps of triangles by devices were NOT tested";
  expect_device_meets_host(bent_stem(), tolerance);
}

TEST_F(SolidTriangleMapTest, TheDeviceVerifiesThoseAboutTaperedBends) {
  if (test_devices().empty()) GTEST_SKIP() << "NO OPENCL DEVICE: maps of triangles by devices were NOT tested";
  Model tapered = bent_stem();
  for (Primitive& primitive : tapered.primitives) primitive.superquadric.taper = 1.7;
  expect_device_meets_host(tapered, tolerance);
}

/// Of what the device found for a triangle's points the map keeps no more than the triangle: its corners' own signed
/// distances are not below it.
TEST_F(SolidTriangleMapTest, CornersAreNoNearer) {
  const std::vector<Triangle> triangles = triangles_about_the_stem(1000, 0.05);
  const Rows rows = mapped(bent_stem(), triangles, {tolerance});
  std::vector<Point> corners;
  for (const Triangle& triangle : triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  std::vector<double> los(corners.size());
  std::vector<double> his(corners.size());
  std::vector<Status> statuses(corners.size());
  PointMapper(bent_stem(), {tolerance}).map(std::span<const Point>(corners), {los, his, statuses});
  std::size_t met = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Enclosure& of_triangle = rows.results[i / 3].distance;
    EXPECT_LE(of_triangle.lo, std::max(0.0, his[i])) << i;
    met += of_triangle.hi == 0.0 ? 1 : 0;
    if (his[i] < 0.0) {
      EXPECT_EQ(of_triangle.lo, 0.0) << i;
    }
  }
  EXPECT_GT(met, 0U);
}

TEST_F(SolidTriangleMapTest, AToleranceOfNoughtAsksForTheTightest) {
  const std::vector<Triangle> triangles = triangles_about_the_stem(40, 0.001);
  const Rows rows = mapped(bent_stem(), triangles, {0.0});
  EXPECT_EQ(rows.summary.wide, 0U);
  EXPECT_LE(rows.summary.largest_width, 2e-9 * radius);
}

TEST_F(SolidTriangleMapTest, AtTheTimeLimitRowsAreValidAndWide) {
  const std::vector<Triangle> triangles = triangles_about_the_stem(300, 0.02);
  const Rows all = mapped(bent_stem(), triangles, {tolerance});
  for (const std::string device : {"auto", "host"}) {
    MapOptions options{tolerance, device};
    options.out_of_time = [] { return true; };
    const Rows rows = mapped(bent_stem(), triangles, options);
    ASSERT_EQ(rows.results.size(), triangles.size());
    EXPECT_TRUE(rows.summary.out_of_time);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      EXPECT_EQ(rows.results[i].status, Status::wide);
      EXPECT_LE(rows.results[i].distance.lo, all.results[i].distance.hi);
      EXPECT_GE(rows.results[i].distance.hi, all.results[i].distance.lo);
      EXPECT_LE(rows.results[i].distance.width(), 3.0 * radius);
    }
  }
}

/// The limit comes in the middle of the device's work.
TEST_F(SolidTriangleMapTest, WhatIsProvenByTheTimeLimitIsKept) {
  const std::vector<Triangle> triangles = triangles_about_the_stem(200, 0.02);
  std::atomic<int> polled = 0;
  MapOptions options{tolerance};
  options.out_of_time = [&] { return ++polled > 4; };
  const Rows rows = mapped(bent_stem(), triangles, options);
  const Rows all = mapped(bent_stem(), triangles, {tolerance});
  ASSERT_EQ(rows.results.size(), triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    EXPECT_LE(rows.results[i].distance.lo, all.results[i].distance.hi);
    EXPECT_GE(rows.results[i].distance.hi, all.results[i].distance.lo);
  }
}

TEST_F(SolidTriangleMapTest, ARadiusOfTheCornersWidensBothEnds) {
  const std::vector<Triangle> triangles = triangles_about_the_stem(100, 0.01);
  constexpr double ball = 1e-3;
  MapOptions options{4.0 * ball};
  options.point_radius = ball;
  const Rows exact = mapped(bent_stem(), triangles, {tolerance});
  const Rows uncertain = mapped(bent_stem(), triangles, options);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    EXPECT_LE(uncertain.results[i].distance.lo, std::max(0.0, exact.results[i].distance.hi - ball));
    EXPECT_GE(uncertain.results[i].distance.hi, exact.results[i].distance.lo + ball);
  }
}

std::string refusal(const Model& model, const MapOptions& options) {
  try {
    const TriangleMapper mapper(model, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return {};
}

TEST_F(SolidTriangleMapTest, WithCertificatesTheHostProvesEveryRow) {
  MapOptions options{tolerance};
  options.certificates = true;
  const std::vector<Triangle> triangles = triangles_about_the_stem(20, 0.05);
  const Rows rows = mapped(bent_stem(), triangles, options);
  EXPECT_EQ(rows.summary.device, "host");
  ASSERT_EQ(rows.certificates.size(), triangles.size());
  const Checker check(bent_stem());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Enclosure& found = rows.results[i].distance;
    EXPECT_LE(found.width(), tolerance);
    EXPECT_EQ(check(triangles[i], found, rows.certificates[i]).verdict, Verdict::proved) << i;
  }
}

TEST_F(SolidTriangleMapTest, RefusesCertificatesEmptySolidsAndTrianglesThatAreNotFinite) {
  MapOptions options{tolerance};
  options.certificates = true;
  options.covers = false;
  EXPECT_THAT(refusal(bent_stem(), options), HasSubstr("certificates without covers"));
  const auto ball = [](double x) { return Primitive{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {{x, 0.0, 0.0}}}; };
  const auto leaf = [](std::uint32_t i) { return SetExpression{{}, SetOperation::unite, i}; };
  const Model apart{"", {ball(0.0), ball(5.0)}, SetExpression{{leaf(0), leaf(1)}, SetOperation::intersect}};
  EXPECT_THAT(refusal(apart, {tolerance}), HasSubstr("no point"));
  const Triangle broken{Point{0.0, 0.0, 0.0}, Point{std::nan(""), 0.0, 0.0}, Point{0.0, 1.0, 0.0}};
  EXPECT_THROW(static_cast<void>(mapped(bent_stem(), std::vector{broken}, {tolerance})), Error);
}

}  // namespace
}  // namespace verisq
