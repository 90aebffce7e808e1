/// What `verisq features` prints.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/report.hpp>

namespace verisq::command_line {

struct FeaturesReport {
  FemurLandmarks landmarks;
  std::optional<Side> side;
  double landmark_radius;
  std::vector<std::string> notes = {};  ///< how the landmarks were found
  FemurFeatures bone = {};
  std::vector<std::string> implant_notes = {};  ///< which points of the implant count
  std::optional<FemurFeatures> changes = {};    ///< by an implant
};

/// Tables for people.
[[nodiscard]] std::string readable(const FeaturesReport& report);
/// One line of JSON.
[[nodiscard]] std::string json(const FeaturesReport& report);
/// The features for a report's table, an implant's changes first: a picture has room for a few lines.
[[nodiscard]] std::vector<ReportLine> report_lines(const FeaturesReport& report);

}  // namespace verisq::command_line
