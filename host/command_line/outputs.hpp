/// The outputs of commands: certificates, reports and pictures, and maps with their columns and summaries.
#pragma once

#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>
#include <verisq/report.hpp>

#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/threads/background_work.hpp"

namespace verisq::command_line {

// The option --certificate-file, and others like it.

/// Its value, empty where it is not given: throws Error(input) unless it is a .json that is none of the inputs,
/// Error(failure) where it cannot be written: known before all the work, not after it.
void check_certificate_file(const std::string& file, const std::vector<std::string>& inputs,
                            const char* option = "--certificate-file");

// The options --report and --png, --range and --up: a finished map for people to look at.

/// Names of files, as typed, empty when not requested; and the range and direction of the display.
struct ReportFiles {
  std::string html;
  std::string png;
  std::optional<double> range = {};
  std::optional<Point> up = {};

  [[nodiscard]] bool any() const { return !html.empty() || !png.empty(); }
};

/// Adds --report, --png, --range and --up.
void declare_report_files(Options& options, ReportFiles& files);

/// Throws Error(input) for other extensions, and if a file would overwrite one of `inputs` or be one of the other
/// `outputs`, by links, too; empty names stand for no file. Throws Error(failure) if a file cannot be written. So
/// errors are known before all the work, not after it.
void check_usage(const ReportFiles& files, const std::vector<std::string>& inputs,
                 const std::vector<std::string>& outputs);

/// Throws Error(failure). --range and --up, if given, replace the values of `report`.
void write(const ReportFiles& files, const Report& report);

// --columns: the columns of a map, and their order.

/// The columns named between the commas of `text`; `closest` and `normal` are six each. Throws Error(input) that begins
/// with `option` for other names and for one that is there twice.
[[nodiscard]] std::vector<MapColumn> parse_columns(std::string_view option, const std::string& text);

// The summary of a finished map: on the standard output for people or as one JSON object, or in a report.

struct MapReport {
  MapSummary summary;
  MapElements elements;  ///< the elements of the rows
  std::string output;    ///< the file that holds the map; empty when none was kept
  ReportFiles files;     ///< with its pictures; names are empty for files that are not written
  std::string units;     ///< of the model; empty when not given
  std::string place;     ///< accuracy of the model's place; empty: exact
  double tolerance;
  std::optional<ClosestPointSummary> closest;  ///< set if closest points were requested
  double preparation_seconds;  ///< wall time until the device was ready: kernels compiled, self-test passed
  double seconds;              ///< wall time from the first element to the last row written
};

[[nodiscard]] std::string readable(const MapReport& report);

/// The most important first. Digits are rounded outward: the printed interval contains the proven one.
[[nodiscard]] std::vector<ReportLine> report_lines(const MapReport& report);

/// One line. JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] std::string json(const MapReport& report);

// Runs a map from a stream of elements to its files: the common part of `map` and `distance --poses`.

/// All rows of a displayed map.
struct ShownRows {
  std::vector<MapResult> results;
  std::vector<Certificate> certificates;  ///< none, or one for each row
};

struct MapRequest {
  MapElements elements;
  MapContents contents;
  std::string output;       ///< the file, `-` for the standard output; empty for none
  std::string format = {};  ///< as in `MapForm`
  std::vector<MapColumn> columns = {};
  std::uint64_t first_row = 0;  ///< index of the first row
  std::optional<std::uint64_t> rows = {};
  ReportFiles report = {};  ///< the files that `show` writes
  std::string units;        ///< of the model; empty when not given
  std::string place = {};   ///< accuracy of the model's place; empty: exact
  double tolerance;
  bool show_progress;
  bool json;                         ///< the form of the summary
  std::string why_wide_inside = {};  ///< printed if rows of points inside are wide; empty: nothing
  /// The closest points of finished rows, for files with those contents. Empty: none are requested.
  std::function<std::vector<ClosestPoint>(std::span<const Point>, std::span<const MapResult>)> closest = {};
  /// The same for poses.
  std::function<std::vector<ClosestPoints>(std::span<const Pose>)> closest_pairs = {};
  /// Called when the file of a map that was not interrupted is complete. Empty: nothing more is to be done.
  std::function<void(const MapSummary&, const std::optional<ClosestPointSummary>&)> finished = {};
  /// Called at the end of a map that was not interrupted, with all its rows. Empty: none are kept in memory.
  std::function<void(const ShownRows&, const MapReport&)> show = {};
};

using Clock = std::chrono::steady_clock;

/// Ends the files, prints the summary and reports how the map ended. The map began at `start`, its first element was
/// requested at `first_element`. `writer` is nothing if no file is requested; `rows` are those for `request.show`.
ExitStatus end_map(std::optional<MapWriter>& writer, const ShownRows& rows, const MapSummary& summary,
                   const std::optional<ClosestPointSummary>& closest, const MapRequest& request,
                   Clock::time_point start, Clock::time_point first_element);

/// The rows of one call of a sink.
template <class Element>
struct FinishedRows {
  std::vector<Element> elements;
  std::vector<MapResult> results;
  std::vector<Certificate> certificates;
  std::vector<ClosestPoint> closest;
  std::vector<ClosestPoints> closest_pairs;
};

template <class Element>
void append(MapWriter& writer, const FinishedRows<Element>& rows) {
  if constexpr (std::same_as<Element, Point>) {
    if (!rows.closest.empty()) return writer.append_closest(rows.elements, rows.results, rows.closest);
    writer.append(rows.elements, rows.results, rows.certificates);
  } else {
    if (!rows.closest_pairs.empty()) return writer.append_closest(rows.results, rows.closest_pairs);
    writer.append(rows.results, rows.certificates);
  }
}

/// Adds the closest points of points or poses, if they are requested.
template <class Element>
void add_closest_points(FinishedRows<Element>& rows, const MapRequest& request,
                        std::optional<ClosestPointSummary>& summary) {
  if constexpr (std::same_as<Element, Point>) {
    if (!request.closest) return;
    rows.closest = request.closest(rows.elements, rows.results);
    summary = joined(summary.value_or(ClosestPointSummary{}), summary_of(rows.closest));
  } else if constexpr (std::same_as<Element, Pose>) {
    if (!request.closest_pairs) return;
    rows.closest_pairs = request.closest_pairs(rows.elements);
    summary = joined(summary.value_or(ClosestPointSummary{}), summary_of(rows.closest_pairs));
  }
}

[[nodiscard]] inline MapForm form_of(const MapRequest& request) {
  return {.contents = request.contents,
          .elements = request.elements,
          .format = request.format,
          .columns = request.columns,
          .first_row = request.first_row,
          .rows = request.rows};
}

/// Maps the elements that `stream` delivers by the mapper that `make_mapper()` returns.
template <class Stream, class MakeMapper>
ExitStatus map_to_file(Stream& stream, const Mesh* mesh, const MakeMapper& make_mapper, const MapRequest& request) {
  using Element = typename Stream::Element;
  watch_for_interruption();
  std::optional<MapWriter> writer;
  if (!request.output.empty()) {
    writer.emplace(request.output, mesh, form_of(request));
  }
  // Threads of their own read a file and write another one while kernels run; the elements of a mesh need no reading.
  std::optional<ReadAhead<Stream>> ahead;
  std::optional<WorkBehind<FinishedRows<Element>>> behind;
  if (writer) behind.emplace([&](const FinishedRows<Element>& rows) { append(*writer, rows); });
  ShownRows rows;
  std::optional<ClosestPointSummary> closest;
  const auto start = Clock::now();
  auto mapper = make_mapper();
  std::optional<ProgressBar> bar;  // begins at the first element: compiling kernels is no part of the rate
  auto first_element = Clock::now();
  const auto source = [&](std::span<Element> elements) {
    if (!bar) {
      first_element = Clock::now();
      bar.emplace(request.show_progress, plural(request.elements));
      if (mesh == nullptr) ahead.emplace(stream);
    }
    return ahead ? ahead->read(elements) : stream.read(elements);
  };
  std::uint64_t done = 0;
  const auto sink = [&](std::span<const Element> elements, std::span<const MapResult> results,
                        std::span<const Certificate> certificates) {
    if (behind) {
      FinishedRows<Element> finished = behind->spare();
      finished.elements.assign(elements.begin(), elements.end());
      finished.results.assign(results.begin(), results.end());
      finished.certificates.assign(certificates.begin(), certificates.end());
      add_closest_points(finished, request, closest);
      behind->add(std::move(finished));
    }
    if (request.show) {
      rows.results.insert(rows.results.end(), results.begin(), results.end());
      rows.certificates.insert(rows.certificates.end(), certificates.begin(), certificates.end());
    }
    done += elements.size();
    bar->update(done, ahead ? ahead->fraction(done) : stream.fraction(done));
  };
  // Rows that cannot be written are older than whatever else fails.
  const auto map = [&] {
    try {
      return mapper.map(source, sink);
    } catch (...) {
      if (behind) behind->finish();
      throw;
    }
  };
  const MapSummary summary = map();
  if (behind) behind->finish();
  bar.reset();  // the line is cleared before anything else is said
  return end_map(writer, rows, summary, closest, request, start, first_element);
}

}  // namespace verisq::command_line
