/// The two forms of the summary.
#include "host/command_line/octree_summary.hpp"

#include <fmt/format.h>
// After <cstdio>, which makes MPFR declare its formatted output.
#include <mpfr.h>

#include <array>
#include <nlohmann/json.hpp>

#include "host/command_line/byte_size.hpp"
#include "host/command_line/progress_bar.hpp"

namespace verisq::command_line {
namespace {

/// Ten significant digits of which the number is no smaller ("D") or no larger ("U") than `x`.
std::string digits(double x, char rounding) {
  mpfr_t number;
  mpfr_init2(number, 53);
  mpfr_set_d(number, x, MPFR_RNDN);
  std::array<char, 64> text{};
  mpfr_snprintf(text.data(), text.size(), rounding == 'D' ? "%.10RDg" : "%.10RUg", number);
  mpfr_clear(number);
  return text.data();
}

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
  text += fmt::format("volume             [{}, {}]{}\n", digits(summary.volume.lo, 'D'), digits(summary.volume.hi, 'U'),
                      cubic_units);
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
  auto levels = nlohmann::ordered_json::array();
  for (std::size_t level = 0; level < summary.levels.size(); ++level) {
    const auto& [black, white, gray] = summary.levels[level];
    levels.push_back({{"level", level},
                      {"edge", edge(summary.root, static_cast<int>(level))},
                      {"inside", black},
                      {"undecided", gray},
                      {"outside", white}});
  }
  nlohmann::ordered_json object{
      {"volume", {{"lo", summary.volume.lo}, {"hi", summary.volume.hi}}},
      {"units", report.units},
      {"tolerance", nullptr},
      {"depth", summary.levels.size() - 1},
      {"levels", levels},
      {"root", {{"centre", summary.root.centre}, {"half_width", summary.root.half_width}}},
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
  if (report.tolerance) object["tolerance"] = *report.tolerance;
  // Names of devices and files are bytes of the system, not always UTF-8: replaced rather than refused.
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace verisq::command_line
