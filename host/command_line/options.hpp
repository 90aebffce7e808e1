/// The options of a program and of its commands, and their values as typed. options.cpp alone includes CLI11.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace CLI {
class App;
}  // namespace CLI

namespace verisq::command_line {

/// The value of an option that may stand alone.
struct OptionalText {
  bool given = false;
  std::string text = {};  ///< empty if it stands alone
};

/// A handle: copies declare for the same command. The variables that options fill must live until `parse` returns. An
/// option's variable may be a T or a std::optional<T>; it keeps its value if the option is not given.
///
/// `names` are the names of one option, "--tol" or "-o,--output", or, without dashes, the name of a positional
/// argument. A kind of value is a function T(std::string_view option, const std::string& text) that throws
/// Error(input), beginning with `option`, for an invalid value: length, pose, choice, whole_number, ... Without a kind
/// the value is text. An empty text is refused for every kind.
class Options {
 public:
  /// The options of a program, which --help explains and whose --version prints `name` and `version`.
  Options(const std::string& name, const std::string& description, const std::string& version);

  /// The options of a command of this program.
  [[nodiscard]] Options command(const std::string& name, const std::string& description) const;

  /// "check".
  [[nodiscard]] std::string name() const;
  /// The name as typed: "verisq check".
  [[nodiscard]] std::string full_name() const;

  /// Adds, at the end of the help, an explanation that belongs to no single option.
  void explain(const std::string& closing_words);

  /// `value_name` stands for the value in the help, which `explanation` explains.
  template <class Value, class Kind>
  void add(const std::string& names, Value& value, Kind kind, const std::string& value_name,
           const std::string& explanation) {
    declare({names, value_name, explanation}, reader(names, value, std::move(kind)));
  }
  void add(const std::string& names, std::string& value, const std::string& value_name, const std::string& explanation);
  void add(const std::string& names, std::optional<std::string>& value, const std::string& value_name,
           const std::string& explanation);

  /// Like `add`, for a required option.
  void require(const std::string& names, std::string& value, const std::string& value_name,
               const std::string& explanation);

  /// Like `add`, for an option that may be repeated.
  template <class Value, class Kind>
  void add_each(const std::string& names, std::vector<Value>& values, Kind kind, const std::string& value_name,
                const std::string& explanation) {
    const auto append = [&values, kind = std::move(kind), option = first_name(names)](const std::string& text) {
      values.push_back(kind(option, text));
    };
    declare({.names = names, .value_name = value_name, .explanation = explanation, .repeatable = true}, append);
  }
  void add_each(const std::string& names, std::vector<std::string>& values, const std::string& value_name,
                const std::string& explanation);
  /// The same, at least once.
  void require_each(const std::string& names, std::vector<std::string>& values, const std::string& value_name,
                    const std::string& explanation);

  void add_flag(const std::string& names, bool& given, const std::string& explanation);

  /// A flag whose next word may be a value: without dashes, and none that a positional argument still waits for. An
  /// empty text is no value.
  void add_flag_or_text(const std::string& names, OptionalText& value, const std::string& value_name,
                        const std::string& explanation);

  /// Whatever follows the command goes into `arguments`, --help included; there are no other options.
  void take_all(std::vector<std::string>& arguments);

  /// For the program: fills the values, in the order of their declaration. False if --help or --version was given, and
  /// is answered on the standard output. Throws Error(input), for wrong arguments rather than for missing ones.
  [[nodiscard]] bool parse(int argc, char** argv) const;

  /// Returns whether this command was given. After `parse`.
  [[nodiscard]] bool given() const;

 private:
  struct Parser;

  struct Declaration {
    std::string names;
    std::string value_name;
    std::string explanation;
    bool required = false;
    bool repeatable = false;
  };

  using Reader = std::function<void(const std::string& text)>;

  Options(std::shared_ptr<Parser> parser, CLI::App* app) : parser_(std::move(parser)), app_(app) {}

  /// The name of the option in messages.
  [[nodiscard]] static std::string first_name(std::string_view names) {
    return std::string(names.substr(0, names.find(',')));
  }

  template <class Value, class Kind>
  [[nodiscard]] static Reader reader(const std::string& names, Value& value, Kind kind) {
    return [&value, kind = std::move(kind), option = first_name(names)](const std::string& text) {
      value = kind(option, text);
    };
  }

  void declare(const Declaration& declaration, Reader read);

  std::shared_ptr<Parser> parser_;
  CLI::App* app_;  ///< the program or one of its commands; owned by the parser
};

// The probable meaning of an unknown word.

/// The known word that is nearest to `word`: fewest letters inserted, left out, replaced or swapped with their
/// neighbours (optimal string alignment), at most one for every three letters of `word`. Else the only one that begins
/// with `word`, or with which `word` begins. Nothing if none is so near.
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known);

// Options that several commands have, with the same words for the same meaning.

/// A model file by the option `name`.
void require_model(Options& options, const std::string& name, std::string& file);

/// --tol of enclosures, 0 for the tightest. The default is in proportion to the bounding sphere of `owner`, "the
/// model".
void add_tolerance(Options& options, std::optional<double>& tolerance, std::string_view owner);

/// --device.
void add_device(Options& options, std::string& device);
inline constexpr const char* device_explanation =
    "auto (default), host (no OpenCL), or an index or part of a name from `verisq devices`";
/// For commands that compute rows.
inline constexpr const char* device_of_map_explanation =
    "auto (default: a device, for at most 128 rows the host), host (no OpenCL), or an index or part of a name\n"
    "from `verisq devices`";

/// The explanation of -o for a map.
inline constexpr const char* map_explanation = "The map, by extension: .csv .npy .vtp .ply .json";

/// --json, of a summary.
void add_json(Options& options, bool& json);
/// --json, of a summary with enclosures, whose ends may be infinite.
void add_json_of_enclosures(Options& options, bool& json);

/// --no-progress.
void add_no_progress(Options& options, bool& no_progress);

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
