/// Runs a map from a stream of elements to its files: what `map` and `distance --poses` have in common.
#pragma once

#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/element_words.hpp"
#include "host/command_line/exit_status.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/map_summary.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/threads/read_ahead.hpp"
#include "host/threads/work_behind.hpp"

namespace verisq::command_line {

/// All rows of a map that is shown.
struct ShownRows {
  std::vector<MapResult> results;
  std::vector<Certificate> certificates;  ///< none, or one a row
};

struct MapRequest {
  MapElements elements;
  MapContents contents;
  std::string output;       ///< the file, `-` for the standard output; empty for none
  std::string format = {};  ///< as those of `MapForm`
  std::vector<MapColumn> columns = {};
  std::uint64_t first_row = 0;  ///< its index
  std::optional<std::uint64_t> rows = {};
  ReportFiles report = {};  ///< what `show` writes
  std::string units;        ///< of the model; empty when not given
  std::string place = {};   ///< how well the model's is known; empty: exactly
  double tolerance;
  bool show_progress;
  bool json;                         ///< the form of the summary
  std::string why_wide_inside = {};  ///< said where rows of points inside are wide; empty: nothing
  /// The closest points of finished rows, for files with those contents. Empty: none are asked for.
  std::function<std::vector<ClosestPoint>(std::span<const Point>, std::span<const MapResult>)> closest = {};
  /// Likewise of poses.
  std::function<std::vector<ClosestPoints>(std::span<const Pose>)> closest_pairs = {};
  /// Called when the file of a map that was not interrupted is there. Empty: nothing more is to be done.
  std::function<void(const MapSummary&, const std::optional<ClosestPointSummary>&)> finished = {};
  /// Called at the end of a map that was not interrupted, with all its rows. Empty: none are kept in memory.
  std::function<void(const ShownRows&, const MapReport&)> show = {};
};

using Clock = std::chrono::steady_clock;

/// Ends the files, prints the summary and says how the map ended. The map began at `start`, its first element was asked
/// for at `first_element`. `writer` is nothing where no file is asked for, `rows` are those for `request.show`.
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

/// Where they are asked for, of points or poses.
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

/// Maps the elements that `stream` delivers by the mapper that `make_mapper()` returns.
template <class Stream, class MakeMapper>
ExitStatus map_to_file(Stream& stream, const Mesh* mesh, const MakeMapper& make_mapper, const MapRequest& request) {
  using Element = typename Stream::Element;
  watch_for_interruption();
  std::optional<MapWriter> writer;
  if (!request.output.empty()) {
    writer.emplace(request.output, mesh,
                   MapForm{.contents = request.contents,
                           .elements = request.elements,
                           .format = request.format,
                           .columns = request.columns,
                           .first_row = request.first_row,
                           .rows = request.rows});
  }
  // A file is read, and another written, by threads of their own, while kernels run; of a mesh there is nothing to
  // read.
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
