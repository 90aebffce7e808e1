/// `verisq-mpi map`: one map by all ranks of an MPI job.
#pragma once

#include <optional>
#include <verisq/map_file.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/point_stream.hpp"
#include "host/command_line/pose_uncertainty_option.hpp"
#include "host/command_line/shared_rows.hpp"

namespace verisq::command_line {

/// As typed.
struct SharedMapArguments {
  InputArguments inputs;
  MapElements on = MapElements::vertices;
  std::optional<double> tolerance;
  double point_radius = 0.0;
  PoseUncertaintyArguments pose_uncertainty;
  SharedRowsArguments rows;
};

void declare_shared_map(Options& options, SharedMapArguments& arguments);

/// Called by all ranks. Throws Error as `verisq map`.
ExitStatus run_shared_map(const SharedMapArguments& arguments, const mpi::Session& session);

}  // namespace verisq::command_line
