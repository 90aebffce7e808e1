/// `verisq fit`: the pose and the sizes of an implant that serve a cavity best, and the proof of how well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/report_files.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

/// As typed; numbers are text, so that they are read to the nearest binary64.
struct FitArguments {
  std::vector<std::string> implants;  ///< files of the series
  std::string mesh;
  std::string completion = "cementless";
  std::optional<std::string> gap;
  std::optional<std::string> gap_tolerance;
  std::string penetration_limit = "0";
  std::optional<std::string> on;  ///< what keeps the limit: vertices or triangles
  std::optional<std::string> pose_start;
  std::optional<std::string> translation_range;
  std::string rotation_range = "30";  ///< degrees
  std::uint64_t seed = 1;
  std::size_t samples = 4096;
  std::optional<std::string> labels;  ///< a property of the mesh's vertices
  std::vector<std::string> weights;   ///< NAME=W
  std::optional<std::string> tolerance;
  std::string device = "auto";
  std::string output;
  std::string map;  ///< empty when not asked for
  ReportFiles report;
  bool json = false;
  bool no_progress = false;
};

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_fit(CLI::App& program, FitArguments& arguments);

/// `verified` when every enclosure is at most the tolerance wide and nothing is proven too deep. Throws Error(input)
/// for whatever the user can correct, before the search.
ExitStatus run_fit(const FitArguments& arguments);

}  // namespace verisq::command_line
