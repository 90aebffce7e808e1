/// This file implements options.hpp.
#include "host/command_line/options.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

void refuse_if_empty(std::string_view option, std::string_view text) {
  if (text.empty()) refuse(fmt::format("{}: its value is empty", option));
}

/// CLI11 would take the next argument for the value of "--option=".
void refuse_empty_assignments(int argc, char** argv) {
  for (int i = 1; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string_view argument = argv[i];
    if (argument.starts_with("--") && argument.find('=') == argument.size() - 1) {
      refuse_if_empty(argument.substr(0, argument.size() - 1), "");
    }
  }
}

/// The command that was given, or the program.
const CLI::App& app_of(const CLI::App& program) {
  const auto given = program.get_subcommands();
  return given.empty() ? program : *given.front();
}

/// The words that `app` accepts: a word with dashes may be an option, another one a command.
std::vector<std::string> known_words(const CLI::App& app, bool with_dashes) {
  std::vector<std::string> words;
  if (with_dashes) {
    for (const CLI::Option* const option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
    }
  } else {
    for (const CLI::App* const command : app.get_subcommands({})) words.push_back(command->get_name());
  }
  return words;
}

/// "; did you mean map?", for the first unknown word, if a known one is near.
std::string suggestion(const CLI::App& program) {
  const std::vector<std::string> unknown = program.remaining(true);
  if (unknown.empty()) return "";
  const auto dashed = std::ranges::find_if(unknown, [](const std::string& word) { return word.starts_with("--"); });
  const std::string& given = dashed == unknown.end() ? unknown.front() : *dashed;
  const std::string word = given.substr(0, given.find('='));
  const auto near = nearest_word(word, known_words(app_of(program), word.starts_with("--")));
  return near ? fmt::format("; did you mean {}?", *near) : "";
}

/// "--model: give it once, not 2 times", of the first option that is there too often; empty where none is.
std::string repetition(const CLI::App& program) {
  for (const CLI::Option* const option : app_of(program).get_options())
    if (option->count() > 1 && option->get_items_expected_max() == 1)
      return fmt::format("{}: give it once, not {} times", option->get_name(), option->count());
  return "";
}

std::string text_value(std::string_view /*option*/, const std::string& text) {
  return text;
}

}  // namespace

struct Options::Parser {
  struct Waiting {
    const CLI::Option* option;
    std::string name;
    Reader read;
    bool may_be_empty = false;  // CLI11 gives an empty text for an option without its value
  };
  struct Forwarding {
    const CLI::App* command;
    std::vector<std::string>* arguments;
  };

  explicit Parser(const std::string& name, const std::string& description) : program(description, name) {}

  void read_all() const {
    for (const auto& [option, name, read, may_be_empty] : waiting) {
      for (const std::string& text : option->results()) {
        if (!may_be_empty) refuse_if_empty(name, text);
        read(text);
      }
    }
    for (const auto& [command, arguments] : forwardings) *arguments = command->remaining();
  }

  CLI::App program;
  std::vector<Waiting> waiting{};
  std::vector<Forwarding> forwardings{};
};

Options::Options(const std::string& name, const std::string& description, const std::string& version)
    : parser_(std::make_shared<Parser>(name, description)), app_(&parser_->program) {
  app_->set_version_flag("-V,--version", name + " " + version, "Print the version and exit");
}

Options Options::command(const std::string& name, const std::string& description) const {
  return {parser_, app_->add_subcommand(name, description)};
}

std::string Options::name() const {
  return app_->get_name();
}

std::string Options::full_name() const {
  const CLI::App* const program = app_->get_parent();
  return program == nullptr ? app_->get_name() : program->get_name() + " " + app_->get_name();
}

void Options::explain(const std::string& closing_words) {
  app_->footer(closing_words);
}

void Options::add(const std::string& names, std::string& value, const std::string& value_name,
                  const std::string& explanation) {
  add(names, value, text_value, value_name, explanation);
}

void Options::add(const std::string& names, std::optional<std::string>& value, const std::string& value_name,
                  const std::string& explanation) {
  add(names, value, text_value, value_name, explanation);
}

void Options::require(const std::string& names, std::string& value, const std::string& value_name,
                      const std::string& explanation) {
  declare({.names = names, .value_name = value_name, .explanation = explanation, .required = true},
          reader(names, value, text_value));
}

void Options::require_each(const std::string& names, std::vector<std::string>& values, const std::string& value_name,
                           const std::string& explanation) {
  declare({names, value_name, explanation, true, true}, [&values](const std::string& text) { values.push_back(text); });
}

void Options::add_each(const std::string& names, std::vector<std::string>& values, const std::string& value_name,
                       const std::string& explanation) {
  declare({.names = names, .value_name = value_name, .explanation = explanation, .repeatable = true},
          [&values](const std::string& text) { values.push_back(text); });
}

void Options::add_flag(const std::string& names, bool& given, const std::string& explanation) {
  app_->add_flag(names, given, explanation);
}

void Options::add_flag_or_text(const std::string& names, OptionalText& value, const std::string& value_name,
                               const std::string& explanation) {
  CLI::Option* const option = app_->add_option(names, CLI::callback_t(), explanation);
  option->option_text("[" + value_name + "]")->expected(0, 1);
  const auto read = [&value](const std::string& text) { value = {true, text}; };
  parser_->waiting.push_back({option, first_name(names), read, true});
}

void Options::take_all(std::vector<std::string>& arguments) {
  app_->prefix_command();
  app_->set_help_flag();
  parser_->forwardings.push_back({app_, &arguments});
}

bool Options::parse(int argc, char** argv) const {
  refuse_empty_assignments(argc, argv);
  CLI::App& program = parser_->program;
  const auto refuse_usage = [&program](const CLI::ParseError& error) {
    const std::string repeated = repetition(program);
    if (!repeated.empty()) refuse(repeated);
    const std::string near = dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr ? "" : suggestion(program);
    refuse(fmt::format("{}{} (see {} --help)", error.what(), near, program.get_name()));
  };
  try {
    program.parse(argc, argv);
  } catch (const CLI::RequiredError& error) {
    parser_->read_all();  // what is wrong is told before what is missing
    if (!suggestion(program).empty()) refuse_usage(CLI::ExtrasError(program.remaining(true)));
    refuse_usage(error);
  } catch (const CLI::ParseError& error) {
    // `--help` and `--version` arrive as errors of status 0, whose text CLI11 prints.
    if (error.get_exit_code() == 0) {
      program.exit(error);
      return false;
    }
    refuse_usage(error);
  }
  parser_->read_all();
  return true;
}

bool Options::given() const {
  return app_->parsed();
}

void Options::declare(const Declaration& declaration, Reader read) {
  CLI::Option* const option = app_->add_option(declaration.names, CLI::callback_t(), declaration.explanation);
  option->type_name(declaration.value_name)->required(declaration.required);
  option->option_text(declaration.value_name + (declaration.required ? " REQUIRED" : ""));
  if (declaration.repeatable) {
    // One value a name; a positional argument has no other way to be given again.
    const bool positional = !declaration.names.starts_with('-');
    option->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(positional);
  }
  parser_->waiting.push_back({option, first_name(declaration.names), std::move(read), false});
}

namespace {

/// Corrections between the first i letters of `a` and the first j of `b`, row after row.
std::size_t corrections(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

/// Dashes are no letters.
std::string_view letters_of(std::string_view word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

}  // namespace

std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known) {
  const std::string_view letters = letters_of(word);
  if (letters.size() < 2) return std::nullopt;
  std::optional<std::string> nearest;
  std::size_t fewest = std::max<std::size_t>(letters.size() / 3, 1) + 1;
  std::vector<std::string> begun;
  for (const std::string& candidate : known) {
    const std::string_view other = letters_of(candidate);
    if (other.size() < 2) continue;
    if (const std::size_t count = corrections(letters, other); count < fewest) {
      fewest = count;
      nearest = candidate;
    }
    if (other.starts_with(letters) || letters.starts_with(other)) begun.push_back(candidate);
  }
  if (!nearest && begun.size() == 1) return begun.front();
  return nearest;
}

void require_model(Options& options, const std::string& name, std::string& file) {
  options.require(name, file, "FILE", "Model of posed superquadrics (verisq-model/1, JSON)");
}

void add_tolerance(Options& options, std::optional<double>& tolerance, std::string_view owner) {
  options.add("--tol", tolerance, parse_length, "NUMBER",
              fmt::format("Largest width of a verified enclosure, in model units; 0 asks for the tightest.\n"
                          "Default: {} times the radius of {}'s bounding sphere",
                          tolerance_of_distances.text, owner));
}

void add_device(Options& options, std::string& device) {
  options.add("--device", device, "DEVICE", device_explanation);
}

void add_json(Options& options, bool& json) {
  options.add_flag("--json", json, "Print the summary as one JSON object");
}

void add_json_of_enclosures(Options& options, bool& json) {
  options.add_flag("--json", json, "Print the summary as one JSON object; what is not bounded is null");
}

void add_no_progress(Options& options, bool& no_progress) {
  options.add_flag("--no-progress", no_progress, "No progress bar, even on a terminal");
}

// Values of options.

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
