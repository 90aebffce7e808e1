/// Order, limits and ends of queues between threads.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "host/threads/background_work.hpp"

namespace verisq {
namespace {

TEST(BoundedQueue, KeepsOrderAndItsLimit) {
  constexpr int count = 10'000;
  BoundedQueue<int> queue(3);
  std::atomic<int> pushed{0};
  std::jthread producer([&] {
    for (int k = 0; k < count; ++k) {
      EXPECT_TRUE(queue.push(k));
      ++pushed;
    }
    queue.close();
  });
  for (int k = 0; k < count; ++k) {
    EXPECT_LE(pushed, k + 4);  // what was popped, what fits, and one whose push has just returned
    EXPECT_EQ(queue.pop(), k);
  }
  EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(BoundedQueue, IsEmptiedAfterItsEnd) {
  BoundedQueue<int> queue(3);
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.push(2));
  queue.close();
  EXPECT_FALSE(queue.push(3));
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(BoundedQueue, LetsGoWhoWaits) {
  BoundedQueue<int> full(1);
  EXPECT_TRUE(full.push(1));
  std::jthread producer([&] { EXPECT_FALSE(full.push(2)); });
  BoundedQueue<int> empty(1);
  std::jthread consumer([&] { EXPECT_EQ(empty.pop(), std::nullopt); });
  full.close();
  empty.close();
}

}  // namespace
}  // namespace verisq
