/// Digits, compared as numbers of 64 bits where they are that short.
#include "host/command_line/whole_number.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

bool is_whole_number(std::string_view digits) {
  return !digits.empty() && std::ranges::all_of(digits, [](char c) { return '0' <= c && c <= '9'; });
}

std::string range(std::uint64_t least, std::uint64_t most, bool too_small) {
  const bool unbounded = most >= std::numeric_limits<std::int32_t>::max();  // by nothing but the type
  return unbounded && too_small ? fmt::format("at least {}", least) : fmt::format("in {} to {}", least, most);
}

}  // namespace

std::uint64_t parse_whole_number(std::string_view option, std::string_view text, std::uint64_t least,
                                 std::uint64_t most) {
  const auto refuse_unless = [&](bool right, const std::string& what) {
    if (!right) refuse(fmt::format("{}: {} is not {}", option, text, what));
  };
  const bool negative = text.starts_with('-');
  std::string_view digits = text;
  if (negative || text.starts_with('+')) digits.remove_prefix(1);
  refuse_unless(is_whole_number(digits), "a whole number " + range(least, most, false));
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool too_large = error != std::errc();  // for 64 bits
  const bool zero = number == 0 && !too_large;
  const bool within = !too_large && (zero || !negative) && least <= number && number <= most;
  refuse_unless(within, range(least, most, negative || zero));
  return number;
}

}  // namespace verisq::command_line
