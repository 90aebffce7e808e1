/// What a map does with a device that proves something false: it stops, and says so.
#include "host/maps/map_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <limits>
#include <string>
#include <thread>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/places.hpp"

namespace verisq {
namespace {

/// Queries are numbers whose distance is themselves; the host proves that to 0.01.
struct TrueProver {
  static void check(double) {}
  static std::string describe(double query) { return fmt::format("query {}", query); }
  static bool at_limit(double, const Enclosure&) { return false; }
  static bool witnessed(double, double, const Certificate&) { return true; }
  static CertifiedEnclosure prove(double query) { return {{query - 0.01, query + 0.01}, {}}; }
  static CertifiedEnclosure coarse(double query) { return prove(query); }
};

/// Claims the same for every query.
class StubbornBatch final : public device::Batch<double> {
 public:
  explicit StubbornBatch(const Enclosure& claim) : claim_(claim) {}

  [[nodiscard]] std::size_t capacity() const override { return 4; }
  void submit(std::span<const double> queries) override { in_flight_.push_back(queries.size()); }
  void collect(std::vector<Enclosure>& enclosures, std::vector<Certificate>& certificates) override {
    enclosures.assign(in_flight_.front(), claim_);
    certificates.clear();
    in_flight_.pop_front();
  }
  void discard() override { in_flight_.clear(); }
  [[nodiscard]] double device_seconds() const override { return 0.0; }

 private:
  Enclosure claim_;
  std::deque<std::size_t> in_flight_;
};

/// Of a single query, 3.
std::vector<MapResult> mapped(const Enclosure& claim) {
  using Run = MapRun<double, TrueProver>;
  bool read = false;
  const Source<double> source = [&read](std::span<double> queries) -> std::size_t {
    if (read) return 0;
    read = true;
    queries[0] = 3.0;
    return 1;
  };
  std::vector<MapResult> results;
  const Sink<double> sink = [&results](std::span<const double>, std::span<const MapResult> rows,
                                       std::span<const Certificate>) {
    results.insert(results.end(), rows.begin(), rows.end());
  };
  StubbornBatch batch(claim);
  const TrueProver prover;
  const MapOptions options{.tolerance = 0.1};
  Run(prover, options, source, sink).on_device(batch);
  return results;
}

TEST(MapRunTest, JoinsWhatDeviceAndHostProve) {
  const std::vector<MapResult> rows = mapped({2.0, 3.005});
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].status, Status::host_verified);
  EXPECT_EQ(rows[0].distance, (Enclosure{2.99, 3.005}));
  EXPECT_EQ(mapped({2.95, 3.0})[0].status, Status::device_verified);
}

TEST(MapRunTest, ReportsADeviceThatTheHostContradicts) {
  EXPECT_THAT(
      [] {
        mapped({4.0, 5.0});
      },
      ::testing::ThrowsMessage<Error>(::testing::AllOf(::testing::HasSubstr("query 3"), ::testing::HasSubstr("[4, 5]"),
                                                       ::testing::HasSubstr("[2.99, 3.01]"),
                                                       ::testing::HasSubstr("please report"))));
}

/// Its ends, each proven on its own, contradict each other: no width is negative.
TEST(MapRunTest, ReportsADeviceThatContradictsItself) {
  EXPECT_THAT([] { mapped({4.0, 2.0}); }, ::testing::ThrowsMessage<Error>(::testing::HasSubstr("[4, 2]")));
}

/// Counts what it proves.
struct CountingProver : TrueProver {
  explicit CountingProver(std::atomic<std::size_t>& proofs) : proven(&proofs) {}
  [[nodiscard]] CertifiedEnclosure prove(double query) const {
    ++*proven;
    return TrueProver::prove(query);
  }
  std::atomic<std::size_t>* proven;
};

/// Rows may take seconds each: an interruption waits for none that has not begun.
TEST(MapRunTest, BeginsNoRowOnceInterrupted) {
  std::atomic<std::size_t> proven = 0;
  double next = 0.0;
  const Source<double> source = [&next](std::span<double> queries) {
    for (double& query : queries) query = next++;
    return queries.size();
  };
  std::vector<double> delivered;
  const Sink<double> sink = [&delivered](std::span<const double> queries, std::span<const MapResult> rows,
                                         std::span<const Certificate>) {
    ASSERT_EQ(queries.size(), rows.size());
    for (const MapResult& row : rows) EXPECT_EQ(row.status, Status::host_verified);
    delivered.insert(delivered.end(), queries.begin(), queries.end());
  };
  const MapOptions options{.tolerance = 0.1, .interrupted = [&proven] { return proven >= 10; }};
  const CountingProver prover(proven);
  const MapSummary summary = MapRun<double, CountingProver>(prover, options, source, sink).on_host();
  EXPECT_TRUE(summary.interrupted);
  EXPECT_LE(proven, 10U + std::max(1U, std::thread::hardware_concurrency()));
  EXPECT_EQ(summary.points, delivered.size());
  for (std::size_t i = 0; i < delivered.size(); ++i) EXPECT_EQ(delivered[i], static_cast<double>(i));
}

/// Of one point: its search asks between its steps, and ends after the next ones.
TEST(PointMapperTest, EndsWithinARow) {
  const Model model = read_model(places::example("bent_tapered_stem.json"));
  for (const bool certificates : {false, true}) {
    std::size_t polls = 0;
    constexpr std::size_t enough = 10;
    MapOptions options{.tolerance = 1e-9, .device = "host", .certificates = certificates};
    options.interrupted = [&polls] { return ++polls > enough; };
    PointMapper mapper(model, options);
    polls = 0;
    bool read = false;
    std::size_t rows = 0;
    const Source<Point> source = [&read](std::span<Point> points) -> std::size_t {
      if (read) return 0;
      read = true;
      points[0] = {-12.0, -16.0, -15.0};  // where primitives overlap
      return 1;
    };
    const MapSummary summary =
        mapper.map(source, [&rows](auto, std::span<const MapResult> some, auto) { rows += some.size(); });
    EXPECT_TRUE(summary.interrupted) << certificates;
    EXPECT_EQ(rows, 0U);
    EXPECT_EQ(polls, enough + 1);  // it is not asked again
  }
}

TEST(TriangleMapperTest, RefusesACornerThatIsNotFiniteWhereverItStands) {
  const Model ball{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  TriangleMapper mapper(ball, {.tolerance = 1e-6, .device = "host"});
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity}) {
    for (std::size_t coordinate = 0; coordinate < 9; ++coordinate) {
      Triangle triangle{Point{2.0, 0.0, 0.0}, Point{3.0, 0.0, 0.0}, Point{2.0, 1.0, 0.0}};
      triangle[coordinate / 3][coordinate % 3] = bad;
      bool read = false;
      const Source<Triangle> source = [&](std::span<Triangle> queries) -> std::size_t {
        if (read) return 0;
        read = true;
        queries[0] = triangle;
        return 1;
      };
      EXPECT_THROW(mapper.map(source, [](auto, auto, auto) {}), Error) << bad << " as coordinate " << coordinate;
    }
  }
}

}  // namespace
}  // namespace verisq
