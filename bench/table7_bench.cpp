/// The paper's Table 7, reproduced and extended: the distance of two solids, bent or not, by branch and bound.
#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <verisq/distance.hpp>

#include "bench/benchmark_rows.hpp"
#include "bench/paper_tables.hpp"
#include "bench/row_counters.hpp"
#include "bench/table7_table.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 5;

Model model(const Superquadric& solid, const std::optional<Bend>& bend) {
  return {"", {{"solid", solid, {}, bend}}};
}

/// By certificates, for scenarios that have them.
bool contradicts_certificates(const Model& a, const Model& b, const Pose& pose, const Enclosure& found) {
  if (!is_union_of_convex(a) || !is_union_of_convex(b)) return false;
  const Enclosure proven = PairDistance(a, b)(pose).distance;
  return found.lo > proven.hi || found.hi < proven.lo;
}

void add_search_row(const BenchmarkScenario& scenario, const SearchGoal& goal) {
  add_row(table7_tool, goal.row, scenario.name, [&scenario, &goal](benchmark::State& state) {
    using Clock = std::chrono::steady_clock;
    const Model a = model(scenario.a, scenario.bend_a);
    const Model b = model(scenario.b, scenario.bend_b);
    SearchedDistance found{};
    const Clock::time_point start = Clock::now();
    // Models are made ready within the loop: a search is a whole answer.
    for (auto _ : state) found = ModelSearch(a, b)(scenario.pose, {.tolerance = goal.width});
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    state.counters["seconds"] = seconds / static_cast<double>(state.iterations());
    state.counters["width"] = found.distance.width();
    state.counters["cubes"] = static_cast<double>(found.cubes);
    if (!verified(found.distance, goal.width)) return state.SkipWithError("the enclosure is wider than the goal");
    if (contradicts_certificates(a, b, scenario.pose, found.distance)) {
      state.SkipWithError("the enclosure contradicts that of the certificates");
    }
  });
}

void run(int argc, char** argv) {
  for (const BenchmarkScenario& scenario : table7_scenarios) {
    for (const SearchGoal& goal : table7_goals) add_search_row(scenario, goal);
  }
  fmt::print("\n{}", table7(run_benchmarks(argc, argv, repetitions)));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("table7_bench", verisq::bench::run, argc, argv);
}
