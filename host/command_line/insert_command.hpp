/// `verisq insert`: how deep an implant cuts into the bone on its way in, for each vertex of a mesh, and how much bone
/// it takes away.
#pragma once

#include <optional>
#include <string>
#include <verisq/map_file.hpp>
#include <verisq/mesh.hpp>
#include <verisq/removed_volume.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/insertion_inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

/// As typed; `run_insert` checks what depends on several options.
struct InsertArguments {
  InsertionInputs inputs;
  std::optional<double> search_cone;       ///< degrees: the best of the ways whose direction is so much off
  std::optional<double> search_turn;       ///< degrees: and whose turn differs so much
  MapElements on = MapElements::vertices;  ///< triangles: of the whole surface, too
  bool cavity = false;                     ///< the mesh is that of a cavity
  bool bone = false;                       ///< the mesh is the bone's outer surface
  std::optional<std::string> within;
  std::optional<Plane> resection;
  std::optional<double> volume_tolerance;  ///< relative
  std::string device = "auto";
  std::string output;
  std::string certificate_file;  ///< empty: none
  ReportFiles report;
  bool json = false;
  bool no_progress = false;
};

void declare_insert(Options& options, InsertArguments& arguments);

/// Throws Error(input) for what the user can correct, before the first distance is computed.
ExitStatus run_insert(const InsertArguments& arguments);

}  // namespace verisq::command_line
