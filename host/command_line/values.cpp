/// This file implements values.hpp.
#include "host/command_line/values.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <vector>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

std::optional<double> finite_number(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

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

std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::string_view names) {
  std::vector<double> numbers;
  std::string_view rest = text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    const auto number = finite_number(rest.substr(0, comma));
    if (!number) {
      const std::string_view part = rest.substr(0, comma);
      const bool blanks = part.find_first_of(" \t") != std::string_view::npos;
      refuse(fmt::format("{}: '{}' is not a finite number{}", option, part,
                         blanks ? ": commas without blanks separate numbers" : ""));
    }
    numbers.push_back(*number);
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  const auto needed = static_cast<std::size_t>(std::ranges::count(names, ',') + 1);
  if (numbers.size() != needed) {
    refuse(
        fmt::format("{}: {} numbers where {} are needed: {} (given: {})", option, numbers.size(), needed, names, text));
  }
  return numbers;
}

void refuse_choice(std::string_view option, std::string_view text, const std::vector<std::string_view>& words) {
  std::string list;
  for (const std::string_view word : words) list += fmt::format("{}{}", list.empty() ? "" : ", ", word);
  refuse(fmt::format("{}: {} is not one of {}", option, text, list));
}

NamedNumber parse_named_number(std::string_view option, const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) refuse(fmt::format("{}: {} is not NAME=NUMBER", option, text));
  const std::string whole = fmt::format("{} {}", option, text);
  return {text.substr(0, equals), parse_numbers(whole, text.substr(equals + 1), "NUMBER").front()};
}

NamedRange parse_named_range(std::string_view option, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse(fmt::format("{}: {} is not NAME=LO,HI", option, text));
  const std::string whole = fmt::format("{} {}", option, text);
  const std::vector<double> ends = parse_numbers(whole, text.substr(equals + 1), "LO,HI");
  if (ends[0] > ends[1]) refuse(fmt::format("{}: {} is above {}", whole, ends[0], ends[1]));
  return {text.substr(0, equals), {ends[0], ends[1]}};
}

double parse_length(std::string_view option, const std::string& text) {
  const std::optional<double> value = finite_number(text);
  if (!value || *value < 0.0) refuse(fmt::format("{}: {} is not a finite number of at least 0", option, text));
  return *value;
}

double parse_positive_length(std::string_view option, const std::string& text) {
  const double length = parse_length(option, text);
  if (length == 0.0) refuse(fmt::format("{}: {} is not above 0", option, text));
  return length;
}

Point parse_direction(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "x,y,z");
  const Point direction{numbers[0], numbers[1], numbers[2]};
  if (std::ranges::all_of(direction, [](double x) { return x == 0.0; })) {
    refuse(fmt::format("{}: {} is no direction", option, text));
  }
  return direction;
}

Plane parse_plane(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "x,y,z,nx,ny,nz");
  const Plane plane{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
  if (plane.normal == Point{}) refuse(fmt::format("{}: {} has a zero normal", option, text));
  return plane;
}

Pose parse_pose(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "tx,ty,tz,qw,qx,qy,qz");
  const Pose pose{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5], numbers[6]}};
  if (std::ranges::all_of(pose.quaternion, [](double q) { return q == 0.0; })) {
    refuse(fmt::format("{}: {} has a zero quaternion", option, text));
  }
  return pose;
}

std::string option_text(const Pose& pose) {
  const auto& [t, q] = pose;
  return fmt::format("{},{},{},{},{},{},{}", t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
}

double default_tolerance(const RelativeTolerance& relative, double radius, std::string_view owner) {
  const double tolerance = relative.value * radius;
  // An infinite tolerance would call every enclosure verified.
  if (!std::isfinite(tolerance)) refuse(fmt::format("--tol: give one, because the size of {} overflows", owner));
  return tolerance;
}

}  // namespace verisq::command_line
