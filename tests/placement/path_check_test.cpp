/// What paths are refused for, whatever the lengths of their quaternions.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/fixtures/error_matchers.hpp"
#include "verify/proof/way_checker.hpp"

namespace verisq {
namespace {

constexpr std::array lengths{0x1p-1000, 1e-169, 1.0, 1e180, 0x1p1000};

Pose turned(std::array<double, 4> quaternion, double length) {
  for (double& x : quaternion) x *= length;
  return {.translation = {0.0, 0.0, 5.0}, .quaternion = quaternion};
}

TEST(PathCheck, TakesTurnsBelowHalfOfOne) {
  for (const double first : lengths) {
    for (const double second : lengths) {
      const Pose from = turned({1.0, 0.0, 0.0, 0.0}, first);
      EXPECT_NO_THROW(check_turns(std::vector{from, turned({1.0, 0.0, 0.0, 0.0}, second)})) << first << " " << second;
      EXPECT_NO_THROW(check_turns(std::vector{from, turned({1e-6, 0.0, -1.0, 0.0}, second)})) << first << " " << second;
    }
  }
}

TEST(PathCheck, KnowsAnglesWhateverTheLengths) {
  for (const double first : lengths) {
    for (const double second : lengths) {
      const Pose from = turned({1.0, 0.0, 0.0, 0.0}, first);
      EXPECT_EQ(cosine_of_half_turn(from, turned({-1.0, 0.0, 0.0, 0.0}, second)), 1.0);
      EXPECT_NEAR(cosine_of_half_turn(from, turned({1.0, 0.0, -1.0, 0.0}, second)), std::sqrt(0.5), 1e-15);
      EXPECT_EQ(cosine_of_half_turn(from, turned({0.0, 0.0, -1.0, 3.0}, second)), 0.0);
    }
  }
}

TEST(PathCheck, RefusesHalfATurn) {
  for (const double first : lengths) {
    for (const double second : lengths) {
      const std::vector path{turned({1.0, 0.0, 0.0, 0.0}, first), turned({0.0, 1.0, 2.0, 0.0}, second)};
      testing::expect_error([&] { check_turns(path); }, ErrorKind::input,
                            "pose 1 of the path is half a turn from the one before, which has two ways: put a pose "
                            "between them",
                            "");
    }
  }
}

}  // namespace
}  // namespace verisq
