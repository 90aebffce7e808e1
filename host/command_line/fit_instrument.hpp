/// The instrument that prepares the bed of an implant, like its rasp, where the implant was fitted: how deep it cuts.
#pragma once

#include <string>
#include <vector>
#include <verisq/fit_solution.hpp>
#include <verisq/mesh_clearance.hpp>
#include <verisq/model.hpp>

#include "host/command_line/fit_command.hpp"

namespace verisq::command_line {

struct Instrument {
  std::string file;
  Model model;  ///< in the frame of its implant
};

/// One an implant, in the order of the series; none where none is given. Throws Error(input) for another number of
/// them, for units that are not those of `problem`, and as read_model.
[[nodiscard]] std::vector<Instrument> read_instruments(const FitProblem& problem, const FitArguments& arguments);

/// Of one instrument at the pose of the implant.
struct InstrumentClearance {
  std::string file;
  MeshClearance surface;  ///< of the whole bone
};

/// Proves it of the chosen implant's. Errors as mesh_clearance. Precondition: a mesh with triangles.
[[nodiscard]] InstrumentClearance prove_instrument(const FitProblem& problem, const Fit& fit,
                                                   const Instrument& instrument);

}  // namespace verisq::command_line
