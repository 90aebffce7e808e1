/// Runs the cases of a cohort, each as a process.
#include "host/command_line/batch_command.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <list>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"

#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <cerrno>
#include <csignal>
#include <cstring>

namespace verisq::command_line {
namespace {

constexpr int not_started = 127;  // as shells have it

/// Between fork and exec only functions that signal handlers may call are allowed.
[[noreturn]] void become(const char* program, char* const* argv, const char* folder, const char* out, const char* err,
                         pid_t parent) {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
  if (getppid() != parent) _exit(not_started);  // it has ended before that was said
  constexpr mode_t permissions = 0666;
  const int in = open("/dev/null", O_RDONLY);
  const int to_out = open(out, O_WRONLY | O_CREAT | O_TRUNC, permissions);
  const int to_err = open(err, O_WRONLY | O_CREAT | O_TRUNC, permissions);
  if (in < 0 || to_out < 0 || to_err < 0 || chdir(folder) != 0) _exit(not_started);
  if (dup2(in, STDIN_FILENO) < 0 || dup2(to_out, STDOUT_FILENO) < 0 || dup2(to_err, STDERR_FILENO) < 0) {
    _exit(not_started);
  }
  execv(program, argv);
  _exit(not_started);
}

pid_t started(const std::filesystem::path& program, const std::vector<std::string>& arguments,
              const std::filesystem::path& folder, const std::filesystem::path& out, const std::filesystem::path& err) {
  std::vector<std::string> words{"verisq"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string in_folder = folder.string();
  const pid_t parent = getpid();
  const pid_t id = fork();
  if (id == 0) become(program.c_str(), argv.data(), in_folder.c_str(), out.c_str(), err.c_str(), parent);
  if (id < 0) throw Error(ErrorKind::failure, fmt::format("cannot start a process: {}", std::strerror(errno)));
  return id;
}

}  // namespace

BatchProcess::BatchProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const std::filesystem::path& folder, const std::filesystem::path& out,
                           const std::filesystem::path& err)
    : id_(started(program, arguments, folder, out, err)) {}

std::optional<int> BatchProcess::status() const {
  int status = 0;
  const pid_t ended = waitpid(id_, &status, WNOHANG);
  if (ended == 0) return std::nullopt;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

void BatchProcess::end() const {
  kill(id_, SIGTERM);
}

namespace {

constexpr auto watch_interval = std::chrono::milliseconds(2);

void create_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(ErrorKind::failure, fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The last line of a program's output: programs end with the reason of a failure.
std::string last_line_of(const std::filesystem::path& path) {
  std::string text = text_of(path);
  while (text.ends_with('\n')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

class Batch {
 public:
  Batch(std::span<const BatchCase> cases, const BatchFolders& folders, const BatchOptions& options)
      : cases_(cases),
        options_(options),
        manifest_folder_(std::filesystem::absolute(folders.manifest)),
        folder_(std::filesystem::absolute(folders.results)) {
    for (const char* const name : {"cases", "maps", "logs"}) create_folder(folder_ / name);
    run_.results.resize(cases.size());
  }

  BatchRun operator()() {
    for (bool more = true; more || !running_.empty();) {
      if (interrupted()) {
        end_all();
        break;
      }
      while (more && running_.size() < options_.jobs) {
        const std::optional<std::size_t> place = next();
        more = place.has_value();
        if (place) begin(*place);
      }
      collect();
      options_.progress(begun_ - running_.size());
      if (!running_.empty()) std::this_thread::sleep_for(watch_interval);
    }
    return std::move(run_);
  }

 private:
  struct Running {
    std::size_t place;  // of the case
    std::vector<SubjectFile> inputs;
    BatchProcess process;
    Stopwatch time = {};
  };

  [[nodiscard]] std::filesystem::path record_of(const BatchCase& of) const {
    return folder_ / "cases" / (of.name + ".json");
  }
  [[nodiscard]] std::filesystem::path output_of(const BatchCase& of) const {
    return folder_ / "logs" / (of.name + ".out");
  }
  [[nodiscard]] std::filesystem::path log_of(const BatchCase& of) const {
    return folder_ / "logs" / (of.name + ".err");
  }

  [[nodiscard]] std::optional<std::size_t> next() const {
    const std::optional<std::size_t> place = options_.next ? options_.next() : begun_;
    return place && *place < cases_.size() ? place : std::nullopt;
  }

  // An unreadable input is the case's failure, like all errors that its process finds.
  [[nodiscard]] std::optional<std::vector<SubjectFile>> digests_of_inputs(std::size_t place) {
    std::vector<SubjectFile> inputs;
    try {
      for (const std::filesystem::path& file : inputs_of(cases_[place], manifest_folder_)) {
        inputs.push_back(digest_of_file(file));
      }
    } catch (const Error& error) {
      run_.results[place] = {.outcome = CaseOutcome::failed, .message = error.what()};
      return std::nullopt;
    }
    return inputs;
  }

  void begin(std::size_t place) {
    ++begun_;
    const BatchCase& of = cases_[place];
    std::optional<std::vector<SubjectFile>> inputs = digests_of_inputs(place);
    if (!inputs) return;
    if (auto known = read_record(record_of(of), of, *inputs)) {
      run_.results[place] = std::move(*known);
      ++run_.taken_over;
      return;
    }
    std::vector<std::string> arguments{of.command};
    arguments.insert(arguments.end(), of.arguments.begin(), of.arguments.end());
    arguments.insert(arguments.end(), {"--json", "--no-progress"});
    if (of.command == "map" && !of.has_output) {
      arguments.push_back("--output=" + (folder_ / "maps" / (of.name + ".npy")).string());
    }
    running_.push_back({place, std::move(*inputs),
                        BatchProcess(options_.program, arguments, manifest_folder_, output_of(of), log_of(of))});
  }

  void collect() {
    for (auto running = running_.begin(); running != running_.end();) {
      const std::optional<int> status = running->process.status();
      if (status) {
        take(*running, *status);
        running = running_.erase(running);
      } else {
        ++running;
      }
    }
  }

  void take(const Running& ended, int status) {
    const BatchCase& of = cases_[ended.place];
    CaseResult& result = run_.results[ended.place];
    const double seconds = ended.time.seconds();
    const bool finished =
        status == static_cast<int>(ExitStatus::verified) || status == static_cast<int>(ExitStatus::unverified);
    if (finished) {
      const CaseOutcome outcome =
          status == static_cast<int>(ExitStatus::verified) ? CaseOutcome::verified : CaseOutcome::wide;
      const std::string json = text_of(output_of(of));
      try {
        result = result_of(json, outcome, of.name);
        write_record(record_of(of), of, ended.inputs, outcome, seconds, json);
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::input) throw;
        result = {.outcome = CaseOutcome::failed, .message = error.what()};
      }
    } else {
      result.outcome = CaseOutcome::failed;
      result.message = last_line_of(log_of(of));
      if (result.message.empty()) result.message = fmt::format("ended with status {}", status);
    }
    result.seconds = seconds;
    std::error_code ignored;
    std::filesystem::remove(output_of(of), ignored);
    if (finished && std::filesystem::file_size(log_of(of), ignored) == 0) {
      std::filesystem::remove(log_of(of), ignored);
    }
  }

  // Cases under way are run again.
  void end_all() {
    run_.interrupted = true;
    for (const Running& running : running_) running.process.end();
    for (Running& running : running_) {
      std::optional<int> status = running.process.status();
      while (!status) {
        std::this_thread::sleep_for(watch_interval);
        status = running.process.status();
      }
      // It may have ended by itself just before.
      if (*status == static_cast<int>(ExitStatus::verified) || *status == static_cast<int>(ExitStatus::unverified)) {
        take(running, *status);
      }
    }
  }

  std::span<const BatchCase> cases_;
  const BatchOptions& options_;
  std::filesystem::path manifest_folder_;
  std::filesystem::path folder_;
  std::list<Running> running_;
  std::size_t begun_ = 0;
  BatchRun run_;
};

}  // namespace

BatchRun run_batch(std::span<const BatchCase> cases, const BatchFolders& folders, const BatchOptions& options) {
  return Batch(cases, folders, options)();
}

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
    text += fmt::format("failed             {}: {}\n", cases[i].name, on_one_line(run.results[i].message));
    ++shown;
  }
  if (totals.failed > shown) text += fmt::format("                   and {} more\n", totals.failed - shown);
  if (totals.nearest) {
    text += fmt::format("nearest            {}: smallest distance {}\n", cases[*totals.nearest].name,
                        outward_digits(*run.results[*totals.nearest].smallest));
  }
  return text + fmt::format("tables             summary.csv, summary.json and overview.html in {}\n",
                            quotation(arguments.output));
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

Command batch_command() {
  return command("batch", "Run the cases of a cohort, a row of a manifest each, resumably", declare_batch,
                 run_batch_command);
}

}  // namespace verisq::command_line
