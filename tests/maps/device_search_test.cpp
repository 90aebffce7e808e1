/// What a device's proofs leave open inside is searched on the device, once there is enough of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/map.hpp>

#include "host/maps/map_run.hpp"
#include "host/maps/piped_map.hpp"

namespace verisq {
namespace {

/// Queries are numbers whose distance is minus themselves; the host proves that to 0.01.
struct InsideProver {
  static void check(double) {}
  static std::string describe(double query) { return fmt::format("query {}", query); }
  static bool at_limit(double, const Enclosure&) { return false; }
  static bool witnessed(double, double, const Certificate&) { return true; }
  static CertifiedEnclosure prove(double query) { return {{-query - 0.01, -query + 0.01}, {}}; }
  static CertifiedEnclosure coarse(double query) { return prove(query); }
};

/// Claims an enclosure of half that width about minus each query, moved by `error`.
class FakeBatch final : public device::Batch<double> {
 public:
  FakeBatch(double half_width, double error) : half_width_(half_width), error_(error) {}

  [[nodiscard]] std::size_t capacity() const override { return 1000; }
  void submit(std::span<const double> queries) override {
    submitted += queries.size();
    in_flight_.emplace_back(queries.begin(), queries.end());
  }
  void collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates) override {
    enclosures.clear();
    for (const double query : in_flight_.front()) {
      enclosures.push_back({error_ - query - half_width_, error_ - query + half_width_});
    }
    certificates.clear();
    in_flight_.erase(in_flight_.begin());
  }
  void discard() override { in_flight_.clear(); }
  [[nodiscard]] double device_seconds() const override { return 0.0; }

  std::size_t submitted = 0;

 private:
  double half_width_;
  double error_;
  std::vector<std::vector<double>> in_flight_;
};

/// Delivers `all`, which must outlive it, once.
template <class Query>
Source<Query> source_of(const std::vector<Query>& all) {
  return [rest = std::span(all)](std::span<Query> queries) mutable {
    const std::size_t size = std::min(queries.size(), rest.size());
    std::copy_n(rest.begin(), size, queries.begin());
    rest = rest.subspan(size);
    return size;
  };
}

/// Of `count` queries 3, which the device leaves open.
MapSummary mapped(std::size_t count, FakeBatch& search) {
  const std::vector<double> queries(count, 3.0);
  const Source<double> source = source_of(queries);
  FakeBatch rough(1.0, 0.0);
  const InsideProver prover;
  const MapOptions options{.tolerance = 0.1};
  const Sink<double> sink = [](auto, auto, auto) {};
  MapRun<double, InsideProver> run(prover, options, source, sink, [&]() -> device::Batch<double>* { return &search; });
  return run.on_device(rough);
}

TEST(DeviceSearchTest, ProvesWhatIsOpenInside) {
  FakeBatch search(0.04, 0.0);
  const MapSummary summary = mapped(700, search);
  EXPECT_EQ(search.submitted, 700U);
  EXPECT_EQ(summary.device_verified, 700U);
}

TEST(DeviceSearchTest, IsNotMadeReadyForAFew) {
  FakeBatch search(0.04, 0.0);
  const MapSummary summary = mapped(10, search);
  EXPECT_EQ(search.submitted, 0U);
  EXPECT_EQ(summary.host_verified, 10U);
}

TEST(DeviceSearchTest, LeavesToTheHostWhatItCannotNarrow) {
  FakeBatch search(0.4, 0.0);
  const MapSummary summary = mapped(700, search);
  EXPECT_EQ(search.submitted, 700U);
  EXPECT_EQ(summary.host_verified, 700U);
}

TEST(DeviceSearchTest, ContradictionsAreReported) {
  FakeBatch search(0.04, 2.0);
  EXPECT_THAT([&] { mapped(700, search); },
              ::testing::ThrowsMessage<Error>(
                  ::testing::AllOf(::testing::HasSubstr("query 3"), ::testing::HasSubstr("please report"))));
}

/// Distances of points are minus their first coordinates; the host proves that to 0.01.
struct DepthProver {
  static void check(const Point&) {}
  static std::string describe(const Point& point) { return fmt::format("point {}", point[0]); }
  static bool at_limit(const Point&, const Enclosure&) { return false; }
  static bool witnessed(const Point&, double, const Certificate&) { return true; }
  static CertifiedEnclosure prove(const Point& point) { return {{-point[0] - 0.01, -point[0] + 0.01}, {}}; }
  static CertifiedEnclosure coarse(const Point& point) { return prove(point); }
};

/// Leaves points open whose first coordinate is above 2, by 1 to either side, and proves the others.
class FakePipe final : public device::PointPipe {
 public:
  [[nodiscard]] std::size_t capacity() const override { return 100; }
  void submit(const PointColumns& points, const ResultColumns& rows) override {
    device::RowSums sums{};
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double depth = points[i][0];
      const bool open = depth > 2.0;
      rows.set(i, {{-depth - (open ? 1.0 : 0.0), -depth + (open ? 1.0 : 0.0)},
                   open ? Status::wide : Status::device_verified});
      ++(open ? sums.open : sums.verified);
    }
    in_flight_.push_back({0, points.size(), sums});
  }
  device::ChunkOutcome collect() override {
    collected_ = in_flight_.front();
    in_flight_.erase(in_flight_.begin());
    return {false, std::span(&collected_, 1)};
  }
  void discard() override { in_flight_.clear(); }
  [[nodiscard]] double device_seconds() const override { return 0.0; }

 private:
  std::vector<device::RowBlock> in_flight_;
  device::RowBlock collected_{};
};

/// How often the search is announced to a map of `count` points whose first `open` ones are left open.
int announcements(std::size_t count, std::size_t open) {
  std::vector<Point> points(count, Point{1.0, 0.0, 0.0});
  std::fill_n(points.begin(), open, Point{3.0, 0.0, 0.0});
  std::vector<MapResult> rows(count);
  MemoryFeed feed{std::span<const Point>(points), std::span(rows)};
  FakePipe pipe;
  const DepthProver prover;
  const MapOptions options{.tolerance = 0.1};
  int announced = 0;
  PipedRun<DepthProver, MemoryFeed> run(prover, options, pipe, feed, {}, [&] { ++announced; });
  const MapSummary summary = run();
  EXPECT_EQ(summary.points, count);
  EXPECT_EQ(summary.host_verified, open);
  EXPECT_EQ(rows.front().distance, (Enclosure{-3.01, -2.99}));
  return announced;
}

TEST(DeviceSearchTest, IsAnnouncedToLongMapsWithAFewOpenRows) {
  EXPECT_EQ(announcements(250, 4), 1);
}

TEST(DeviceSearchTest, IsNotAnnouncedToOthers) {
  EXPECT_EQ(announcements(250, 3), 0);
  EXPECT_EQ(announcements(90, 5), 0);
}

/// A lens of three solids around the origin: nearly every point of it is deepest in none of them alone.
Model overlapping() {
  return {"",
          {{"a", {{1.0, 0.6, 0.5}, {0.8, 1.2}}, {{0.4, 0.0, 0.0}, {1.0, 0.1, 0.2, 0.3}}},
           {"b", {{0.9, 0.7, 0.6}, {1.0, 0.5}}, {{-0.3, 0.1, 0.0}, {1.0, -0.2, 0.1, 0.0}}},
           {"c", {{0.5, 0.5, 1.2}, {1.6, 1.0}}, {{0.0, 0.0, 0.2}, {1.0, 0.0, 0.0, 0.0}}}}};
}

std::vector<MapResult> mapped(const Model& model, const std::vector<Point>& points, const MapOptions& options,
                              MapSummary& summary) {
  PointMapper mapper(model, options);
  std::vector<MapResult> results;
  summary = mapper.map(source_of(points), [&](auto, std::span<const MapResult> rows, auto) {
    results.insert(results.end(), rows.begin(), rows.end());
  });
  return results;
}

TEST(DeviceSearchTest, AgreesWithTheHostWherePrimitivesOverlap) {
  const auto devices = test_devices();
  if (std::ranges::none_of(devices, &DeviceReport::passed)) GTEST_SKIP() << "no OpenCL device";
  std::mt19937_64 generator(17);
  std::uniform_real_distribution<double> within(-0.35, 0.35);
  std::vector<Point> points(600);
  for (Point& point : points) point = {within(generator), within(generator), within(generator)};

  const double tolerance = 1e-6;
  MapSummary summary;
  const std::vector<MapResult> rows = mapped(overlapping(), points, {.tolerance = tolerance}, summary);
  ASSERT_EQ(rows.size(), points.size());
  EXPECT_EQ(summary.wide, 0U);
  // A graphics processor's search ends after fewer cubes (host/device/solid_batch.cpp): the hardest rows are the
  // host's.
  const int width = std::ranges::find_if(devices, &DeviceReport::passed)->vector_width;
  EXPECT_LE(summary.host_verified, width > 1 ? 0U : points.size() / 20);
  const SignedDistance host(overlapping());
  for (std::size_t i = 0; i < points.size(); i += 7) {
    const Enclosure truth = host(points[i], 1e-5);
    EXPECT_TRUE(rows[i].distance.lo <= truth.hi && rows[i].distance.hi >= truth.lo) << i;
  }
  // In a long map the search is made ready before it is asked for.
  std::vector<Point> many(200'000, Point{10.0, 0.0, 0.0});
  std::copy(points.begin(), points.begin() + 30, many.begin());
  std::copy(points.begin() + 30, points.begin() + 100, many.end() - 70);
  MapSummary of_many;
  const std::vector<MapResult> more_rows = mapped(overlapping(), many, {.tolerance = tolerance}, of_many);
  ASSERT_EQ(more_rows.size(), many.size());
  EXPECT_EQ(of_many.wide, 0U);
  EXPECT_TRUE(std::equal(rows.begin() + 30, rows.begin() + 100, more_rows.end() - 70,
                         [](const MapResult& a, const MapResult& b) {
                           return a.distance.lo <= b.distance.hi && b.distance.lo <= a.distance.hi;
                         }));

  MapSummary certified;
  const std::vector<Point> few(points.begin(), points.begin() + 80);
  mapped(overlapping(), few, {.tolerance = tolerance, .certificates = true}, certified);
  EXPECT_GT(certified.host_verified + certified.wide, 0U) << "a search has no certificates: the host's have";
}

TEST(DeviceSearchTest, AgreesWithTheHostWhereTaperedPrimitivesOverlap) {
  const auto devices = test_devices();
  if (std::ranges::none_of(devices, &DeviceReport::passed)) GTEST_SKIP() << "no OpenCL device";
  Model model = overlapping();
  for (const auto& [i, taper] : {std::pair{0U, 3.0}, std::pair{1U, 0.4}})
    model.primitives[i].superquadric.taper = taper;
  std::mt19937_64 generator(19);
  std::uniform_real_distribution<double> within(-0.3, 0.3);
  std::vector<Point> points(300);
  for (Point& point : points) point = {within(generator), within(generator), within(generator)};
  MapSummary summary;
  const std::vector<MapResult> rows = mapped(model, points, {.tolerance = 1e-6}, summary);
  ASSERT_EQ(rows.size(), points.size());
  EXPECT_EQ(summary.wide, 0U);
  EXPECT_GT(10 * summary.device_verified, 9 * points.size());
  const SignedDistance host(model);
  for (std::size_t i = 0; i < points.size(); i += 7) {
    const Enclosure truth = host(points[i], 1e-5);
    EXPECT_TRUE(rows[i].distance.lo <= truth.hi && rows[i].distance.hi >= truth.lo) << i;
  }
}

}  // namespace
}  // namespace verisq
