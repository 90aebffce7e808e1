/// Rows under their plain names `<tool>/<what>/<object>`, on the screen, in JSON and for the tables at the end.
#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <string_view>

namespace verisq::bench {

/// The medians of one row: its counters by name.
using Counters = std::map<std::string, double>;

/// All rows of a run, by name.
using Rows = std::map<std::string, Counters>;

/// Runs the registered benchmarks with Google Benchmark's usual flags (`repetitions` unless a flag asks otherwise),
/// writes JSON where --benchmark_out says so, and returns the medians. Throws std::runtime_error on an unknown
/// argument.
[[nodiscard]] Rows run_benchmarks(int argc, char** argv, int repetitions);

/// The counter of a row; NaN where the row did not run or has no such counter.
[[nodiscard]] double counter(const Rows& rows, const std::string& row, const std::string& name);

/// What main returns: 0, or 1 after `run` threw, which is told on standard error under the program's name.
[[nodiscard]] int run_program(std::string_view name, void (*run)(int, char**), int argc, char** argv);

}  // namespace verisq::bench
