/// Formats the medians of the rows of Table 7.
#include "bench/table7_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "bench/paper_tables.hpp"
#include "bench/row_counters.hpp"

namespace verisq::bench {
namespace {

/// A dash where there is no such figure.
std::string cell(double figure) {
  return std::isnan(figure) ? fmt::format("{:>11}", "-") : fmt::format("{:>11.3g}", figure);
}

std::string paper_cells(const std::optional<PaperSearch>& paper) {
  return paper ? cell(paper->seconds) + cell(paper->width) : cell(NAN) + cell(NAN);
}

std::string cells(const Rows& rows, std::string_view scenario, const SearchGoal& goal) {
  const std::string row = row_name(table7_tool, goal.row, scenario);
  return cell(counter(rows, row, "seconds")) + cell(counter(rows, row, "width")) + cell(counter(rows, row, "cubes"));
}

std::string pose_text(const Pose& pose) {
  const auto& [t, q] = pose;
  return fmt::format("{},{},{},{},{},{},{}", t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
}

std::string heading() {
  std::string text = fmt::format("{:<24}{:>22}{:>22}", "", "the paper, goal 0.1", "goal 0.01");
  for (const SearchGoal& goal : table7_goals)
    text += fmt::format("{:>33}", fmt::format("verisq, goal {:g}", goal.width));
  text += fmt::format("\n{:<24}", "");
  for (int i = 0; i < 2; ++i) text += fmt::format("{:>11}{:>11}", "s", "width");
  for (std::size_t i = 0; i < table7_goals.size(); ++i)
    text += fmt::format("{:>11}{:>11}{:>11}", "s", "width", "cubes");
  return text + "\n";
}

}  // namespace

std::string table7(const Rows& rows) {
  std::string text = "Table 7, reproduced and extended: distances by branch and bound\n" + heading();
  for (const BenchmarkScenario& scenario : table7_scenarios) {
    text += fmt::format("{:<24}", scenario.name) + paper_cells(scenario.coarse) + paper_cells(scenario.fine);
    for (const SearchGoal& goal : table7_goals) text += cells(rows, scenario.name, goal);
    text += '\n';
  }
  text += "poses of the second object (the paper prints none), as for `verisq distance --pose`\n";
  for (const BenchmarkScenario& scenario : table7_scenarios) {
    text += fmt::format("{:<24}{}\n", scenario.name, pose_text(scenario.pose));
  }
  return text;
}

}  // namespace verisq::bench
