/// The forms of the summary.
#include "host/command_line/map_summary.hpp"

#include <fmt/core.h>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/element_words.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/progress_bar.hpp"

namespace verisq::command_line {
namespace {

double elements_per_second(const MapReport& report) {
  return report.seconds > 0.0 ? static_cast<double>(report.summary.points) / report.seconds : 0.0;
}

}  // namespace

std::string readable(const MapReport& report) {
  const auto& summary = report.summary;
  const auto units = report.units.empty() ? std::string() : " " + report.units;
  auto text = fmt::format("{:<19}{}\n", plural(report.elements), summary.points);
  text += fmt::format("  device-verified  {}\n", summary.device_verified);
  text += fmt::format("  host-verified    {}\n", summary.host_verified);
  text += fmt::format("  wide             {}\n", summary.wide);
  text += fmt::format("device             {}\n", summary.device);
  text += fmt::format("tolerance          {:.3g}{}{}\n", report.tolerance, units,
                      report.tolerance == 0.0 ? ": the tightest" : "");
  if (!report.place.empty()) text += fmt::format("model              {}\n", report.place);
  if (summary.points > 0) {
    text += fmt::format("smallest distance  [{}, {}]{}\n", summary.minimum_lo, summary.minimum_hi, units);
    text += fmt::format("largest width      {}{}\n", upper_digits(summary.largest_width), units);
  }
  if (report.closest) {
    text += fmt::format("closest points     {} unique", report.closest->unique);
    if (report.closest->unique > 0) {
      text += fmt::format(", to {}{}", upper_digits(report.closest->widest_point), units);
      if (report.elements != MapElements::poses)
        text += fmt::format("; normals to {}", upper_digits(report.closest->widest_normal));
    }
    text += "\n";
  }
  text += fmt::format("preparation        {:.3g} s\n", report.preparation_seconds);
  text += fmt::format("time               {:.3g} s (device {:.3g} s, host proofs {:.3g} s), {} {}/s\n", report.seconds,
                      summary.device_seconds, summary.host_seconds, with_prefix(elements_per_second(report)),
                      plural(report.elements));
  text += fmt::format("map                {}\n", report.output.empty() ? "not kept" : report.output);
  if (!report.files.html.empty()) text += fmt::format("report             {}\n", report.files.html);
  if (!report.files.png.empty()) text += fmt::format("picture            {}\n", report.files.png);
  return text;
}

std::vector<ReportLine> report_lines(const MapReport& report) {
  const auto& summary = report.summary;
  const auto units = report.units.empty() ? std::string() : " " + report.units;
  std::vector<ReportLine> lines;
  if (summary.points > 0) {
    lines.push_back({"smallest distance", outward_digits({summary.minimum_lo, summary.minimum_hi}) + units});
    lines.push_back({"largest width", upper_digits(summary.largest_width) + units});
  }
  lines.push_back({std::string(plural(report.elements)), fmt::format("{}", summary.points)});
  lines.push_back({"device-verified", fmt::format("{}", summary.device_verified)});
  lines.push_back({"host-verified", fmt::format("{}", summary.host_verified)});
  lines.push_back({"wide", fmt::format("{}", summary.wide)});
  lines.push_back({"tolerance", fmt::format("{}", report.tolerance) + units});
  lines.push_back({"device", summary.device});
  return lines;
}

std::string json(const MapReport& report) {
  const auto& summary = report.summary;
  JsonObject object{
      {plural(report.elements), summary.points},
      {"device_verified", summary.device_verified},
      {"host_verified", summary.host_verified},
      {"wide", summary.wide},
      {"device", summary.device},
      {"notice", summary.notice},
      {"units", report.units},
      {"tolerance", report.tolerance},
      {"tightest", report.tolerance == 0.0 && summary.wide == 0},
      {"largest_width", summary.largest_width},
      {"preparation_seconds", report.preparation_seconds},
      {"device_seconds", summary.device_seconds},
      {"host_seconds", summary.host_seconds},
      {"seconds", report.seconds},
      {fmt::format("{}_per_second", plural(report.elements)), elements_per_second(report)},
      {"interrupted", summary.interrupted},
      {"out_of_time", summary.out_of_time},
      {"output", report.output},
  };
  if (summary.points > 0) object.set("smallest_distance", Enclosure{summary.minimum_lo, summary.minimum_hi});
  if (!report.place.empty()) object.set("model_place", report.place);
  if (report.closest) {
    object.set("unique_closest_points", report.closest->unique);
    object.set("widest_closest_point", report.closest->widest_point);
    if (report.elements != MapElements::poses) object.set("widest_normal", report.closest->widest_normal);
  }
  if (!report.files.html.empty()) object.set("report", report.files.html);
  if (!report.files.png.empty()) object.set("png", report.files.png);
  return object.text() + "\n";
}

}  // namespace verisq::command_line
