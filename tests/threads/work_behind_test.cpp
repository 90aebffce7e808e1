/// Work that is left to another thread is done in order, and its errors come back.
#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <vector>

#include "host/threads/background_work.hpp"

namespace verisq {
namespace {

TEST(WorkBehind, DoesAllInOrder) {
  std::vector<int> done;
  WorkBehind<int> behind([&](int item) { done.push_back(item); });
  for (int k = 0; k < 1000; ++k) behind.add(k);
  behind.finish();
  ASSERT_EQ(done.size(), 1000U);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(done[static_cast<std::size_t>(k)], k);
}

TEST(WorkBehind, SaysWhatFailed) {
  int done = 0;
  WorkBehind<int> behind([&](int item) {
    if (item == 3) throw std::runtime_error("the item that fails");
    ++done;
  });
  const auto add_many = [&] {
    for (int k = 0; k < 1000; ++k) behind.add(k);
  };
  EXPECT_THROW(add_many(), std::runtime_error);
  behind.finish();  // it is said once
  EXPECT_EQ(done, 3);
}

TEST(WorkBehind, SaysAtTheEndWhatFailedLast) {
  WorkBehind<int> behind([](int) { throw std::runtime_error("the only item"); });
  behind.add(1);
  EXPECT_THROW(behind.finish(), std::runtime_error);
}

TEST(WorkBehind, DoesWhatIsLeftWithoutFinish) {
  int done = 0;
  {
    WorkBehind<int> behind([&](int) { ++done; });
    behind.add(1);
    behind.add(2);
  }
  EXPECT_EQ(done, 2);
}

TEST(WorkBehind, HandsBackWhatIsWorkedOff) {
  std::vector<const int*> memories;
  WorkBehind<std::vector<int>> behind([&](const std::vector<int>& item) { memories.push_back(item.data()); });
  for (int k = 0; k < 1000; ++k) {
    std::vector<int> item = behind.spare();
    item.assign(100, k);
    behind.add(std::move(item));
  }
  behind.finish();
  EXPECT_LT(std::set<const int*>(memories.begin(), memories.end()).size(), 500U);
}

}  // namespace
}  // namespace verisq
