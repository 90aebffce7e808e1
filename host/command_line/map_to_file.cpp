/// How a map ends: file, messages, summary, exit status.
#include "host/command_line/map_to_file.hpp"

#include <fmt/core.h>

#include <cstdio>

#include "host/command_line/messages.hpp"

namespace verisq::command_line {
namespace {

double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

/// What an interrupted map leaves unwritten.
void say_what_is_missing(const MapRequest& request) {
  for (const std::string& file : {request.report.html, request.report.png}) {
    if (!file.empty()) tell(fmt::format("interrupted; {} is not written", file));
  }
}

/// Returns the name of the file that holds the map; empty when none was asked for or an interrupted map left none.
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
  // What else there is to say must not get between the rows.
  fmt::print(request.output == "-" ? stderr : stdout, "{}", request.json ? json(report) : readable(report));
  return status_of(summary);
}

}  // namespace verisq::command_line
