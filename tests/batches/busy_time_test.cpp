/// Busy time is that of a union: what overlaps counts once, however the kernels are cut into chunks.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>
#include <verisq/map.hpp>

#include "host/device/chunk_queue.hpp"
#include "tests/fixtures/random.hpp"

namespace verisq::device {
namespace {

using Chunk = std::vector<Running>;

double nanoseconds(const std::vector<Chunk>& chunks) {
  BusyTime busy;
  for (const Chunk& chunk : chunks) busy.add(chunk);
  return 1e9 * busy.seconds();
}

TEST(BusyTimeTest, AddsWhatIsApart) {
  EXPECT_EQ(nanoseconds({}), 0.0);
  EXPECT_DOUBLE_EQ(nanoseconds({{{10, 20}, {30, 45}}, {{50, 60}}}), 35.0);
}

TEST(BusyTimeTest, CountsOnceWhatTwoQueuesShare) {
  EXPECT_DOUBLE_EQ(nanoseconds({{{10, 20}}, {{10, 20}}}), 10.0);
  EXPECT_DOUBLE_EQ(nanoseconds({{{10, 20}}, {{15, 25}}}), 15.0);
  EXPECT_DOUBLE_EQ(nanoseconds({{{10, 40}}, {{15, 25}, {30, 50}}}), 40.0);
  EXPECT_DOUBLE_EQ(nanoseconds({{{10, 20}, {40, 50}}, {{20, 40}}}), 40.0) << "in a gap of the chunk before";
  EXPECT_DOUBLE_EQ(nanoseconds({{{10, 20}}, {{12, 30}}, {{25, 40}}, {{31, 60}}}), 50.0);
}

/// Against every nanosecond counted on its own.
TEST(BusyTimeTest, IsThatOfTheUnion) {
  testing::Random random(1);
  for (int i = 0; i < 200; ++i) {
    std::vector<Chunk> chunks;
    std::vector<bool> busy(5000);
    std::uint64_t end_of_last_but_one = 0;
    std::uint64_t end_of_last = 0;
    for (int n = 0; n < 20; ++n) {
      Chunk chunk;
      auto time = end_of_last_but_one;
      for (int k = 0; k < 5; ++k) {
        const auto start = time + static_cast<std::uint64_t>(random.uniform(0.0, 10.0));
        time = start + static_cast<std::uint64_t>(random.uniform(0.0, 10.0));
        chunk.push_back({start, time});
        for (auto t = start; t < time; ++t) busy.at(t) = true;
      }
      end_of_last_but_one = end_of_last;
      end_of_last = std::max(end_of_last, time);
      chunks.push_back(chunk);
    }
    EXPECT_DOUBLE_EQ(nanoseconds(chunks), static_cast<double>(std::ranges::count(busy, true)));
  }
}

/// Of searches, which keep a device busy with two chunks at once.
TEST(BusyTimeTest, OfAMapIsNoMoreThanTheTimeByTheClock) {
  const Model bent{"", {{"", {{0.029, 0.026, 0.25}, {0.7, 0.8}}, {}, Bend{1.3, 15.0}}}};
  testing::Random random(1);
  std::vector<Point> points(50'000);
  for (Point& x : points) x = random.point(0.4);
  PointMapper mapper(bent, {.tolerance = 1e-3});
  std::size_t read = 0;
  const Source<Point> source = [&](std::span<Point> chunk) {
    const std::size_t count = std::min(chunk.size(), points.size() - read);
    std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(read), count, chunk.begin());
    read += count;
    return count;
  };
  const Sink<Point> sink = [](std::span<const Point>, std::span<const MapResult>, std::span<const Certificate>) {};
  const auto start = std::chrono::steady_clock::now();
  const MapSummary summary = mapper.map(source, sink);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  if (summary.device == "host") GTEST_SKIP() << "no OpenCL device: " << summary.notice;
  EXPECT_GT(summary.device_seconds, 0.0);
  EXPECT_LE(summary.device_seconds, elapsed.count());
}

}  // namespace
}  // namespace verisq::device
