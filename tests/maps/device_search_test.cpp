/// What a device's proofs leave open inside is searched on the device, once there is enough of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/error.hpp>
#include <verisq/map.hpp>
#include <verisq/signed_distance.hpp>

#include "host/maps/map_run.hpp"

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
  MapRun<double, InsideProver> run(prover, options, source, sink, [&]() -> device::Batch<double>& { return search; });
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

/// A lens of three solids around the origin: nearly every point of it is deepest in none of them alone.
Model overlapping() {
  return {"",
          {{"a", {{1.0, 0.6, 0.5}, {0.8, 1.2}}, {{0.4, 0.0, 0.0}, {1.0, 0.1, 0.2, 0.3}}},
           {"b", {{0.9, 0.7, 0.6}, {1.0, 0.5}}, {{-0.3, 0.1, 0.0}, {1.0, -0.2, 0.1, 0.0}}},
           {"c", {{0.5, 0.5, 1.2}, {1.6, 1.0}}, {{0.0, 0.0, 0.2}, {1.0, 0.0, 0.0, 0.0}}}}};
}

std::vector<MapResult> mapped(const std::vector<Point>& points, const MapOptions& options, MapSummary& summary) {
  PointMapper mapper(overlapping(), options);
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
  const std::vector<MapResult> rows = mapped(points, {.tolerance = tolerance}, summary);
  ASSERT_EQ(rows.size(), points.size());
  EXPECT_EQ(summary.wide, 0U);
  EXPECT_EQ(summary.host_verified, 0U);
  const SignedDistance host(overlapping());
  for (std::size_t i = 0; i < points.size(); i += 7) {
    const Enclosure truth = host(points[i], 1e-5);
    EXPECT_TRUE(rows[i].distance.lo <= truth.hi && rows[i].distance.hi >= truth.lo) << i;
  }
  MapSummary certified;
  const std::vector<Point> few(points.begin(), points.begin() + 80);
  mapped(few, {.tolerance = tolerance, .certificates = true}, certified);
  EXPECT_GT(certified.host_verified + certified.wide, 0U) << "a search has no certificates: the host's have";
}

}  // namespace
}  // namespace verisq
