/// What short decimals are read as is what std::from_chars reads, bit by bit; of other texts nothing is said.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>

#include "host/files/words.hpp"

namespace verisq {
namespace {

const char* read(std::string_view text, double& number) {
  return read_short_decimal(text.data(), text.data() + text.size(), number);
}

/// Returns whether anything was read.
bool agrees(std::string_view text) {
  double number = -123.0;
  const char* const after = read(text, number);
  if (after == nullptr) return false;
  double expected = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), expected);
  EXPECT_EQ(error, std::errc{}) << text;
  EXPECT_EQ(after, end) << text;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(number), std::bit_cast<std::uint64_t>(expected)) << text;
  return true;
}

TEST(ShortDecimal, IsReadAsByTheLibrary) {
  for (const std::string_view text :
       {"0", "-0", "1", "-12.5", "5.", ".5", "-.5", "0.1", "00.10", "0.000000000000000001", "9007199254740992",
        "0.9007199254740992", "1,2", "1 2", "1.5.5", "1-2", "0x10", "2\n", "7\r\n"}) {
    EXPECT_TRUE(agrees(text)) << text;
  }
}

TEST(ShortDecimal, LeavesOthersToTheLibrary) {
  for (const std::string_view text : {"",
                                      "-",
                                      ".",
                                      "-.",
                                      "+1",
                                      "--1",
                                      " 1",
                                      "x",
                                      "e5",
                                      "inf",
                                      "-inf",
                                      "nan",
                                      "1e5",
                                      "1E5",
                                      "1.5e-3",
                                      "1.e",
                                      "9007199254740993",
                                      "12345.678901234567",
                                      "0.90071992547409921",
                                      "0.0000000000000000001",
                                      "00000000000000000001",
                                      "12345678901234567890",
                                      "18446744073709551617",
                                      "1844674407370955161.7",
                                      "340282366920938463463374607431768211457"}) {
    EXPECT_FALSE(agrees(text)) << text;
  }
}

TEST(ShortDecimal, IsReadAsByTheLibraryWhateverItsDigits) {
  std::mt19937_64 random(1);
  int read = 0;
  for (int k = 0; k < 300'000; ++k) {
    const std::string digits = fmt::format("{:0{}}", random() >> (random() % 64), random() % 21);
    const std::size_t point = random() % (digits.size() + 1);
    const std::string text = fmt::format("{}{}{}{}", random() % 2 == 0 ? "-" : "", digits.substr(0, point),
                                         random() % 8 == 0 ? "" : ".", digits.substr(point));
    if (agrees(text)) ++read;
  }
  EXPECT_GT(read, 200'000);
}

TEST(ShortDecimal, IsReadAsByTheLibraryWhateverItsCharacters) {
  constexpr std::string_view characters = "0123456789..--+eE, x";
  std::mt19937_64 random(2);
  for (int k = 0; k < 300'000; ++k) {
    std::string text(random() % 12, ' ');
    for (char& c : text) c = characters[random() % characters.size()];
    agrees(text);
  }
}

}  // namespace
}  // namespace verisq
