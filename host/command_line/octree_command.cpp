/// `verisq octree`: cubes proven inside and outside a model, and its volume between two bounds.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <verisq/model.hpp>
#include <verisq/octree.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/words.hpp"

namespace verisq::command_line {
namespace {

// Options whose values are sizes of files: --max-output.

// The summary of an octree on the standard output: for people, or as one JSON object.

struct OctreeReport {
  OctreeSummary summary;
  std::string output;               ///< the file that holds the cubes; empty when none was written
  std::uint64_t output_bytes;       ///< its size, written or not; 0 if it is not known
  std::string units;                ///< of the model; empty when not given
  std::optional<double> tolerance;  ///< tolerance of the volume, if one was given
};

/// As typed; `run_octree` checks what depends on the file or on several options.
struct OctreeArguments {
  std::string model;
  std::optional<Pose> pose;
  std::optional<int> depth;
  std::optional<double> tolerance;  ///< tolerance of the volume
  std::optional<std::size_t> budget;
  std::string device = "auto";
  std::string output;
  std::string max_output = "1GiB";  ///< text, which messages repeat
  bool white = false;
  std::optional<double> time_limit;  ///< in seconds
  bool json = false;
  bool no_progress = false;
};

struct Unit {
  std::string_view name;
  double bytes;
};

constexpr std::array units{Unit{"", 1.0},       Unit{"b", 1.0},     Unit{"kb", 1e3},     Unit{"mb", 1e6},
                           Unit{"gb", 1e9},     Unit{"tb", 1e12},   Unit{"kib", 0x1p10}, Unit{"mib", 0x1p20},
                           Unit{"gib", 0x1p30}, Unit{"tib", 0x1p40}};

/// Bytes: "500000", "250MB" or "1.5 GiB"; units kB, MB, GB, TB are powers of 1000, KiB, MiB, GiB, TiB of 1024, in
/// capitals or not. Throws Error(input) that begins with `option` for anything else, and for sizes of 2^63 bytes and
/// more.
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

/// "2.95 GB": three digits, in powers of 1000.
std::string byte_size_text(std::uint64_t bytes) {
  const std::string number = with_prefix(static_cast<double>(bytes));
  const bool has_prefix = number.back() < '0' || number.back() > '9';
  const std::size_t digits = number.size() - (has_prefix ? 1 : 0);
  return fmt::format("{} {}B", number.substr(0, digits), number.substr(digits));
}

std::string table(const OctreeReport& report) {
  const OctreeSummary& summary = report.summary;
  std::string text = fmt::format("{:<8}{:>14}{:>14}{:>14}{:>14}\n", "level", "edge", "inside", "undecided", "outside");
  for (std::size_t level = 0; level < summary.levels.size(); ++level) {
    const auto& [black, white, gray] = summary.levels[level];
    text += fmt::format("{:<8}{:>14.6g}{:>14}{:>14}{:>14}\n", level, edge(summary.root, static_cast<int>(level)), black,
                        gray, white);
  }
  return text;
}

double cubes_per_second(const OctreeSummary& summary) {
  return summary.seconds > 0.0 ? static_cast<double>(summary.coloured) / summary.seconds : 0.0;
}

/// Ends of enclosures are rounded outward to the digits printed.
std::string readable(const OctreeReport& report) {
  const OctreeSummary& summary = report.summary;
  const std::string cubic_units = units_behind(report.units, 3);
  std::string text = table(report);
  text += fmt::format("volume             [{}, {}]{}\n", lower_digits(summary.volume.lo),
                      upper_digits(summary.volume.hi), cubic_units);
  text += fmt::format("undecided volume   {:.3g}{}\n", summary.volume.width(), cubic_units);
  if (report.tolerance) text += fmt::format("tolerance          {:.3g}{}\n", *report.tolerance, cubic_units);
  text += fmt::format("device             {}\n", quotation(summary.device));
  text += fmt::format("time               {:.3g} s (device {:.3g} s), {} cubes/s\n", summary.seconds,
                      summary.device_seconds, with_prefix(cubes_per_second(summary)));
  const std::string size = report.output_bytes > 0 ? byte_size_text(report.output_bytes) : "";
  if (report.output.empty())
    return text + "octree             not written" + (size.empty() ? "" : " (" + size + ")") + "\n";
  return text + fmt::format("octree             {}{}{}\n", size, size.empty() ? "" : ", ", quotation(report.output));
}

/// One line.
std::string json(const OctreeReport& report) {
  const OctreeSummary& summary = report.summary;
  JsonValue::Array levels;
  for (std::size_t level = 0; level < summary.levels.size(); ++level) {
    const auto& [black, white, gray] = summary.levels[level];
    levels.push_back(JsonObject{{"level", level},
                                {"edge", edge(summary.root, static_cast<int>(level))},
                                {"inside", black},
                                {"undecided", gray},
                                {"outside", white}});
  }
  const JsonObject object{
      {"volume", summary.volume},
      {"units", report.units},
      {"tolerance", report.tolerance},
      {"depth", summary.levels.size() - 1},
      {"levels", levels},
      {"root", JsonObject{{"centre", summary.root.centre}, {"half_width", summary.root.half_width}}},
      {"coloured", summary.coloured},
      {"budget_hit", summary.budget_hit},
      {"interrupted", summary.interrupted},
      {"device", summary.device},
      {"notice", summary.notice},
      {"device_seconds", summary.device_seconds},
      {"seconds", summary.seconds},
      {"cubes_per_second", cubes_per_second(summary)},
      {"output", report.output},
      {"output_bytes", report.output_bytes},
  };
  return object.text() + "\n";
}

constexpr const char* closing_words =
    "Every cube of OUT.vtu is proven: colour 2 (black) lies inside the model, 0 (white) outside; 1 (gray) is "
    "undecided.\n"
    "The volume of the model lies between that of the black cubes and that of the black and gray ones together, which\n"
    "are exact: the cubes' corners and volumes are binary64 numbers. Each level about halves what is undecided.\n"
    "Eight siblings of one colour are written as their parent. An OUT.vtu larger than --max-output is not written: "
    "the\n"
    "volume is printed all the same.\n"
    "Where the budget is hit, the cubes there is no room for stay gray: the octree is coarser, and valid. Ctrl-C "
    "prints\n"
    "the volume proven so far, and writes no file; a second Ctrl-C stops at once.\n"
    "\n"
    "Exit status: 0 the depth is reached, or the volume is enclosed to the tolerance; 3 the octree is valid, but the\n"
    "budget or --time-limit ended it sooner; 2 bad usage or input, or a file above --max-output; 130 interrupted by "
    "Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq octree --model stem.json -o stem.vtu\n"
    "  verisq octree --model stem.json --tol 50 -o stem.vtu --json";

OctreeOptions options_of(const OctreeArguments& arguments, const Deadline& limit) {
  OctreeOptions options;
  if (arguments.depth && arguments.tolerance) refuse("give either --depth or --tol");
  if (arguments.depth) options.depth = *arguments.depth;
  if (arguments.tolerance) {
    options.tolerance = *arguments.tolerance;
    options.depth = deepest_octree_level;
  }
  if (arguments.budget) options.budget = *arguments.budget;
  options.device = arguments.device;
  options.interrupted = limit.stop();
  return options;
}

/// Returns whether the octree reached the depth or tolerance that the user requested.
bool complete(const OctreeSummary& summary, const std::optional<double>& tolerance) {
  return !summary.budget_hit && (!tolerance || verified(summary.volume, *tolerance));
}

void explain(const OctreeSummary& summary, bool is_complete, const std::string& output) {
  tell_notice(summary.notice);
  if (summary.interrupted) tell(fmt::format("{}; {} is not written", reason_of_end(), output));
  if (summary.budget_hit) {
    tell(fmt::format("the budget is hit at level {}: the octree is valid, but coarser; give a larger --budget",
                     summary.levels.size() - 1));
  } else if (!is_complete && !summary.interrupted) {
    tell(fmt::format("the tolerance is not reached at level {}, the deepest", deepest_octree_level));
  }
}

void declare_octree(Options& options, OctreeArguments& arguments) {
  options.explain(closing_words);
  require_model(options, "--model", arguments.model);
  add_pose(options, arguments.pose);
  options.add("--depth", arguments.depth, whole_number(0, deepest_octree_level), "LEVEL",
              "Split cubes up to this level: 0 to 20 (default 7)");
  options.add("--tol", arguments.tolerance, parse_length, "NUMBER",
              "Instead of --depth: stop when the enclosure of the volume is at most this wide, in cubic model units");
  options.add("--budget", arguments.budget, whole_number<std::size_t>(1), "CUBES",
              "Largest number of undecided cubes of a level: bounds the memory (default 4194304)");
  add_device(options, arguments.device);
  options.require("-o,--output", arguments.output, "FILE", "The cubes: .vtu, with cell data colour and level");
  options.add("--max-output", arguments.max_output, "SIZE",
              "Largest OUT.vtu that is written, like 500MB or 4GiB (default 1GiB); its size is known before");
  options.add_flag("--white", arguments.white, "Write the white cubes too");
  add_time_limit(options, arguments.time_limit, "the volume proven by then is printed, and no file is written");
  add_json(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_octree(const OctreeArguments& arguments) {
  Deadline limit(arguments.time_limit, interrupted);
  OctreeOptions options = options_of(arguments, limit);
  const std::uint64_t most_bytes = parse_byte_size("--max-output", arguments.max_output);
  refuse_to_overwrite("-o", arguments.output, {arguments.model});
  const Model model = read_model_at(arguments.pose, arguments.model);
  watch_for_interruption();
  limit.start();
  OctreeWriter writer(arguments.output, arguments.white ? WhiteCubes::written : WhiteCubes::left_out);

  std::optional<ProgressBar> bar;  // begins at the first cubes: compiling kernels is no part of the rate
  std::uint64_t coloured = 0;
  options.progress = [&, before = std::size_t{0}](int /*level*/, std::size_t done, std::size_t undecided) mutable {
    if (!bar) bar.emplace(!arguments.no_progress, "cubes");
    if (done < before) before = 0;
    coloured += 8 * (done - before);
    before = done == undecided ? 0 : done;
    bar->update(coloured, static_cast<double>(done) / static_cast<double>(undecided));
  };
  OctreeBuilder builder(model, options);
  const OctreeSummary summary = builder.build([&](std::span<const OctreeCube> cubes) { writer.append(cubes); });
  bar.reset();  // the line is cleared before anything else is said

  const std::uint64_t bytes = summary.interrupted ? 0 : writer.bytes();
  const bool too_large = bytes > most_bytes;
  const bool written = !summary.interrupted && !too_large;
  if (written) writer.finish(summary.root);
  const bool is_complete = complete(summary, arguments.tolerance);
  explain(summary, is_complete, arguments.output);
  const OctreeReport report{.summary = summary,
                            .output = written ? arguments.output : "",
                            .output_bytes = bytes,
                            .units = model.units,
                            .tolerance = arguments.tolerance};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (summary.interrupted) return status_of_end();
  if (too_large) {
    // After the volume, which took the time and is proven.
    std::fflush(stdout);
    refuse(
        fmt::format("--max-output: {} is not written: its {} are more than {}; give a larger one, or a smaller "
                    "--depth or larger --tol",
                    arguments.output, byte_size_text(bytes), arguments.max_output));
  }
  return is_complete ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace

Command octree_command() {
  return command("octree", "Prove cubes inside and outside a model, and enclose its volume", declare_octree,
                 run_octree);
}

}  // namespace verisq::command_line
