/// A row for each direction.
#include "host/command_line/deviation_summary.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/json_value.hpp"

namespace verisq::command_line {
namespace {

constexpr int digits = 5;
constexpr const char* what_is_proven = "the model's boundary and the triangles as their binary64 corners state them";
constexpr const char* what_is_proven_of_points =
    "the model's boundary and the points as their binary64 numbers state them";

std::string with_units(const Enclosure& enclosure, const DeviationReport& report) {
  return outward_digits(enclosure, digits) + (report.units.empty() ? "" : " " + report.units);
}

struct Line {
  std::string label;
  std::string value;
};

void add_statistics(std::vector<Line>& lines, const std::string& direction, const DistanceStatistics& statistics,
                    const DeviationReport& report) {
  lines.push_back({direction, ""});
  lines.push_back({"  largest", with_units(statistics.largest, report)});
  if (statistics.mean) lines.push_back({"  mean", with_units(*statistics.mean, report)});
  for (std::size_t i = 0; i < statistics.percentiles.size(); ++i) {
    lines.push_back(
        {fmt::format("  {:g} %", report.options.percentiles[i]), with_units(statistics.percentiles[i], report)});
  }
}

/// Means are as narrow as those of all made them.
void add_regions(std::vector<Line>& lines, const DeviationReport& report) {
  if (report.region_names.empty()) return;
  lines.push_back({"mesh to model by region", ""});
  for (std::size_t i = 0; i < report.region_names.size(); ++i) {
    const DistanceStatistics& region = report.deviation.by_region[i];
    const bool is_empty = std::ranges::find(report.options.region_of, i) == report.options.region_of.end();
    lines.push_back({"  " + report.region_names[i],
                     is_empty ? "no triangles"
                              : fmt::format("largest {}, mean {}", with_units(region.largest, report),
                                            with_units(*region.mean, report))});
  }
}

JsonValue json_of_regions(const DeviationReport& report) {
  JsonValue::Array regions;
  for (std::size_t i = 0; i < report.region_names.size(); ++i) {
    const DistanceStatistics& region = report.deviation.by_region[i];
    const auto triangles = std::ranges::count(report.options.region_of, i);
    regions.push_back(JsonObject{{"name", report.region_names[i]},
                                 {"triangles", static_cast<std::size_t>(triangles)},
                                 {"largest", region.largest},
                                 {"farthest", region.farthest},
                                 {"mean", region.mean}});
  }
  return {regions};
}

std::string tolerance_text(const DeviationReport& report) {
  if (!report.options.tolerance) return fmt::format("{:g} %", 100.0 * report.options.relative_tolerance);
  return fmt::format("{:g}{}", *report.options.tolerance, report.units.empty() ? "" : " " + report.units);
}

/// Of the mesh, or of the points.
const DistanceSummary& certified_summary(const ProvenDeviation& proven) {
  return proven.from_mesh ? *proven.from_mesh : proven.of_vertices;
}

/// What matters most first: a picture has room for a few lines.
std::vector<Line> lines_of(const DeviationReport& report) {
  const Deviation& deviation = report.deviation;
  std::vector<Line> lines;
  if (deviation.hausdorff) lines.push_back({"both ways (Hausdorff)", with_units(*deviation.hausdorff, report)});
  if (deviation.from_mesh) add_statistics(lines, "mesh to model", *deviation.from_mesh, report);
  add_regions(lines, report);
  if (deviation.from_model) {
    add_statistics(lines, report.is_cloud ? "model to points" : "model to mesh", *deviation.from_model, report);
  }
  add_statistics(lines, report.is_cloud ? "points to model" : "vertices to model", deviation.of_vertices, report);
  if (!deviation.from_model) lines.push_back({"model to points", "not asked for: --both-ways"});
  lines.push_back({"proven of", report.is_cloud ? what_is_proven_of_points : what_is_proven});
  lines.push_back(
      {"tolerance", tolerance_text(report) + (deviation.to_tolerance ? ", reached" : ", not reached by all")});
  return lines;
}

JsonValue json_of(const std::optional<DistanceStatistics>& statistics, const DeviationReport& report) {
  if (!statistics) return {};
  JsonValue::Array percentiles;
  for (std::size_t i = 0; i < statistics->percentiles.size(); ++i) {
    const Enclosure& value = statistics->percentiles[i];
    percentiles.push_back(JsonObject{{"percent", report.options.percentiles[i]}, {"lo", value.lo}, {"hi", value.hi}});
  }
  JsonObject object{{"largest", statistics->largest}, {"farthest", statistics->farthest}};
  if (statistics->mean) object.set("mean", *statistics->mean);
  if (!percentiles.empty()) object.set("percentiles", percentiles);
  return object;
}

JsonValue::Array json_of_percentiles(const std::vector<Enclosure>& values, const DeviationReport& report) {
  JsonValue::Array percentiles;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& [lo, hi] = values[i];
    percentiles.push_back(JsonObject{{"percent", report.options.percentiles[i]}, {"lo", lo}, {"hi", hi}});
  }
  return percentiles;
}

JsonValue json_of_certified(const DeviationReport& report) {
  if (!report.certified) return {};
  const DistanceSummary& summary = certified_summary(*report.certified);
  JsonObject object{{"largest", summary.largest},
                    {"mean", summary.mean},
                    {"percentiles", json_of_percentiles(summary.percentiles, report)},
                    {report.is_cloud ? "model_to_points" : "model_to_mesh", report.certified->from_model},
                    {"hausdorff", report.certified->hausdorff}};
  if (const auto& statistics = report.certified->statistics_from_model) {
    object.set("model_mean", statistics->mean);
    object.set("model_percentiles", json_of_percentiles(statistics->percentiles, report));
  }
  return object;
}

std::string certified_in_words(const DeviationReport& report) {
  const ProvenDeviation& certified = *report.certified;
  const auto line = [&](const std::string& label, const Enclosure& value) {
    return fmt::format("{:<23}{}\n", label, with_units(value, report));
  };
  const auto percentile_lines = [&](const char* label, const std::vector<Enclosure>& values) {
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i)
      text += line(fmt::format("  {}, {:g} %", label, report.options.percentiles[i]), values[i]);
    return text;
  };
  const DistanceSummary& summary = certified_summary(certified);
  std::string text = line("  proves, largest", summary.largest) + line("  proves, mean", summary.mean) +
                     percentile_lines("proves", summary.percentiles);
  if (!certified.from_model) return text;
  text += line(report.is_cloud ? "  model to points" : "  model to mesh", *certified.from_model);
  if (const auto& statistics = certified.statistics_from_model)
    text += line("  model, mean", statistics->mean) + percentile_lines("model", statistics->percentiles);
  return text + line("  both ways", *certified.hausdorff);
}

}  // namespace

std::string readable(const DeviationReport& report) {
  const Deviation& deviation = report.deviation;
  std::string text = fmt::format("{:<23}{}\n", report.is_cloud ? "points" : "vertices", deviation.vertices.size());
  if (!report.is_cloud) text += fmt::format("{:<23}{}\n", "triangles", report.triangles);
  for (const auto& [label, value] : lines_of(report)) {
    text += value.empty() ? label + "\n" : fmt::format("{:<23}{}\n", label, value);
  }
  text += fmt::format("{:<23}{}\n", "device", deviation.map.device);
  text += fmt::format("{:<23}{} distances to the model, {} patches of its surface\n", "evaluations",
                      deviation.vertices.size() + deviation.samples, deviation.patches);
  text += fmt::format("{:<23}{:.3g} s\n", "time", report.seconds);
  if (!report.output.empty()) text += fmt::format("{:<23}{}\n", "map", report.output);
  if (report.certified) {
    text += fmt::format("{:<23}{}\n", "certificate", report.certificate);
    text += certified_in_words(report);
  }
  if (!report.files.html.empty()) text += fmt::format("{:<23}{}\n", "report", report.files.html);
  if (!report.files.png.empty()) text += fmt::format("{:<23}{}\n", "picture", report.files.png);
  return text;
}

std::vector<ReportLine> report_lines(const DeviationReport& report) {
  std::vector<ReportLine> lines;
  std::string direction;
  for (const auto& [label, value] : lines_of(report)) {
    if (value.empty()) {
      direction = label + ",";
    } else if (label.starts_with("  ")) {
      lines.push_back({direction + label.substr(1), value});
    } else {
      lines.push_back({label, value});
    }
  }
  return lines;
}

std::string json(const DeviationReport& report) {
  const Deviation& deviation = report.deviation;
  const bool is_cloud = report.is_cloud;
  const std::optional<DistanceStatistics> vertices = deviation.of_vertices;
  const JsonObject object{
      {is_cloud ? "points" : "vertices", deviation.vertices.size()},
      {"triangles", report.triangles},
      {is_cloud ? "points_to_model" : "vertices_to_model", json_of(vertices, report)},
      {"mesh_to_model", json_of(deviation.from_mesh, report)},
      {is_cloud ? "model_to_points" : "model_to_mesh", json_of(deviation.from_model, report)},
      {"mesh_to_model_by_region", json_of_regions(report)},
      {"hausdorff", deviation.hausdorff},
      {"tolerance", report.options.tolerance},
      {"relative_tolerance", report.options.tolerance ? JsonValue() : JsonValue(report.options.relative_tolerance)},
      {"to_tolerance", deviation.to_tolerance},
      {"units", report.units},
      {"samples", deviation.vertices.size() + deviation.samples},
      {"patches", deviation.patches},
      {"device", deviation.map.device},
      {"notice", deviation.map.notice},
      {"seconds", report.seconds},
      {"interrupted", deviation.interrupted},
      {"out_of_time", deviation.out_of_time},
      {"output", report.output},
      {"certificate", report.certificate},
      {"certified", json_of_certified(report)},
      {"report", report.files.html},
      {"png", report.files.png},
  };
  return object.text() + "\n";
}

}  // namespace verisq::command_line
