/// `verisq map`: an enclosure of the distance for each vertex or triangle of a mesh or point of a file.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/part_option.hpp"
#include "host/command_line/point_stream.hpp"
#include "host/command_line/pose_uncertainty_option.hpp"
#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

/// As typed; `run_map` checks what depends on the files or on several options.
struct MapArguments {
  InputArguments inputs;
  MapElements on = MapElements::vertices;
  std::optional<double> tolerance;
  double point_radius = 0.0;
  PoseUncertaintyArguments pose_uncertainty;
  std::optional<unsigned> pose_divisions;
  std::optional<double> time_limit;  ///< in seconds
  std::string device = "auto";
  Method method = Method::duality;
  std::string output;                 ///< empty when only a report is asked for, `-` for the standard output
  std::optional<std::string> format;  ///< an extension
  std::vector<MapColumn> columns;     ///< empty: those that the format has by itself
  std::optional<PartOption> part;
  ReportFiles report;
  bool certificates = false;
  bool closest_points = false;
  bool json = false;
  bool no_progress = false;
};

void declare_map(Options& options, MapArguments& arguments);

/// Throws Error(input) for whatever the user can correct, before the first distance is computed (a file of points is
/// a stream: its later lines are checked as they come).
ExitStatus run_map(const MapArguments& arguments);

}  // namespace verisq::command_line
