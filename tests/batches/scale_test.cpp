/// Enclosures on their way from a device's numbers to model units: outward where rounding is needed, exact elsewhere.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "host/device/chunk_queue.hpp"

namespace verisq::device {
namespace {

constexpr double tiniest = 0x1p-1074;
constexpr double largest = std::numeric_limits<double>::max();

std::vector<Enclosure> all_at_once(const Scale& scale, const std::vector<Enclosure>& on_device) {
  std::vector<double> los;
  std::vector<double> his;
  for (const Enclosure& e : on_device) {
    los.push_back(e.lo);
    his.push_back(e.hi);
  }
  std::vector<Enclosure> in_model(on_device.size());
  scale.to_model(los, his, in_model);
  return in_model;
}

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void expect_each_as_alone(int exponent, const std::vector<Enclosure>& on_device) {
  const Scale scale(exponent);
  const std::vector<Enclosure> together = all_at_once(scale, on_device);
  for (std::size_t i = 0; i < on_device.size(); ++i) {
    const Enclosure alone = scale.to_model(on_device[i]);
    EXPECT_TRUE(same(together[i].lo, alone.lo) && same(together[i].hi, alone.hi)) << exponent << ", " << i;
  }
}

TEST(Scale, IsExactInTheMiddle) {
  EXPECT_EQ(all_at_once(Scale(3), {{-8.0, 16.0}}), (std::vector<Enclosure>{{-1.0, 2.0}}));
  EXPECT_EQ(all_at_once(Scale(-3), {{-1.0, 2.0}}), (std::vector<Enclosure>{{-8.0, 16.0}}));
}

TEST(Scale, RoundsOutwardWhereNumbersVanish) {
  EXPECT_EQ(all_at_once(Scale(3), {{tiniest, tiniest}}), (std::vector<Enclosure>{{0.0, tiniest}}));
  EXPECT_EQ(all_at_once(Scale(3), {{-tiniest, -tiniest}}), (std::vector<Enclosure>{{-tiniest, 0.0}}));
}

TEST(Scale, RoundsOutwardBeyondAllNumbers) {
  EXPECT_EQ(all_at_once(Scale(-3), {{largest, largest}}), (std::vector<Enclosure>{{largest, infinity}}));
  EXPECT_EQ(all_at_once(Scale(-3), {{-largest, -largest}}), (std::vector<Enclosure>{{-infinity, -largest}}));
}

/// One extreme among many must not change the others, nor they it.
TEST(Scale, TreatsAllAtOnceAsEachAlone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_each_as_alone(3, {{1.0, 2.0}, {-infinity, infinity}, {0.0, -0.0}});
  expect_each_as_alone(3, {{1.0, 2.0}, {tiniest, 3.0}, {nan, 1.0}, {-1.0, nan}});
  std::mt19937_64 generator(1);
  for (const int exponent : {-1000, -40, 0, 1, 700, 1000}) {
    std::vector<Enclosure> any;
    any.reserve(1000);
    for (int i = 0; i < 1000; ++i) {
      any.push_back(
          {std::bit_cast<double>(std::uint64_t{generator()}), std::bit_cast<double>(std::uint64_t{generator()})});
    }
    expect_each_as_alone(exponent, any);
  }
}

}  // namespace
}  // namespace verisq::device
