/// Numbers scaled by a power of two against numbers that need no scaling.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "verify/numbers/points.hpp"

namespace verisq::verify {
namespace {

using Quaternion = std::array<double, 4>;

Quaternion times_power_of_two(Quaternion q, int exponent) {
  for (double& x : q) x = std::ldexp(x, exponent);
  return q;
}

TEST(NearOne, GivesTheSameDigitsWhateverTheLength) {
  const Quaternion q{0.25, -1.5, 0.0, 1.0};
  for (int exponent = -1072; exponent <= 1023; ++exponent)
    ASSERT_EQ(near_one(times_power_of_two(q, exponent)), q) << exponent;
}

TEST(NearOne, LeavesTheSmallestAndTheLargestNumbersInOneAndTwo) {
  constexpr double smallest = std::numeric_limits<double>::denorm_min();
  constexpr double largest = std::numeric_limits<double>::max();
  EXPECT_EQ(near_one(Quaternion{0.0, -smallest, 0.0, 0.0}), (Quaternion{0.0, -1.0, 0.0, 0.0}));
  EXPECT_EQ(near_one(Quaternion{3 * smallest, 2 * smallest, 0.0, 0.0}), (Quaternion{1.5, 1.0, 0.0, 0.0}));
  EXPECT_EQ(near_one(Quaternion{largest, 0.0, 0.0, -largest}),
            near_one(Quaternion{largest / 4, 0.0, 0.0, -largest / 4}));
  EXPECT_LT(near_one(Quaternion{largest, 0.0, 0.0, 0.0})[0], 2.0);
}

TEST(NearOne, LosesOnlyWhatIsNothingBesideTheLargest) {
  const Quaternion found = near_one(Quaternion{0x1p1000, 0x1p-60, 0x1p-74, 0x1p-100});
  EXPECT_EQ(found, (Quaternion{1.0, 0x1p-1060, 0x1p-1074, 0.0}));
}

}  // namespace
}  // namespace verisq::verify
