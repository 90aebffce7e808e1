/// Digits, compared as numbers of 64 bits where they are that short.
#include "host/command_line/whole_number.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>
#include <verisq/error.hpp>

namespace verisq::command_line {
namespace {

bool is_whole_number(std::string_view digits) {
  return !digits.empty() && std::ranges::all_of(digits, [](char c) { return '0' <= c && c <= '9'; });
}

/// Without leading zeros. Precondition: digits.
std::string_view shortest(std::string_view digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string_view::npos ? "0" : digits.substr(first);
}

/// Whether -digits or digits lies between them. Precondition: digits without leading zeros.
bool is_between(std::int64_t least, std::uint64_t most, bool negative, std::string_view digits) {
  std::uint64_t magnitude = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), magnitude);
  if (error != std::errc()) return false;
  if (!negative || magnitude == 0) return magnitude <= most && (least <= 0 || magnitude >= std::uint64_t(least));
  return least < 0 && magnitude <= std::uint64_t(0) - std::uint64_t(least);
}

std::string range(std::int64_t least, std::uint64_t most, bool too_small) {
  const bool unbounded = most >= std::numeric_limits<std::int32_t>::max();  // by nothing but the type
  return unbounded && too_small ? fmt::format("at least {}", least) : fmt::format("in {} to {}", least, most);
}

}  // namespace

CLI::Validator whole_number(std::string option, std::int64_t least, std::uint64_t most) {
  return {[option = std::move(option), least, most](std::string& text) -> std::string {
            const auto refuse = [&](const std::string& what) {
              throw Error(ErrorKind::input, fmt::format("{}: {} is not {}", option, text, what));
            };
            const bool negative = text.starts_with('-');
            std::string_view digits = text;
            if (negative || text.starts_with('+')) digits.remove_prefix(1);
            if (!is_whole_number(digits)) refuse("a whole number " + range(least, most, false));
            digits = shortest(digits);
            const bool too_small = negative || digits == "0";
            if (!is_between(least, most, negative, digits)) refuse(range(least, most, too_small));
            text = fmt::format("{}{}", negative && digits != "0" ? "-" : "", digits);
            return {};
          },
          ""};
}

}  // namespace verisq::command_line
