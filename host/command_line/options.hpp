/// The options of a program and of its commands: declared by kind, parsed by CLI11, which options.cpp alone includes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

}  // namespace verisq::command_line
