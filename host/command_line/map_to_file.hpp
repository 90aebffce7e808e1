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

namespace verisq::command_line {

struct MapRequest {
  MapElements elements;
  MapContents contents;
  std::string output;       ///< the file; empty for none
  ReportFiles report = {};  ///< what `show` writes
  std::string units;        ///< of the model; empty when not given
  double tolerance;
  bool show_progress;
  bool json;                         ///< the form of the summary
  std::string why_wide_inside = {};  ///< said where rows of points inside are wide; empty: nothing
  /// Called at the end of a map that was not interrupted, with all its rows. Empty: none are kept in memory.
  std::function<void(std::span<const MapResult>, const MapReport&)> show = {};
};

using Clock = std::chrono::steady_clock;

/// Ends the files, prints the summary and says how the map ended. The map began at `start`, its first element was asked
/// for at `first_element`. `writer` is nothing where no file is asked for, `rows` are those for `request.show`.
ExitStatus end_map(std::optional<MapWriter>& writer, std::span<const MapResult> rows, const MapSummary& summary,
                   const MapRequest& request, Clock::time_point start, Clock::time_point first_element);

/// Maps the elements that `stream` delivers by the mapper that `make_mapper()` returns.
template <class Stream, class MakeMapper>
ExitStatus map_to_file(Stream& stream, const Mesh* mesh, const MakeMapper& make_mapper, const MapRequest& request) {
  using Element = typename Stream::Element;
  watch_for_interruption();
  std::optional<MapWriter> writer;
  if (!request.output.empty()) writer.emplace(request.output, mesh, request.contents, request.elements);
  std::vector<MapResult> rows;
  const auto start = Clock::now();
  auto mapper = make_mapper();
  std::optional<ProgressBar> bar;  // begins at the first element: compiling kernels is no part of the rate
  auto first_element = Clock::now();
  const auto source = [&](std::span<Element> elements) {
    if (!bar) {
      first_element = Clock::now();
      bar.emplace(request.show_progress, plural(request.elements));
    }
    return stream.read(elements);
  };
  std::uint64_t done = 0;
  const auto sink = [&](std::span<const Element> elements, std::span<const MapResult> results,
                        std::span<const Certificate> certificates) {
    if constexpr (std::same_as<Element, Point>) {
      if (writer) writer->append(elements, results, certificates);
    } else {
      if (writer) writer->append(results, certificates);
    }
    if (request.show) rows.insert(rows.end(), results.begin(), results.end());
    done += elements.size();
    bar->update(done, stream.fraction(done));
  };
  const MapSummary summary = mapper.map(source, sink);
  bar.reset();  // the line is cleared before anything else is said
  return end_map(writer, rows, summary, request, start, first_element);
}

}  // namespace verisq::command_line
