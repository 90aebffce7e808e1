/// One clock and one interruption: who asks, who sees, how much work begins after they have said so, and what is left
/// to itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "host/threads/background_work.hpp"
#include "host/threads/parallel.hpp"
#include "verisq/device.hpp"

namespace verisq {
namespace {

using Clock = Deadline::Clock;

std::size_t workers() {
  return std::max(1U, std::thread::hardware_concurrency());
}

TEST(DeadlineTest, CountsFromItsStart) {
  Clock::time_point now{};
  Deadline deadline(2.0, {}, [&now] { return now; });
  const auto out_of_time = deadline.out_of_time();
  now += std::chrono::seconds(10);
  EXPECT_FALSE(out_of_time());  // not begun
  deadline.start();
  now += std::chrono::milliseconds(1999);
  EXPECT_FALSE(out_of_time());
  EXPECT_FALSE(deadline.over());
  now += std::chrono::milliseconds(1);
  EXPECT_TRUE(out_of_time());
  EXPECT_TRUE(deadline.over());
  EXPECT_FALSE(deadline.interrupted());
}

TEST(DeadlineTest, IsOverWhenInterruptedToo) {
  bool interrupted = false;
  Deadline deadline({}, [&interrupted] { return interrupted; });
  deadline.start();
  EXPECT_FALSE(deadline.given());
  EXPECT_FALSE(deadline.out_of_time());  // an empty function: there is no limit
  EXPECT_FALSE(deadline.stop()());
  interrupted = true;
  EXPECT_TRUE(deadline.stop()());
  EXPECT_FALSE(deadline.passed());
}

TEST(DeadlineTest, OfTwoReasonsEitherMayBeMissing) {
  const auto yes = [] { return true; };
  const auto no = [] { return false; };
  EXPECT_FALSE(either({}, {}));
  EXPECT_TRUE(either(yes, {})());
  EXPECT_TRUE(either({}, yes)());
  EXPECT_TRUE(either(no, yes)());
  EXPECT_FALSE(either(no, no)());
}

TEST(SeenInterruptionTest, IsAskedByItsOwnThreadAloneAndStays) {
  std::atomic<int> asked = 0;
  bool says = true;
  SeenInterruption interrupted([&] {
    ++asked;
    return says;
  });
  std::thread([&] { EXPECT_FALSE(interrupted()); }).join();
  EXPECT_EQ(asked, 0);
  EXPECT_TRUE(interrupted());
  says = false;
  EXPECT_TRUE(interrupted());
  EXPECT_EQ(asked, 1);
  std::thread([&] { EXPECT_TRUE(interrupted()); }).join();
  interrupted.begin_anew();
  EXPECT_FALSE(interrupted());
}

TEST(WorkThatMayBeGivenUpTest, ReturnsOrThrowsWhatTheWorkDoes) {
  WorkThatMayBeGivenUp<int> work([] { return 3; });
  EXPECT_EQ(work.result([] { return false; }), 3);
  WorkThatMayBeGivenUp<int> failing([]() -> int { throw std::runtime_error("a driver's"); });
  EXPECT_THROW(static_cast<void>(failing.result({})), std::runtime_error);
}

TEST(WorkThatMayBeGivenUpTest, IsLeftWithinASecondAndGoesOn) {
  const auto go_on = std::make_shared<std::promise<void>>();
  const auto done = std::make_shared<std::promise<void>>();
  std::future<void> is_done = done->get_future();
  const auto begun = Clock::now();
  {
    WorkThatMayBeGivenUp<int> work([go_on, done] {
      go_on->get_future().wait();
      done->set_value();
      return 3;
    });
    int asked = 0;
    EXPECT_EQ(work.result([&asked] { return ++asked > 1; }), std::nullopt);
    EXPECT_EQ(asked, 2);
  }
  EXPECT_LT(Clock::now() - begun, std::chrono::seconds(60));  // it would wait for ever
  go_on->set_value();
  is_done.wait();
}

TEST(InParallelUntilTest, BeginsNoMoreOnceInterrupted) {
  std::atomic<std::size_t> begun = 0;
  const auto interrupted = [&begun] { return begun >= 10; };
  std::vector<std::uint8_t> whole(1000, 0);
  const std::size_t done = in_parallel_until(interrupted, whole.size(), [&](std::size_t i) {
    ++begun;
    if (!interrupted()) whole[i] = 1;
  });
  EXPECT_LE(begun, 10U + workers());
  EXPECT_LT(done, whole.size());
  for (std::size_t i = 0; i < done; ++i) EXPECT_EQ(whole[i], 1) << i;
}

TEST(InParallelUntilTest, DoesAllUnlessInterrupted) {
  std::atomic<std::size_t> done = 0;
  EXPECT_EQ(in_parallel_until([] { return false; }, 100, [&](std::size_t) { ++done; }), 100U);
  EXPECT_EQ(done, 100U);
  EXPECT_EQ(in_parallel_until([] { return true; }, 0, [](std::size_t) {}), 0U);
}

/// The thread that asks has no work left, and another one's does not end before it hears of it.
TEST(InParallelUntilTest, AsksWhileItWaits) {
  if (workers() < 2) GTEST_SKIP();
  std::atomic<int> asked = 0;
  const SeenInterruption interrupted([&asked] { return ++asked > 20; });
  const std::thread::id owner = std::this_thread::get_id();
  std::atomic<bool> other_began = false;
  const std::size_t done = in_parallel_until(interrupted, 2, [&](std::size_t) {
    if (std::this_thread::get_id() == owner) {
      while (!other_began) std::this_thread::yield();
      return;
    }
    other_began = true;
    while (!interrupted()) std::this_thread::yield();
  });
  EXPECT_LT(done, 2U);
  EXPECT_GT(asked, 20);
}

}  // namespace
}  // namespace verisq
