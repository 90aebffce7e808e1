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
  std::vector<std::string> notes;  ///< how the landmarks were found
  FemurFeatures bone;
  std::optional<FemurFeatures> changes;  ///< by an implant
};

/// Tables for people.
[[nodiscard]] std::string readable(const FeaturesReport& report);
/// One line of JSON.
[[nodiscard]] std::string json(const FeaturesReport& report);
/// The features for a report's table.
[[nodiscard]] std::vector<ReportLine> report_lines(const FeaturesReport& report);

}  // namespace verisq::command_line
