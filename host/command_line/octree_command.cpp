/// Reads the options and the model of `verisq octree`, grows the octree, writes it, reports.
#include "host/command_line/octree_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <verisq/error.hpp>
#include <verisq/model_file.hpp>
#include <verisq/octree_file.hpp>

#include "host/command_line/byte_size.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/map_to_file.hpp"
#include "host/command_line/octree_summary.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/whole_number.hpp"

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

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

OctreeOptions options_of(const OctreeArguments& arguments) {
  OctreeOptions options;
  if (arguments.depth && arguments.tolerance) refuse("give either --depth or --tol");
  if (arguments.depth) options.depth = *arguments.depth;
  if (arguments.tolerance) {
    options.tolerance = parse_length("--tol", *arguments.tolerance);
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
  if (!summary.notice.empty()) fmt::print(stderr, "verisq: {}\n", summary.notice);
  if (summary.interrupted) fmt::print(stderr, "verisq: interrupted; {} is not written\n", output);
  if (summary.budget_hit) {
    fmt::print(stderr,
               "verisq: the budget is hit at level {}: the octree is valid, but coarser; give a larger --budget\n",
               summary.levels.size() - 1);
  } else if (!is_complete && !summary.interrupted) {
    fmt::print(stderr, "verisq: the tolerance is not reached at level {}, the deepest\n", deepest_octree_level);
  }
}

}  // namespace

const CLI::App& declare_octree(CLI::App& program, OctreeArguments& arguments) {
  CLI::App& octree =
      *program.add_subcommand("octree", "Prove cubes inside and outside a model, and enclose its volume");
  octree.footer(closing_words);
  octree.add_option("--model", arguments.model, "Model of posed superquadrics (verisq-model/1, JSON)")
      ->required()
      ->option_text("FILE REQUIRED");
  octree.add_option("--depth", arguments.depth, "Split cubes up to this level: 0 to 20 (default 7)")
      ->transform(whole_number("--depth", 0, deepest_octree_level))
      ->option_text("LEVEL");
  octree
      .add_option(
          "--tol", arguments.tolerance,
          "Instead of --depth: stop when the enclosure of the volume is at most this wide, in cubic model units")
      ->option_text("NUMBER");
  octree
      .add_option("--budget", arguments.budget,
                  "Largest number of undecided cubes of a level: bounds the memory (default 4194304)")
      ->transform(whole_number("--budget", 1))
      ->option_text("CUBES");
  octree
      .add_option("--device", arguments.device,
                  "auto (default), host (no OpenCL), or an index or part of a name from `verisq devices`")
      ->option_text("DEVICE");
  octree.add_option("-o,--output", arguments.output, "The cubes: .vtu, with cell data colour and level")
      ->required()
      ->option_text("FILE REQUIRED");
  octree
      .add_option("--max-output", arguments.max_output,
                  "Largest OUT.vtu that is written, like 500MB or 4GiB (default 1GiB); its size is known before")
      ->option_text("SIZE");
  octree.add_flag("--white", arguments.white, "Write the white cubes too");
  octree.add_flag("--json", arguments.json, "Print the summary as one JSON object");
  octree.add_flag("--no-progress", arguments.no_progress, "No progress bar, even on a terminal");
  return octree;
}

ExitStatus run_octree(const OctreeArguments& arguments) {
  OctreeOptions options = options_of(arguments);
  const std::uint64_t most_bytes = parse_byte_size("--max-output", arguments.max_output);
  refuse_to_overwrite(arguments.output, {arguments.model});
  const Model model = read_model(arguments.model);
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
  std::optional<double> tolerance;
  if (arguments.tolerance) tolerance = options.tolerance;
  const bool is_complete = complete(summary, tolerance);
  explain(summary, is_complete, arguments.output);
  const OctreeReport report{.summary = summary,
                            .output = written ? arguments.output : "",
                            .output_bytes = bytes,
                            .units = model.units,
                            .tolerance = tolerance};
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
