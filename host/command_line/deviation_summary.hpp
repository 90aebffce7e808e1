/// What `verisq deviation` says: for people, for the page of a report, or as one JSON object.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>
#include <verisq/deviation.hpp>
#include <verisq/deviation_certificate.hpp>
#include <verisq/report.hpp>

#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

struct DeviationReport {
  Deviation deviation;
  DeviationOptions options = {};
  std::vector<std::string> region_names = {};
  bool is_cloud = false;
  std::size_t triangles = 0;
  std::string output = {};                        ///< the file that holds the rows; empty when none was kept
  std::string certificate = {};                   ///< what proves distances again; empty where none was written
  std::string without_surface = {};               ///< why it proves nothing of the model's surface, if that was found
  std::optional<ProvenDeviation> certified = {};  ///< what it proves
  ReportFiles files = {};
  std::string units = {};  ///< of the model; empty when not given
  double seconds = 0.0;    ///< wall time
};

[[nodiscard]] std::string readable(const DeviationReport& report);

[[nodiscard]] std::vector<ReportLine> report_lines(const DeviationReport& report);

/// One line. JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] std::string json(const DeviationReport& report);

}  // namespace verisq::command_line
