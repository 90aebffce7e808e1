/// A number and a unit behind it.
#include "host/command_line/byte_size.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "host/command_line/finite_number.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/words.hpp"

namespace verisq::command_line {
namespace {

struct Unit {
  std::string_view name;
  double bytes;
};

constexpr std::array units{Unit{"", 1.0},       Unit{"b", 1.0},     Unit{"kb", 1e3},     Unit{"mb", 1e6},
                           Unit{"gb", 1e9},     Unit{"tb", 1e12},   Unit{"kib", 0x1p10}, Unit{"mib", 0x1p20},
                           Unit{"gib", 0x1p30}, Unit{"tib", 0x1p40}};

}  // namespace

std::uint64_t parse_byte_size(std::string_view option, std::string_view text) {
  const std::size_t end = text.find_last_of("0123456789.") + 1;  // 0 where there is none
  std::string_view name = text.substr(end);
  name.remove_prefix(std::min(name.find_first_not_of(' '), name.size()));
  const auto* const unit = std::ranges::find(units, lower_case(std::string(name)), &Unit::name);
  const std::optional<double> number = finite_number(text.substr(0, end));
  const double bytes = number && unit != units.end() ? *number * unit->bytes : -1.0;
  if (!(bytes >= 0.0 && bytes < 0x1p63)) refuse(fmt::format("{}: {} is not a size like 500MB or 4GiB", option, text));
  return static_cast<std::uint64_t>(bytes);
}

std::string byte_size_text(std::uint64_t bytes) {
  const std::string number = with_prefix(static_cast<double>(bytes));
  const bool has_prefix = number.back() < '0' || number.back() > '9';
  const std::size_t digits = number.size() - (has_prefix ? 1 : 0);
  return fmt::format("{} {}B", number.substr(0, digits), number.substr(digits));
}

}  // namespace verisq::command_line
