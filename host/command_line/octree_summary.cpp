/// The two forms of the summary.
#include "host/command_line/octree_summary.hpp"

#include <fmt/core.h>

#include "host/command_line/byte_size.hpp"
#include "host/command_line/directed_digits.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/progress_bar.hpp"

namespace verisq::command_line {
namespace {

std::string table(const OctreeReport& report) {
  const OctreeSummary& summary = report.summary;
  std::string text = fmt::format("{:<8}{:>14}{:>14}{:>14}{:>14}\n", "level", "edge", "inside", "undecided", "outside");
  for (std::size_t level = 0; level < summary.levels.size(); ++level) {
    const auto& [black, white, gray] = summary.levels[level];
    text += fmt::format("{:<8}{:>14.6g}{:>14}{:>14}{:>14}\n", level, edge(summary.root, static_cast<int>(level)), black,
                        gray, white);
  }
  return text;
}

double cubes_per_second(const OctreeSummary& summary) {
  return summary.seconds > 0.0 ? static_cast<double>(summary.coloured) / summary.seconds : 0.0;
}

}  // namespace

std::string readable(const OctreeReport& report) {
  const OctreeSummary& summary = report.summary;
  const std::string cubic_units = report.units.empty() ? "" : " " + report.units + "^3";
  std::string text = table(report);
  text += fmt::format("volume             [{}, {}]{}\n", lower_digits(summary.volume.lo),
                      upper_digits(summary.volume.hi), cubic_units);
  text += fmt::format("undecided volume   {:.3g}{}\n", summary.volume.width(), cubic_units);
  if (report.tolerance) text += fmt::format("tolerance          {:.3g}{}\n", *report.tolerance, cubic_units);
  text += fmt::format("device             {}\n", summary.device);
  text += fmt::format("time               {:.3g} s (device {:.3g} s), {} cubes/s\n", summary.seconds,
                      summary.device_seconds, with_prefix(cubes_per_second(summary)));
  text += fmt::format("octree             {}", report.output.empty() ? "not written" : report.output);
  text += report.output_bytes > 0 ? fmt::format(" ({})\n", byte_size_text(report.output_bytes)) : "\n";
  return text;
}

std::string json(const OctreeReport& report) {
  const OctreeSummary& summary = report.summary;
  JsonValue::Array levels;
  for (std::size_t level = 0; level < summary.levels.size(); ++level) {
    const auto& [black, white, gray] = summary.levels[level];
    levels.push_back(JsonObject{{"level", level},
                                {"edge", edge(summary.root, static_cast<int>(level))},
                                {"inside", black},
                                {"undecided", gray},
                                {"outside", white}});
  }
  const JsonObject object{
      {"volume", summary.volume},
      {"units", report.units},
      {"tolerance", report.tolerance},
      {"depth", summary.levels.size() - 1},
      {"levels", levels},
      {"root", JsonObject{{"centre", summary.root.centre}, {"half_width", summary.root.half_width}}},
      {"coloured", summary.coloured},
      {"budget_hit", summary.budget_hit},
      {"interrupted", summary.interrupted},
      {"device", summary.device},
      {"notice", summary.notice},
      {"device_seconds", summary.device_seconds},
      {"seconds", summary.seconds},
      {"cubes_per_second", cubes_per_second(summary)},
      {"output", report.output},
      {"output_bytes", report.output_bytes},
  };
  return object.text() + "\n";
}

}  // namespace verisq::command_line
