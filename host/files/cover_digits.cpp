/// Bits to digits and back.
#include "host/files/cover_digits.hpp"

#include <cstddef>

namespace verisq {
namespace {

constexpr std::string_view digits = "0123456789abcdef";
constexpr std::size_t bits_per_digit = 4;

}  // namespace

std::string digits_of_cover(const std::vector<bool>& cover) {
  std::string result((cover.size() + bits_per_digit - 1) / bits_per_digit, '0');
  for (std::size_t k = 0; k < result.size(); ++k) {
    std::size_t value = 0;
    for (std::size_t i = bits_per_digit * k; i < bits_per_digit * (k + 1); ++i) {
      value = 2 * value + (i < cover.size() && cover[i] ? 1 : 0);
    }
    result[k] = digits[value];
  }
  return result;
}

std::optional<std::vector<bool>> cover_from(std::string_view text) {
  std::vector<bool> cover;
  std::size_t open = 1;
  for (const char digit : text) {
    const std::size_t value = digits.find(digit);
    if (value == std::string_view::npos || open == 0) return std::nullopt;
    for (std::size_t i = 0; i < bits_per_digit; ++i) {
      const bool bit = (value >> (bits_per_digit - 1 - i) & 1U) != 0;
      if (open == 0 && bit) return std::nullopt;
      if (open == 0) continue;
      cover.push_back(bit);
      open = bit ? open + 1 : open - 1;
    }
  }
  return open == 0 ? std::optional(cover) : std::nullopt;
}

bool is_whole_cover(const std::vector<bool>& cover) {
  std::size_t open = 1;
  for (const bool halved : cover) {
    if (open == 0) return false;
    open = halved ? open + 1 : open - 1;
  }
  return open == 0;
}

}  // namespace verisq
