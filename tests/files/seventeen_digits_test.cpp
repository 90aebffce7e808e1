/// Texts of 17 significant digits are those of printf, character by character.
#include "host/files/seventeen_digits.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <string>

namespace verisq {
namespace {

std::string printed(double number) {
  std::array<char, 64> text{};
  const int length = std::snprintf(text.data(), text.size(), "%.17g", number);
  return {text.data(), static_cast<std::size_t>(length)};
}

void expect_printed(double number) {
  for (const double signed_number : {number, -number}) {
    DigitBuffer buffer;
    ASSERT_EQ(seventeen_digits(signed_number, buffer), printed(signed_number));
  }
}

void expect_printed_around(double number) {
  expect_printed(number);
  expect_printed(std::nextafter(number, 0.0));
  expect_printed(std::nextafter(number, std::numeric_limits<double>::infinity()));
}

TEST(SeventeenDigits, OfNumbersThatEndForms) {
  for (const double number : {0.0, 1.0, 0.1, 1.0 / 3.0, 9.9999999999999999e-5, 1e-4, 99999999999999999.0, 1e17, 1e22,
                              std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max()}) {
    expect_printed_around(number);
  }
  expect_printed(std::numeric_limits<double>::infinity());
  expect_printed(std::numeric_limits<double>::quiet_NaN());
}

TEST(SeventeenDigits, OfAllPowers) {
  for (int exponent = -1074; exponent < 1024; ++exponent) expect_printed_around(std::ldexp(1.0, exponent));
  for (int exponent = -320; exponent < 309; ++exponent) {
    expect_printed_around(std::stod(fmt::format("1e{}", exponent < -307 ? -307 : exponent)));
  }
}

/// Where exactly a half is left behind the 17th digit: to the even one.
TEST(SeventeenDigits, OfTies) {
  DigitBuffer buffer;
  EXPECT_EQ(seventeen_digits(2251799813685248.5, buffer), "2251799813685248.5");
  EXPECT_EQ(seventeen_digits(1125899906842624.25, buffer), "1125899906842624.2");
  EXPECT_EQ(seventeen_digits(1125899906842624.75, buffer), "1125899906842624.8");
  std::mt19937_64 random(1);
  for (int k = 0; k < 100'000; ++k) {
    const auto mantissa = static_cast<double>(random() >> 11U);
    for (const int exponent : {-1, -2, -3, -4, -9, -20}) expect_printed(std::ldexp(mantissa, exponent));
    expect_printed(std::ldexp(static_cast<double>(random() % 100'000), -static_cast<int>(random() % 60)));
  }
}

TEST(SeventeenDigits, OfAnyBits) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int k = 0; k < 200'000; ++k) {
    expect_printed(std::bit_cast<double>(random()));
    expect_printed(unit(random));
    expect_printed(std::ldexp(unit(random), static_cast<int>(random() % 300) - 200));
  }
}

}  // namespace
}  // namespace verisq
