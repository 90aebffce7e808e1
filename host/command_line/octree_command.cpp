/// Reads the options and the model of `verisq octree`, grows the octree, writes it, reports.
#include "host/command_line/octree_command.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <verisq/octree_file.hpp>

#include "host/command_line/byte_size.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/octree_summary.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/whole_number.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

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
    "budget ended it sooner; 2 bad usage or input, or a file above --max-output; 130 interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq octree --model stem.json -o stem.vtu\n"
    "  verisq octree --model stem.json --tol 50 -o stem.vtu --json";

OctreeOptions options_of(const OctreeArguments& arguments) {
  OctreeOptions options;
  if (arguments.depth && arguments.tolerance) refuse("give either --depth or --tol");
  if (arguments.depth) options.depth = *arguments.depth;
  if (arguments.tolerance) {
    options.tolerance = *arguments.tolerance;
    options.depth = deepest_octree_level;
  }
  if (arguments.budget) options.budget = *arguments.budget;
  options.device = arguments.device;
  options.interrupted = interrupted;
  return options;
}

/// Whether the octree stopped where the user asked it to.
bool complete(const OctreeSummary& summary, const std::optional<double>& tolerance) {
  return !summary.budget_hit && (!tolerance || verified(summary.volume, *tolerance));
}

void explain(const OctreeSummary& summary, bool is_complete, const std::string& output) {
  tell_notice(summary.notice);
  if (summary.interrupted) tell(fmt::format("interrupted; {} is not written", output));
  if (summary.budget_hit) {
    tell(fmt::format("the budget is hit at level {}: the octree is valid, but coarser; give a larger --budget",
                     summary.levels.size() - 1));
  } else if (!is_complete && !summary.interrupted) {
    tell(fmt::format("the tolerance is not reached at level {}, the deepest", deepest_octree_level));
  }
}

}  // namespace

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
  add_json(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_octree(const OctreeArguments& arguments) {
  OctreeOptions options = options_of(arguments);
  const std::uint64_t most_bytes = parse_byte_size("--max-output", arguments.max_output);
  refuse_to_overwrite("-o", arguments.output, {arguments.model});
  const Model model = read_model_at(arguments.pose, arguments.model);
  watch_for_interruption();
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
  if (summary.interrupted) return ExitStatus::interrupted;
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

}  // namespace verisq::command_line
