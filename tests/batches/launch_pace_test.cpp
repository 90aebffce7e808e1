/// How much a device is given follows the time that it takes, within what its buffers hold.
#include <gtest/gtest.h>

#include "host/device/chunk_queue.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t large = std::size_t{1} << 20U;
constexpr std::size_t first = std::size_t{1} << 14U;

TEST(LaunchPaceTest, BeginsWithLittle) {
  EXPECT_EQ(LaunchPace(large).size(), first);
  EXPECT_EQ(LaunchPace(100).size(), 100U);
  EXPECT_EQ(LaunchPace(large, 5000).size(), 5000U);
}

TEST(LaunchPaceTest, GrowsOnFastDevicesToWhatBuffersHold) {
  LaunchPace pace(large);
  for (int launch = 0; launch < 20; ++launch) pace.took(pace.size(), 1e-4);
  EXPECT_EQ(pace.size(), large);
}

TEST(LaunchPaceTest, StaysWhereALaunchTakesSomeTime) {
  LaunchPace pace(large);
  pace.took(first, 0.06);
  EXPECT_EQ(pace.size(), first);
}

TEST(LaunchPaceTest, DoesNotGrowBySmallChunks) {
  LaunchPace pace(large);
  pace.took(first / 2, 1e-4);
  EXPECT_EQ(pace.size(), first);
}

/// Of two chunks in flight the second is not told what the first took.
TEST(LaunchPaceTest, ShrinksOnceForChunksOfOneSize) {
  LaunchPace pace(large);
  pace.took(first, 1.0);
  pace.took(first, 1.0);
  EXPECT_EQ(pace.size(), first / 2);
}

TEST(LaunchPaceTest, NeverShrinksToNothing) {
  LaunchPace pace(large);
  for (int launch = 0; launch < 40; ++launch) pace.took(pace.size(), 10.0);
  EXPECT_EQ(pace.size(), 1024U);
  LaunchPace few(100);
  few.took(100, 10.0);
  EXPECT_EQ(few.size(), 100U);
}

TEST(LaunchPaceTest, KeepsVectorsWhole) {
  constexpr std::size_t vectors = 5 * std::size_t{1024};
  LaunchPace pace(vectors);
  pace.took(vectors, 1.0);
  EXPECT_EQ(pace.size(), 2048U);
}

}  // namespace
}  // namespace verisq::device
