/// Reads the manifest, has its cases run, writes the tables.
#include "host/command_line/batch_command.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <vector>

#include "host/command_line/batch_manifest.hpp"
#include "host/command_line/batch_run.hpp"
#include "host/command_line/batch_tables.hpp"
#include "host/command_line/directed_digits.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/whole_number.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The manifest is CSV: a header, and a row for each case. Columns are `case`, a name of its own; `command`, any "
    "command\n"
    "with --json (if absent or empty: map); and options of the commands by their long names without dashes, such as\n"
    "`model`, `mesh`, `points`, `pose`, `tol`; `a` and `b` are the models of distance and path. A field may stand in\n"
    "double quotes. An empty field, or no, leaves the option out; yes gives it without a value. Files are those of "
    "the\n"
    "manifest's folder.\n"
    "DIR gets summary.csv, summary.json and overview.html; cases/CASE.json, what each case said; maps/CASE.npy, the "
    "rows\n"
    "of maps, where no column `output` says another; logs/CASE.err, what it told. Each case is a process of its own:\n"
    "what fails is listed, and stops no other. The same command once more goes on where an interrupted or killed run\n"
    "stopped: cases with the same arguments, of the same files (SHA-256), are taken over; failed ones are tried "
    "again.\n"
    "\n"
    "Exit status: 0 every case verified, 3 some are wide or failed, 2 bad usage or manifest, 130 interrupted by "
    "Ctrl-C,\n"
    "143 by SIGTERM, 129 by SIGHUP.\n"
    "\n"
    "Example:\n"
    "  verisq batch cohort.csv -o cohort";

constexpr std::size_t most_jobs = 4096;
constexpr std::size_t most_failures_shown = 10;

std::string readable(const std::vector<BatchCase>& cases, const BatchRun& run, const BatchArguments& arguments) {
  const BatchTotals totals = totals_of(run.results);
  std::string text = fmt::format("cases              {}\n", cases.size());
  text += fmt::format("  verified         {}\n", totals.verified);
  text += fmt::format("  wide             {}\n", totals.wide);
  text += fmt::format("  failed           {}\n", totals.failed);
  if (totals.not_run > 0) text += fmt::format("  not run          {}\n", totals.not_run);
  if (run.taken_over > 0) text += fmt::format("taken over         {} of an earlier run\n", run.taken_over);
  std::size_t shown = 0;
  for (std::size_t i = 0; i < cases.size() && shown < most_failures_shown; ++i) {
    if (run.results[i].outcome != CaseOutcome::failed) continue;
    text += fmt::format("failed             {}: {}\n", cases[i].name, run.results[i].message);
    ++shown;
  }
  if (totals.failed > shown) text += fmt::format("                   and {} more\n", totals.failed - shown);
  if (totals.nearest) {
    text += fmt::format("nearest            {}: smallest distance {}\n", cases[*totals.nearest].name,
                        outward_digits(*run.results[*totals.nearest].smallest));
  }
  return text +
         fmt::format("tables             {0}/summary.csv, {0}/summary.json, {0}/overview.html\n", arguments.output);
}

}  // namespace

void declare_cohort(Options& options, BatchArguments& arguments) {
  options.require("MANIFEST", arguments.manifest, "MANIFEST.csv", "The cases, a row each");
  options.require("-o,--output", arguments.output, "DIR", "The folder of the results");
  options.add_flag("--json", arguments.json, "Print the summary of all cases as one JSON object");
  add_no_progress(options, arguments.no_progress);
}

void declare_batch(Options& options, BatchArguments& arguments) {
  options.explain(closing_words);
  declare_cohort(options, arguments);
  options.add("--jobs", arguments.jobs, whole_number<std::size_t>(1, most_jobs), "N",
              "How many cases at a time (default 1: a case uses all processors)");
}

BatchFolders folders_of(const BatchArguments& arguments) {
  return {std::filesystem::absolute(arguments.manifest).parent_path(), arguments.output};
}

ExitStatus conclude(const BatchArguments& arguments, const std::vector<BatchCase>& cases, const BatchRun& run) {
  const std::filesystem::path folder = arguments.output;
  const std::string json = json_table(cases, run.results, run.interrupted);
  write_csv_table(folder / "summary.csv", cases, run.results);
  write_json_table(folder / "summary.json", json);
  write_page(folder / "overview.html", std::filesystem::path(arguments.manifest).stem().string(), cases, run.results);
  const BatchTotals totals = totals_of(run.results);
  if (run.interrupted) {
    tell(fmt::format("interrupted; {} of {} cases are done, and the same command goes on",
                     cases.size() - totals.not_run, cases.size()));
  }
  fmt::print("{}", arguments.json ? json : readable(cases, run, arguments));
  if (run.interrupted) return ExitStatus::interrupted;
  return totals.wide + totals.failed > 0 ? ExitStatus::unverified : ExitStatus::verified;
}

ExitStatus run_batch_command(const BatchArguments& arguments) {
  const std::vector<BatchCase> cases = read_manifest(arguments.manifest);
  watch_for_interruption();
  BatchRun run;
  {
    ProgressBar bar(!arguments.no_progress, "cases");
    run = run_batch(cases, folders_of(arguments),
                    {.jobs = arguments.jobs, .progress = [&](std::size_t done) {
                       bar.update(done, static_cast<double>(done) / static_cast<double>(cases.size()));
                     }});
  }
  return conclude(arguments, cases, run);
}

}  // namespace verisq::command_line
