/// `verisq fit`: the pose and the sizes of an implant that serve a cavity best, and the proof of how well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/fit_problem.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

/// As typed; `fit_request` and the library check what depends on the files or on several options.
struct FitArguments {
  std::vector<std::string> implants;     ///< files of the series
  std::vector<std::string> instruments;  ///< files: none, or one an implant
  std::string mesh;
  bool cavity = false;  ///< the mesh is the surface of one
  bool bone = false;
  bool any_side = false;
  std::optional<Plane> resection;
  std::vector<std::string> crossing;  ///< primitives
  std::vector<std::string> outside;   ///< likewise
  std::string landmarks;              ///< of the bone; empty when not given
  double landmark_radius = 0.0;
  std::vector<KeptFeature> kept;
  bool implant_contact = false;
  FitObjective objective = FitObjective::fitness;
  Completion completion = Completion::cementless;
  std::optional<double> gap;
  std::optional<double> gap_tolerance;
  double penetration_limit = 0.0;
  std::optional<MapElements> on;  ///< what keeps the limit: vertices or triangles
  std::optional<Pose> pose_start;
  std::optional<double> translation_range;
  double rotation_range = 30.0;  ///< degrees
  std::uint64_t seed = 1;
  std::size_t samples = 4096;
  std::optional<double>
      bound;                  ///< percent: a proof that no pose of the range is better by more; nothing: not asked for
  double bound_time = 300.0;  ///< seconds for it
  std::string bound_certificate;
  std::string contact_certificate;    ///< of areas in contact; empty when not asked for
  std::optional<std::string> labels;  ///< a property of the mesh's vertices
  std::vector<Area> weights;
  std::optional<double> tolerance;
  std::string device = "auto";
  std::string output;
  std::string map;               ///< empty when not asked for
  bool certificates = false;     ///< of the map, and the page of the report
  std::string surface_map;       ///< of whole triangles, with certificates; empty when not asked for
  std::string certificate_file;  ///< of what the map's distances say together; empty when not asked for
  ReportFiles report;
  bool json = false;
  bool no_progress = false;
};

void declare_fit(Options& options, FitArguments& arguments);

/// `verified` when every enclosure is at most the tolerance wide and nothing is proven too deep. Throws Error(input)
/// for whatever the user can correct, before the search.
ExitStatus run_fit(const FitArguments& arguments);

}  // namespace verisq::command_line
