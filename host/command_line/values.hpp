/// Values of options as typed: numbers, lengths, words, directions, planes, poses, and the default of --tol.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace verisq::command_line {

// Numbers in options, as typed.

/// The binary64 number nearest to `text`; nothing unless all of it is one finite number.
[[nodiscard]] std::optional<double> finite_number(std::string_view text);

// Options whose values are whole numbers: a message with the limits for any other value.

/// Decimal digits, leading zeros allowed. Throws Error(input) that begins with `option` unless `text` is a whole number
/// of at least `least` and at most `most`.
[[nodiscard]] std::uint64_t parse_whole_number(std::string_view option, std::string_view text, std::uint64_t least,
                                               std::uint64_t most);

/// The kind of option whose value lies between these limits, which are not negative.
template <std::integral Number>
[[nodiscard]] auto whole_number(Number least, Number most = std::numeric_limits<Number>::max()) {
  return [least, most](std::string_view option, std::string_view text) {
    return static_cast<Number>(
        parse_whole_number(option, text, static_cast<std::uint64_t>(least), static_cast<std::uint64_t>(most)));
  };
}

// Options whose value is a fixed count of numbers: "x,y,z".

/// The binary64 numbers nearest to those between the commas of `text`, as many as `names` ("x,y,z") has. Throws
/// Error(input) that begins with `option` for another count and for texts that are not finite numbers.
[[nodiscard]] std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::string_view names);

// Options whose value is one of a few words.

/// Throws Error(input): `text` is not one of `words`.
[[noreturn]] void refuse_choice(std::string_view option, std::string_view text,
                                const std::vector<std::string_view>& words);

template <class Value>
struct Choice {
  std::string_view word;
  Value value;
};

/// The kind of option whose words stand for these values; messages name the words in this order.
template <class Value>
[[nodiscard]] auto choice(std::initializer_list<Choice<Value>> choices) {
  return [choices = std::vector(choices)](std::string_view option, std::string_view text) {
    std::vector<std::string_view> words;
    for (const auto& [word, value] : choices) {
      if (word == text) return value;
      words.push_back(word);
    }
    refuse_choice(option, text, words);
  };
}

// Options whose value is a name and a number: "pelvis ty=0.98".

struct NamedNumber {
  std::string name;
  double number;
};

/// NAME=NUMBER. Throws Error(input) that begins with `option` for another form and for a text that is not a finite
/// number.
[[nodiscard]] NamedNumber parse_named_number(std::string_view option, const std::string& text);

// Options whose value is a name and two ends: "length_change=-2,1".

struct NamedRange {
  std::string name;
  Enclosure range;
};

/// NAME=LO,HI. Throws Error(input) that begins with `option` for another form, for a text that is not a finite number,
/// and if LO is above HI.
[[nodiscard]] NamedRange parse_named_range(std::string_view option, const std::string& text);

// Options whose values are lengths in model units: --tol, --point-radius.

/// The binary64 number nearest to `text`. Throws Error(input) that begins with `option` unless it is finite and at
/// least 0.
[[nodiscard]] double parse_length(std::string_view option, const std::string& text);

/// Like `parse_length`, but not 0.
[[nodiscard]] double parse_positive_length(std::string_view option, const std::string& text);

// Options whose value is a direction: --along, --up.

/// "x,y,z", each the nearest binary64, of any length but zero. Throws Error(input) that begins with `option` for
/// anything else.
[[nodiscard]] Point parse_direction(std::string_view option, const std::string& text);

// Options whose value is a plane: --resection.

/// "x,y,z,nx,ny,nz": a point and a normal of any length but zero. Throws Error(input) that begins with `option` for
/// anything else.
[[nodiscard]] Plane parse_plane(std::string_view option, const std::string& text);

// Options whose value is a pose: --pose, --pose-start.

/// "tx,ty,tz,qw,qx,qy,qz", each the nearest binary64. Throws Error(input) that begins with `option` for anything else,
/// for numbers that are not finite and for a zero quaternion.
[[nodiscard]] Pose parse_pose(std::string_view option, const std::string& text);

/// The text from which `parse_pose` reads the same bits.
[[nodiscard]] std::string option_text(const Pose& pose);

// The default of --tol: in proportion to the radius of a bounding sphere.

/// The text that the help prints, and its number.
struct RelativeTolerance {
  std::string_view text;
  double value;
};

/// For the distances of `map`, `fit` and `distance`.
inline constexpr RelativeTolerance tolerance_of_distances{"1e-6", 1e-6};
/// For `path`, if models are bent or built by set operations: halving it takes 1.4 times the moments.
inline constexpr RelativeTolerance tolerance_of_searched_paths{"1e-4", 1e-4};
/// For `insert`, whose every distance is searched along a whole way.
inline constexpr RelativeTolerance tolerance_along_ways{"1e-3", 1e-3};

/// Throws Error(input) that asks for a --tol if the radius is too large for a finite one. `owner` is the owner of the
/// radius, "the model".
[[nodiscard]] double default_tolerance(const RelativeTolerance& relative, double radius, std::string_view owner);

}  // namespace verisq::command_line
