/// `verisq map`: an enclosure of the distance for each vertex or triangle of a mesh or point of a file.
#pragma once

#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/point_stream.hpp"
#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

/// As typed; `run_map` checks what depends on the files or on several options.
struct MapArguments {
  InputArguments inputs;
  std::string on = "vertices";
  std::optional<std::string> tolerance;   ///< text, so that it is read to the nearest binary64
  std::string point_radius = "0";         ///< text, likewise
  std::optional<std::string> time_limit;  ///< text, in seconds
  std::string device = "auto";
  std::string method = "duality";
  std::string output;  ///< empty when only a report is asked for
  ReportFiles report;
  bool certificates = false;
  bool json = false;
  bool no_progress = false;
};

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_map(CLI::App& program, MapArguments& arguments);

/// Throws Error(input) for whatever the user can correct, before the first distance is computed (a file of points is
/// a stream: its later lines are checked as they come).
ExitStatus run_map(const MapArguments& arguments);

}  // namespace verisq::command_line
