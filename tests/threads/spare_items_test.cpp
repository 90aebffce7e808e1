/// Memory that was given back is handed out again, and no more is kept than was asked for.
#include <gtest/gtest.h>

#include <vector>

#include "host/threads/background_work.hpp"

namespace verisq {
namespace {

TEST(SpareItems, AreThoseThatWereGivenBack) {
  SpareItems<std::vector<int>> spare(2);
  EXPECT_TRUE(spare.take().empty());
  std::vector<int> numbers(1000);
  const int* const memory = numbers.data();
  spare.give_back(std::move(numbers));
  EXPECT_EQ(spare.take().data(), memory);
  EXPECT_TRUE(spare.take().empty());
}

TEST(SpareItems, AreNoMoreThanTheirLimit) {
  SpareItems<std::vector<int>> spare(2);
  for (int k = 0; k < 5; ++k) spare.give_back(std::vector<int>(7));
  EXPECT_EQ(spare.take().size(), 7U);
  EXPECT_EQ(spare.take().size(), 7U);
  EXPECT_TRUE(spare.take().empty());
}

}  // namespace
}  // namespace verisq
