/// What a map does with a device that proves something false: it stops, and says so.
#include "host/maps/map_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <limits>
#include <string>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/map.hpp>

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
