/// Ranks take cases from a counter; rank 0 gathers what became of them.
#include "host/command_line/shared_batch_command.hpp"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/command_line/interruption.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The manifest, and what DIR gets, are those of `verisq batch`:\n"
    "  mpirun -n 16 verisq-mpi batch cohort.csv -o cohort\n"
    "A rank runs one case at a time, of any command, by the program verisq that lies beside this one; ranks take "
    "cases\n"
    "from a counter, so that none waits for another. DIR and the files of the cases have to be on a file system that\n"
    "all ranks see. A case takes the processors, and the devices, that its rank may use: let the queue bind them\n"
    "(srun --gpus-per-task=1; mpirun --map-by node:PE=8). The tables are those of one process.\n"
    "Where a rank dies, MPI ends the job; the same command once more, with any number of ranks or by `verisq batch`,\n"
    "takes over what is finished.\n"
    "\n"
    "Exit status: that of `verisq batch`.";

std::filesystem::path program_beside_this_one() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "verisq";
}

/// A line for each case that this rank has run.
std::string text_of(const BatchRun& run) {
  std::string text;
  for (std::size_t place = 0; place < run.results.size(); ++place) {
    if (run.results[place].outcome == CaseOutcome::not_run) continue;
    text += fmt::format("{} {}\n", place, text_of(run.results[place]));
  }
  return text;
}

/// Precondition: a text of `text_of`.
void add(std::string_view text, BatchRun& run) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(line.size() + 1);
    const std::size_t space = line.find(' ');
    std::size_t place = 0;
    std::from_chars(line.data(), line.data() + space, place);
    run.results.at(place) = result_from(line.substr(space + 1));
  }
}

/// Of all ranks, at rank 0.
BatchRun gathered(const BatchRun& own, const mpi::Session& session) {
  BatchRun all{.results = std::vector<CaseResult>(own.results.size())};
  for (const std::string& text : session.gathered(text_of(own))) add(text, all);
  all.taken_over = static_cast<std::size_t>(session.sum(static_cast<double>(own.taken_over)));
  all.interrupted = session.largest(own.interrupted ? 1 : 0) != 0;
  return all;
}

BatchRun run_own(const BatchArguments& arguments, const std::vector<BatchCase>& cases, const mpi::Session& session) {
  mpi::Counter counter;
  ProgressBar bar(!arguments.no_progress && session.rank() == 0, "cases");
  std::uint64_t begun = 0;  // by all ranks, as far as this one knows
  const auto next = [&]() -> std::optional<std::size_t> {
    begun = counter.next();
    return begun < cases.size() ? std::optional<std::size_t>(begun) : std::nullopt;
  };
  const auto show = [&](std::size_t) {
    bar.update(begun, static_cast<double>(begun) / static_cast<double>(cases.size()));
  };
  return run_batch(cases, folders_of(arguments),
                   {.jobs = 1, .program = program_beside_this_one(), .next = next, .progress = show});
}

}  // namespace

void declare_shared_batch(Options& options, BatchArguments& arguments) {
  options.explain(closing_words);
  declare_cohort(options, arguments);
}

ExitStatus run_shared_batch(const BatchArguments& arguments, const mpi::Session& session) {
  const std::vector<BatchCase> cases = read_manifest(arguments.manifest);
  if (const auto program = program_beside_this_one(); !std::filesystem::exists(program))
    refuse(fmt::format("{}: is not there: it runs the cases", program.string()));
  watch_for_interruption();
  const BatchRun run = gathered(run_own(arguments, cases, session), session);
  std::array<ExitStatus, 1> status{};
  if (session.rank() == 0) status[0] = conclude(arguments, cases, run);
  session.share(std::as_writable_bytes(std::span(status)));
  return status[0];
}

}  // namespace verisq::command_line
