/// The summary of a finished map: on the standard output for people or as one JSON object, or in a report.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/closest_points.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>
#include <verisq/report.hpp>

#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

struct MapReport {
  MapSummary summary;
  MapElements elements;  ///< what the rows are of
  std::string output;    ///< the file that holds the map; empty when none was kept
  ReportFiles files;     ///< with its pictures; names are empty for those not written
  std::string units;     ///< of the model; empty when not given
  std::string place;     ///< how well the model's is known; empty: exactly
  double tolerance;
  std::optional<ClosestPointSummary> closest;  ///< where closest points were asked for
  double preparation_seconds;  ///< wall time until the device was ready: kernels compiled, self-test passed
  double seconds;              ///< wall time from the first element to the last row written
};

[[nodiscard]] std::string readable(const MapReport& report);

/// The most important first. Digits are rounded outward: what is printed contains what is proven.
[[nodiscard]] std::vector<ReportLine> report_lines(const MapReport& report);

/// One line. JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] std::string json(const MapReport& report);

}  // namespace verisq::command_line
