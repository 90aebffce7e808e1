/// How fast are finished maps proved again, beside the host's own proof of the same points?
///
/// One core a row: checks and proofs of different points are independent, and `verisq check` takes all cores.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>

#include "bench/benchmark_rows.hpp"
#include "bench/paper_tables.hpp"
#include "bench/points.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 5;
constexpr std::size_t outside_count = 2000;
constexpr std::size_t inside_count = 500;
constexpr double inside_tolerance = 1e-6;  // of the size

/// Points with what is claimed of them and why.
struct Claims {
  std::vector<Point> points;
  double tolerance;
  std::vector<CertifiedEnclosure> rows;
};

Claims claims(const SignedDistance& distance, std::vector<Point> points, double tolerance) {
  Claims result{std::move(points), tolerance, {}};
  for (const Point& point : result.points) result.rows.push_back(distance.certified(point, tolerance));
  return result;
}

void set_rate(benchmark::State& state, std::size_t points) {
  state.counters["points_per_second"] =
      benchmark::Counter(static_cast<double>(points), benchmark::Counter::kIsIterationInvariantRate);
}

void check_row(benchmark::State& state, const Checker& check, const Claims& claimed) {
  std::size_t proved = 0;
  for (auto _ : state) {
    proved = 0;
    for (std::size_t i = 0; i < claimed.points.size(); ++i) {
      const auto& [enclosure, certificate] = claimed.rows[i];
      proved += check(claimed.points[i], enclosure, certificate).verdict == Verdict::proved ? 1 : 0;
    }
  }
  set_rate(state, claimed.points.size());
  state.counters["proved_fraction"] = static_cast<double>(proved) / static_cast<double>(claimed.points.size());
}

void prove_row(benchmark::State& state, const SignedDistance& distance, const Claims& claimed) {
  for (auto _ : state) {
    for (const Point& point : claimed.points) benchmark::DoNotOptimize(distance(point, claimed.tolerance));
  }
  set_rate(state, claimed.points.size());
}

/// One object of Table 5, everything prepared.
struct Task {
  explicit Task(const BenchmarkObject& object)
      : name(object.name),
        paper_seconds(object.paper.verified_seconds),
        model{"", {{name, object.solid, {}}}},
        distance(model),
        check(model),
        outside(claims(distance, points_outside(object.solid, outside_count), 0.0)),
        inside(claims(distance, points_inside(object.solid, inside_count), inside_tolerance * size_of(object.solid))) {}

  std::string name;
  double paper_seconds;
  Model model;
  SignedDistance distance;
  Checker check;
  Claims outside;
  Claims inside;
};

void add_rows(const Task& task, const std::string& side, const Claims& claimed) {
  benchmark::RegisterBenchmark(("verisq_check/point_" + side + "/" + task.name).c_str(), [&](benchmark::State& state) {
    check_row(state, task.check, claimed);
  })->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark(("verisq_host/point_" + side + "/" + task.name).c_str(), [&](benchmark::State& state) {
    prove_row(state, task.distance, claimed);
  })->Unit(benchmark::kMillisecond);
}

void print_table(const Rows& rows, const std::vector<Task>& tasks) {
  fmt::print("\nPoints a second on one core; the paper's verified GJK: {:.0f}\n{:<34}", 1.0 / tasks[0].paper_seconds,
             "");
  for (const Task& task : tasks) fmt::print("{:>12}", task.name);
  for (const char* side : {"outside", "inside"}) {
    for (const char* tool : {"verisq_check", "verisq_host"}) {
      fmt::print("\n{:<34}", fmt::format("{}, {}", side, tool));
      for (const Task& task : tasks) {
        fmt::print("{:>12.0f}",
                   counter(rows, fmt::format("{}/point_{}/{}", tool, side, task.name), "points_per_second"));
      }
    }
  }
  fmt::print("\n");
}

void run(int argc, char** argv) {
  std::vector<Task> tasks;
  tasks.reserve(table5_objects.size());  // rows refer to their tasks
  for (const BenchmarkObject& object : table5_objects) tasks.emplace_back(object);
  for (const Task& task : tasks) {
    add_rows(task, "outside", task.outside);
    add_rows(task, "inside", task.inside);
  }
  print_table(run_benchmarks(argc, argv, repetitions), tasks);
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("check_bench", verisq::bench::run, argc, argv);
}
