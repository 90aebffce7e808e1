/// Distances for many poses: on the device, on the host, and one by one.
/// VERISQ_PAIR_CASES sets how many random pairs are tried.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/places.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/uncertain_scenes.hpp"
#include "tests/maps/summary_of_rows.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/random_pairs.hpp"

namespace verisq::oracle {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct FinishedPoses {
  std::vector<MapResult> rows;
  MapSummary summary;
};

/// The two models and what the rows are judged by.
struct Scene {
  std::string name;
  Model a;
  Model b;

  /// The largest semi-axis: what lengths are measured by.
  [[nodiscard]] double size() const {
    double largest = 0.0;
    for (const Model& model : {a, b}) {
      for (const Primitive& primitive : model.primitives) {
        largest = std::max(largest, std::ranges::max(primitive.superquadric.semi_axes));
      }
    }
    return largest;
  }
};

void PrintTo(const Scene& scene, std::ostream* stream) {
  *stream << scene.name;
}

[[nodiscard]] FinishedPoses map(const Scene& scene, std::span<const Pose> poses, const MapOptions& options) {
  FinishedPoses result;
  const Source<Pose> source = [&poses](std::span<Pose> chunk) {
    const std::size_t count = std::min(chunk.size(), poses.size());
    std::ranges::copy(poses.first(count), chunk.begin());
    poses = poses.subspan(count);
    return count;
  };
  const Sink<Pose> sink = [&result](std::span<const Pose> mapped, std::span<const MapResult> rows,
                                    std::span<const Certificate> certificates) {
    EXPECT_EQ(mapped.size(), rows.size());
    EXPECT_TRUE(certificates.empty());
    result.rows.insert(result.rows.end(), rows.begin(), rows.end());
  };
  result.summary = PoseMapper(scene.a, scene.b, options).map(source, sink);
  return result;
}

/// In all directions, from deep overlap to some sizes apart; quaternions of any length, some of them tiny or huge.
[[nodiscard]] std::vector<Pose> poses_around(std::size_t count, double farthest) {
  RandomCases random(7);
  std::vector<Pose> poses;
  for (std::size_t n = 0; n < count; ++n) {
    const Point u = random.direction();
    const double r = farthest * static_cast<double>(n) / static_cast<double>(count);
    Pose pose{{r * u[0], r * u[1], r * u[2]}, {}};
    const double length = n % 16 == 5 ? 1e-310 : n % 16 == 6 ? 1e300 : 1.0;
    for (double& q : pose.quaternion) q = length * random.uniform(-2, 2);
    if (n % 16 == 7) pose.quaternion = {0.0, 0.0, 1.0, 0.0};
    if (n % 16 == 8) pose.quaternion = {-3.0, 0.0, 0.0, 0.0};
    poses.push_back(pose);
  }
  return poses;
}

[[nodiscard]] std::string describe(const Pose& pose) {
  const auto& [t, q] = pose;
  return fmt::format("pose {},{},{},{},{},{},{}", t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
}

[[nodiscard]] std::vector<Enclosure> one_by_one(const Scene& scene, std::span<const Pose> poses) {
  const PairDistance distance(scene.a, scene.b);
  std::vector<Enclosure> enclosures(poses.size());
  in_parallel(poses.size(), [&](std::size_t i) { enclosures[i] = distance(poses[i]).distance; });
  return enclosures;
}

/// Both contain the exact distance.
void expect_in_common(const std::vector<MapResult>& rows, const std::vector<Enclosure>& expected,
                      std::span<const Pose> poses) {
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Enclosure& e = rows[i].distance;
    EXPECT_TRUE(e.lo <= expected[i].hi && expected[i].lo <= e.hi)
        << fmt::format("{}: [{}, {}] and [{}, {}]", describe(poses[i]), e.lo, e.hi, expected[i].lo, expected[i].hi);
    EXPECT_GE(e.lo, 0.0);
  }
}

void expect_verified(const FinishedPoses& map, double tolerance) {
  for (const auto& [distance, status] : map.rows) EXPECT_EQ(verified(distance, tolerance), status != Status::wide);
}

class PoseMapTest : public testing::TestWithParam<std::tuple<Scene, std::string>> {
 protected:
  [[nodiscard]] static const Scene& scene() { return std::get<0>(GetParam()); }
  [[nodiscard]] static const std::string& device() { return std::get<1>(GetParam()); }
};

TEST_P(PoseMapTest, AgreesWithPairDistance) {
  const std::vector<Pose> poses = poses_around(400, 4.0 * scene().size());
  const double tolerance = 1e-9 * scene().size();
  const FinishedPoses found = map(scene(), poses, {.tolerance = tolerance, .device = device()});
  expect_in_common(found.rows, one_by_one(scene(), poses), poses);
  expect_verified(found, tolerance);
  expect_summary_of_rows(found.summary, found.rows);
  EXPECT_EQ(found.summary.wide, 0U) << found.summary.largest_width;
  EXPECT_EQ(found.summary.device == "host", found.summary.device_verified == 0);
}

TEST_P(PoseMapTest, AsksTheHostForTheTightest) {
  const std::vector<Pose> poses = poses_around(48, 4.0 * scene().size());
  const std::vector<Enclosure> expected = one_by_one(scene(), poses);
  const FinishedPoses found = map(scene(), poses, {.tolerance = 0.0, .device = device()});
  expect_in_common(found.rows, expected, poses);
  expect_summary_of_rows(found.summary, found.rows);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    // 1e-12 of max(translation, radii) is where the host is no longer asked, and what the tightest are.
    const auto& t = poses[i].translation;
    const double size = std::max(
        {std::abs(t[0]), std::abs(t[1]), std::abs(t[2]), bounding_radius(scene().a), bounding_radius(scene().b)});
    EXPECT_EQ(verified(found.rows[i].distance, 1e-12 * size), found.rows[i].status != Status::wide);
    EXPECT_LE(found.rows[i].distance.width(), std::max(expected[i].width(), 1e-11 * scene().size()));
  }
}

TEST_P(PoseMapTest, OverlapIsZero) {
  std::vector<Pose> poses = poses_around(32, 0.0);
  for (Pose& pose : poses) pose.translation = scene().a.primitives[0].pose.translation;
  const Point& centre = scene().b.primitives[0].pose.translation;
  ASSERT_EQ(centre, (Point{0.0, 0.0, 0.0})) << "then the first primitives' centres coincide";
  for (const MapResult& row : map(scene(), poses, {.tolerance = 1e-9, .device = device()}).rows) {
    EXPECT_EQ(row.distance, (Enclosure{0.0, 0.0}));
    EXPECT_NE(row.status, Status::wide);
  }
}

/// From far beyond the device's range of numbers to below its smallest.
TEST_P(PoseMapTest, HugeAndTinyTranslations) {
  std::vector<Pose> poses;
  for (const double r : {1e5, 1e10, 1e20, 1e100, 1e200, 1e300, 1e308, 1e-20, 1e-200, 1e-310}) {
    for (std::size_t i = 0; i < 3; ++i) {
      Pose pose{{0.0, 0.0, 0.0}, {0.5, -0.1, 0.3, 0.7}};
      pose.translation[i] = i == 1 ? -r : r;
      poses.push_back(pose);
    }
    poses.push_back({{r, -r, r}, {1.0, 2.0, 3.0, 4.0}});
  }
  const double tolerance = 1e-9 * scene().size();
  const FinishedPoses found = map(scene(), poses, {.tolerance = tolerance, .device = device()});
  const std::vector<Enclosure> expected = one_by_one(scene(), poses);
  expect_in_common(found.rows, expected, poses);
  expect_verified(found, tolerance);
  expect_summary_of_rows(found.summary, found.rows);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Point& t = poses[i].translation;
    const double limit = 1e-12 * std::max({std::abs(t[0]), std::abs(t[1]), std::abs(t[2])});
    EXPECT_LE(found.rows[i].distance.width(), std::max({expected[i].width(), tolerance, limit})) << describe(poses[i]);
  }
}

[[nodiscard]] std::vector<Scene> scenes() {
  const auto one = [](std::size_t i) { return Model{"", {table_objects()[i]}}; };
  const auto scaled = [](Model model, double factor) {
    for (Primitive& primitive : model.primitives) {
      for (double& a : primitive.superquadric.semi_axes) a *= factor;
      for (double& t : primitive.pose.translation) t *= factor;
    }
    return model;
  };
  const Model row{"", three_in_a_row()};
  const Model needle{"", {{"needle", {{0.001, 0.002, 1.0}, {0.05, 2.0}}, {}}}};
  return {{"capsuleGem", one(0), one(1)},
          {"gemSoap", one(1), one(2)},
          {"unionCapsule", row, one(0)},
          {"unions", row, row},
          {"needleSoap", needle, one(2)},
          {"large", scaled(row, 1e6), scaled(one(1), 1e6)},
          {"small", scaled(one(0), 1e-6), scaled(row, 1e-6)},
          {"stemCapsule", read_model(places::example("stem.json")), scaled(one(0), 0.05)}};
}

INSTANTIATE_TEST_SUITE_P(Scenes, PoseMapTest,
                         testing::Combine(testing::ValuesIn(scenes()), testing::Values("auto", "host")),
                         [](const auto& test) { return std::get<0>(test.param).name + "_" + std::get<1>(test.param); });

/// How many random pairs a test tries: the variable VERISQ_PAIR_CASES of the environment.
[[nodiscard]] std::size_t requested_pairs() {
  return requested_count("VERISQ_PAIR_CASES", 30);
}

/// The pairs of the soundness tests, each with B's pose in the query: gaps and overlaps down to 1e-9 of the size,
/// contacts up to rounding, solids side by side.
TEST(PoseMapOfRandomPairsTest, AgreesWithPairDistance) {
  for (std::uint64_t seed = 0; seed < requested_pairs(); ++seed) {
    RandomCases random(seed);
    auto [a, b, family] = random_pair(random);
    Pose pose;
    std::swap(b.pose, pose);
    const Scene scene{"", {"", {a}}, {"", {b}}};
    const std::vector<Pose> poses{pose};
    SCOPED_TRACE(fmt::format("seed {}, {}", seed, to_string(family)));
    // With any width verified, the device alone answers.
    expect_in_common(map(scene, poses, {.tolerance = infinity}).rows, one_by_one(scene, poses), poses);
  }
}

/// Several chunks of a device.
TEST(PoseMapChunksTest, DeliverAllRowsInOrder) {
  const Primitive ball{"ball", {{1, 1, 1}, {1, 1}}, {}};
  const Scene scene{"", {"", {ball}}, {"", {ball}}};
  std::vector<Pose> poses(50'001);
  for (std::size_t n = 0; n < poses.size(); ++n) poses[n].translation = {2.0 + 0x1p-10 * static_cast<double>(n), 0, 0};
  const FinishedPoses found = map(scene, poses, {.tolerance = 1e-9});
  ASSERT_EQ(found.rows.size(), poses.size());
  for (std::size_t n = 0; n < poses.size(); ++n) {
    const Enclosure& e = found.rows[n].distance;
    const double exact = 0x1p-10 * static_cast<double>(n);
    ASSERT_TRUE(e.contains(exact) && e.width() <= 1e-9) << fmt::format("row {}: [{}, {}]", n, e.lo, e.hi);
  }
  expect_verified(found, 1e-9);
  expect_summary_of_rows(found.summary, found.rows);
}

TEST(PoseMapChunksTest, AnInterruptedMapDeliversWholeRowsInOrder) {
  const Primitive ball{"ball", {{1, 1, 1}, {1, 1}}, {}};
  const Scene scene{"", {"", {ball}}, {"", {ball}}};
  const std::vector<Pose> poses(20'000, Pose{{5, 0, 0}, {1, 0, 0, 0}});
  int polls = 0;
  const MapOptions options{.tolerance = 1e-3, .device = "host", .interrupted = [&polls] { return ++polls > 2000; }};
  const FinishedPoses found = map(scene, poses, options);
  EXPECT_TRUE(found.summary.interrupted);
  EXPECT_GT(found.rows.size(), 0U);
  EXPECT_LT(found.rows.size(), poses.size());
  EXPECT_EQ(found.summary.points, found.rows.size());
}

TEST(PoseMapChunksTest, OfNoPosesIsEmpty) {
  const Scene scene{"", {"", {table_objects()[0]}}, {"", {table_objects()[1]}}};
  const FinishedPoses found = map(scene, {}, {.tolerance = 1e-3});
  EXPECT_TRUE(found.rows.empty());
  EXPECT_EQ(found.summary.points, 0U);
}

TEST(PoseMapInputTest, RefusesPosesThatAreNone) {
  const Model model{"", {table_objects()[0]}};
  for (const char* const device : {"auto", "host"}) {
    PoseMapper mapper(model, model, {.tolerance = 1e-6, .device = device});
    const auto map = [&mapper](const Pose& pose) -> std::string {
      bool read = false;
      const auto once = [&](std::span<Pose> chunk) -> std::size_t {
        chunk[0] = pose;
        return std::exchange(read, true) ? 0 : 1;
      };
      try {
        mapper.map(once, [](std::span<const Pose>, std::span<const MapResult>, std::span<const Certificate>) {});
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
      }
      return "mapped";
    };
    EXPECT_THAT(map({{0, nan, 0}, {1, 0, 0, 0}}), testing::HasSubstr("is not finite"));
    EXPECT_THAT(map({{0, 0, -infinity}, {1, 0, 0, 0}}), testing::HasSubstr("is not finite"));
    EXPECT_THAT(map({{1, 2, 3}, {1, 0, nan, 0}}), testing::HasSubstr("is not finite"));
    EXPECT_THAT(map({{1, 2, 3}, {infinity, 0, 0, 0}}), testing::HasSubstr("is not finite"));
    EXPECT_EQ(map({{1, 2, 3}, {0, 0, -0.0, 0}}), "pose (1, 2, 3), quaternion (0, 0, -0, 0) has a zero quaternion");
    EXPECT_EQ(map({{1, 2, 3}, {0, 0, 5e-324, 0}}), "mapped") << "the mapper is as good as before";
  }
}

TEST(PoseMapOptionsTest, RefusesCertificatesPointRadiiAndUnknownDevices) {
  const Model model{"", {table_objects()[0]}};
  EXPECT_THROW(PoseMapper(model, model, {.tolerance = 1e-6, .device = "host", .certificates = true}), Error);
  EXPECT_THROW(PoseMapper(model, model, {.tolerance = 1e-6, .device = "host", .point_radius = 0.1}), Error);
  EXPECT_THROW(PoseMapper(model, model, {.tolerance = 1e-6, .device = "no such device"}), Error);
}

}  // namespace
}  // namespace verisq::oracle
