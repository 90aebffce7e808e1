/// Runs Google Benchmark behind reporters that drop its suffixes from the names of rows and keep the medians.
#include "bench/benchmark_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace verisq::bench {
namespace {

using Runs = std::vector<benchmark::BenchmarkReporter::Run>;

/// Google Benchmark appends how a row was timed ("/real_time"): true of all rows here, and no part of their names.
Runs with_plain_names(Runs runs) {
  for (auto& run : runs) {
    run.run_name.time_type.clear();
    run.run_name.iterations.clear();
  }
  return runs;
}

class PlainJsonReporter : public benchmark::JSONReporter {
 public:
  void ReportRuns(const Runs& runs) override { JSONReporter::ReportRuns(with_plain_names(runs)); }
};

class CollectingReporter : public benchmark::ConsoleReporter {
 public:
  CollectingReporter() : ConsoleReporter(OO_None) {}

  void ReportRuns(const Runs& runs) override {
    Runs medians = with_plain_names(runs);
    std::erase_if(medians, [](const Run& run) { return !is_median(run) && !run.error_occurred; });
    for (const auto& run : medians) collect(run);
    ConsoleReporter::ReportRuns(medians);
  }

  [[nodiscard]] const Rows& rows() const { return rows_; }

 private:
  /// A single repetition has no aggregates and stands for itself.
  static bool is_median(const Run& run) { return run.aggregate_name == "median" || run.repetitions <= 1; }

  void collect(const Run& run) {
    Counters& counters = rows_[run.run_name.str()];
    for (const auto& [name, value] : run.counters) counters[name] = value;
  }

  Rows rows_;
};

}  // namespace

Rows run_benchmarks(int argc, char** argv, int repetitions) {
  // First, so that a user's own flags win.
  std::string repeated = fmt::format("--benchmark_repetitions={}", repetitions);
  std::string interleaved = "--benchmark_enable_random_interleaving=true";  // drifts of the machine hit all rows alike
  std::string medians_on_screen = "--benchmark_display_aggregates_only=true";
  std::vector<char*> arguments{argv[0], repeated.data(), interleaved.data(), medians_on_screen.data()};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  const bool writes_json = std::any_of(arguments.begin(), arguments.end(), [](std::string_view argument) {
    return argument.starts_with("--benchmark_out=");
  });

  auto count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (count > 1) throw std::runtime_error(std::string("unknown argument ") + arguments[1]);
  CollectingReporter screen;
  PlainJsonReporter file;
  benchmark::RunSpecifiedBenchmarks(&screen, writes_json ? &file : nullptr);
  benchmark::Shutdown();
  return screen.rows();
}

double counter(const Rows& rows, const std::string& row, const std::string& name) {
  const auto found = rows.find(row);
  if (found == rows.end() || !found->second.contains(name)) return std::numeric_limits<double>::quiet_NaN();
  return found->second.at(name);
}

int run_program(std::string_view name, void (*run)(int, char**), int argc, char** argv) {
  try {
    run(argc, argv);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return 1;
  }
}

}  // namespace verisq::bench
