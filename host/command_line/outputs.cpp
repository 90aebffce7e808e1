/// This file implements outputs.hpp.
#include "host/command_line/outputs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/output_file.hpp"

namespace verisq::command_line {

void check_certificate_file(const std::string& file, const std::vector<std::string>& inputs, const char* option) {
  if (file.empty()) return;
  if (std::filesystem::path(file).extension() != ".json") refuse(fmt::format("{} {}: is a .json", option, file));
  refuse_to_overwrite(option, file, inputs);
  const OutputFile trial(file);  // leaves nothing behind
}

namespace {

void check(const char* option, const std::string& file, const char* extension, const std::vector<std::string>& inputs) {
  if (file.empty()) return;
  if (std::filesystem::path(file).extension() != extension) {
    refuse(fmt::format("{} {}: its name must end in {}", option, file, extension));
  }
  refuse_to_overwrite(option, file, inputs);
  const OutputFile trial(file);  // leaves nothing behind
}

}  // namespace

void declare_report_files(Options& options, ReportFiles& files) {
  options.add("--report", files.html, "FILE",
              "An interactive page of the mesh and the model that any browser shows, without a network: .html");
  options.add("--png", files.png, "FILE", "A picture of the same: .png");
  options.add("--range", files.range, parse_positive_length, "NUMBER",
              "Where the colours of both end, in model units (default: 3 mm where a tenth of the vertices is nearer,\n"
              "else where few are beyond)");
  options.add("--up", files.up, parse_direction, "x,y,z",
              "What both show on top (default: the mesh's long axis, at the model's end)");
}

void check_usage(const ReportFiles& files, const std::vector<std::string>& inputs,
                 const std::vector<std::string>& outputs) {
  if (!files.any() && files.range) refuse("--range: give the --report or --png that it is for");
  if (!files.any() && files.up) refuse("--up: give the --report or --png that it is for");
  check("--report", files.html, ".html", inputs);
  check("--png", files.png, ".png", inputs);
  std::vector<std::string> all{files.html, files.png};
  all.insert(all.end(), outputs.begin(), outputs.end());
  refuse_one_file_twice(all);
}

void write(const ReportFiles& files, const Report& report) {
  Report shown = report;
  if (files.range) shown.range = files.range;
  if (files.up) shown.up = files.up;
  shown.title = on_one_line(shown.title);
  std::ranges::transform(shown.area_names, shown.area_names.begin(), on_one_line);
  if (!files.png.empty()) write_picture(files.png, shown);
  // A page that proves itself compares its units with those of the model's text.
  if (!shown.proof && !shown.units.empty()) shown.units = units_behind(shown.units).substr(1);
  if (!files.html.empty()) write_html_report(files.html, shown);
}

namespace {

/// A name that may stand between commas: one column, or both ends of all coordinates of a box.
struct ColumnName {
  std::string_view name;
  std::vector<MapColumn> columns;
};

std::vector<MapColumn> from_to(MapColumn first, MapColumn last) {
  std::vector<MapColumn> columns;
  for (int k = static_cast<int>(first); k <= static_cast<int>(last); ++k) columns.push_back(static_cast<MapColumn>(k));
  return columns;
}

std::vector<ColumnName> all_names() {
  std::vector<ColumnName> names;
  for (const MapColumn column : from_to(MapColumn::index, MapColumn::unique)) {
    names.push_back({to_string(column), {column}});
  }
  names.push_back({"closest", from_to(MapColumn::closest_x_lo, MapColumn::closest_z_hi)});
  names.push_back({"normal", from_to(MapColumn::normal_x_lo, MapColumn::normal_z_hi)});
  names.push_back({to_string(MapColumn::primitive), {MapColumn::primitive}});
  return names;
}

std::vector<MapColumn> columns_named(std::string_view option, std::string_view name) {
  std::string known;
  for (const ColumnName& candidate : all_names()) {
    if (candidate.name == name) return candidate.columns;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", candidate.name);
  }
  refuse(fmt::format("{}: '{}' is not one of {}", option, name, known));
}

}  // namespace

std::vector<MapColumn> parse_columns(std::string_view option, const std::string& text) {
  std::vector<MapColumn> columns;
  std::string_view rest = text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    const std::string_view name = rest.substr(0, comma);
    for (const MapColumn column : columns_named(option, name)) {
      if (std::ranges::find(columns, column) != columns.end()) {
        refuse(fmt::format("{}: {} is there twice", option, name));
      }
      columns.push_back(column);
    }
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  return columns;
}

namespace {

double elements_per_second(const MapReport& report) {
  return report.seconds > 0.0 ? static_cast<double>(report.summary.points) / report.seconds : 0.0;
}

}  // namespace

std::string readable(const MapReport& report) {
  const auto& summary = report.summary;
  const auto units = units_behind(report.units);
  auto text = fmt::format("{:<19}{}\n", plural(report.elements), summary.points);
  text += fmt::format("  device-verified  {}\n", summary.device_verified);
  text += fmt::format("  host-verified    {}\n", summary.host_verified);
  text += fmt::format("  wide             {}\n", summary.wide);
  text += fmt::format("device             {}\n", quotation(summary.device));
  text += fmt::format("tolerance          {:.3g}{}{}\n", report.tolerance, units,
                      report.tolerance == 0.0 ? ": the tightest" : "");
  if (!report.place.empty()) text += fmt::format("model              {}\n", report.place);
  if (summary.points > 0) {
    text += fmt::format("smallest distance  [{}, {}]{}{}\n", summary.minimum_lo, summary.minimum_hi, units,
                        whose_distance(report.elements));
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
  text += fmt::format("map                {}\n", report.output.empty() ? "not kept" : quotation(report.output));
  if (!report.files.html.empty()) text += fmt::format("report             {}\n", quotation(report.files.html));
  if (!report.files.png.empty()) text += fmt::format("picture            {}\n", quotation(report.files.png));
  return text;
}

std::vector<ReportLine> report_lines(const MapReport& report) {
  const auto& summary = report.summary;
  const auto units = units_behind(report.units);
  std::vector<ReportLine> lines;
  if (summary.points > 0) {
    const bool of_points = report.elements == MapElements::vertices;
    lines.push_back({of_points ? "smallest distance of the points" : "smallest distance",
                     outward_digits({summary.minimum_lo, summary.minimum_hi}) + units});
    lines.push_back({"largest width", upper_digits(summary.largest_width) + units});
  }
  lines.push_back({std::string(plural(report.elements)), fmt::format("{}", summary.points)});
  lines.push_back({"device-verified", fmt::format("{}", summary.device_verified)});
  lines.push_back({"host-verified", fmt::format("{}", summary.host_verified)});
  lines.push_back({"wide", fmt::format("{}", summary.wide)});
  lines.push_back({"tolerance", fmt::format("{}", report.tolerance) + units});
  lines.push_back({"device", quotation(summary.device)});
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

namespace {

double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

/// Reports the files that an interrupted map leaves unwritten.
void say_what_is_missing(const MapRequest& request) {
  for (const std::string& file : {request.report.html, request.report.png}) {
    if (!file.empty()) tell(fmt::format("interrupted; {} is not written", file));
  }
}

/// Returns the name of the file of the map; empty if none was requested, or if an interrupted map left none.
std::string end_file(std::optional<MapWriter>& writer, const MapSummary& summary, const std::string& output) {
  if (!writer) return {};
  if (!summary.interrupted) {
    writer->finish();
    return output;
  }
  const auto partial = writer->keep_partial().string();
  if (partial.empty()) {
    tell(fmt::format("interrupted; {} is not written, because only .csv and .npy files can hold a part of a map",
                     output == "-" ? "the rest" : output));
  } else {
    tell(fmt::format("interrupted; the first {} rows are kept in {}", summary.points, partial));
  }
  return partial;
}

ExitStatus status_of(const MapSummary& summary) {
  if (summary.interrupted) return ExitStatus::interrupted;
  return summary.wide > 0 ? ExitStatus::unverified : ExitStatus::verified;
}

}  // namespace

ExitStatus end_map(std::optional<MapWriter>& writer, const ShownRows& rows, const MapSummary& summary,
                   const std::optional<ClosestPointSummary>& closest, const MapRequest& request,
                   Clock::time_point start, Clock::time_point first_element) {
  const std::string written = end_file(writer, summary, request.output);
  if (summary.interrupted) say_what_is_missing(request);
  if (!summary.interrupted && request.finished) request.finished(summary, closest);
  const auto end = Clock::now();
  tell_notice(summary.notice);
  if (summary.out_of_time && !summary.interrupted) {
    tell(fmt::format("the time limit is reached; {} of {} rows are valid, and wide", summary.wide, summary.points));
  }
  if (summary.wide_inside > 0 && !summary.interrupted && !request.why_wide_inside.empty()) {
    tell(fmt::format("{} inside the model {} wide: {}",
                     summary.wide_inside == 1 ? "1 row" : fmt::format("{} rows", summary.wide_inside),
                     summary.wide_inside == 1 ? "is" : "are", request.why_wide_inside));
  }
  const MapReport report{.summary = summary,
                         .elements = request.elements,
                         .output = written,
                         .files = summary.interrupted ? ReportFiles{} : request.report,
                         .units = request.units,
                         .place = request.place,
                         .tolerance = request.tolerance,
                         .closest = closest,
                         .preparation_seconds = seconds_between(start, first_element),
                         .seconds = seconds_between(first_element, end)};
  if (request.show && !summary.interrupted) request.show(rows, report);
  // Other messages must not get between the rows.
  fmt::print(request.output == "-" ? stderr : stdout, "{}", request.json ? json(report) : readable(report));
  return status_of(summary);
}

}  // namespace verisq::command_line
