/// What a fit is to solve, from the options and files of the user.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>
#include <verisq/landmark_file.hpp>
#include <verisq/mesh.hpp>

#include "host/command_line/fit_command.hpp"

namespace verisq::command_line {

struct FitProblem {
  std::vector<UncertainModel> series;
  std::vector<FemurLandmarks> landmarks;  ///< that each implant's file names
  std::string units;                      ///< of all implants; empty when none has any
  Mesh mesh;                              ///< cut off at the resection
  Surface surface = Surface::unsided;
  std::optional<LandmarkFile> bone;  ///< its landmarks, where they are given
  Cavity cavity;                     ///< the vertices of the mesh
  FitOptions options;
};

/// Throws Error(input) naming file or option, key and value.
[[nodiscard]] FitProblem read_fit_problem(const FitArguments& arguments);

}  // namespace verisq::command_line
