/// Processes are started, watched and recorded.
#include "host/command_line/batch_run.hpp"

#include <fmt/core.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <list>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/map_part.hpp>

#include "host/command_line/batch_process.hpp"
#include "host/command_line/exit_status.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/stopwatch.hpp"

namespace verisq::command_line {
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

/// Programs end with the line that says why.
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

  // What cannot be read is the case's failure, like all that its process finds.
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

  // What was under way is run again.
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

}  // namespace verisq::command_line
