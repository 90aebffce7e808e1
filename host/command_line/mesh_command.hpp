/// `verisq mesh`: a model's surface as a closed triangle mesh.
#pragma once

#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// As typed; `run_mesh` checks what depends on the file.
struct MeshArguments {
  std::string model;
  std::optional<double> deviation;
  std::string output;
  std::string device = "auto";
  bool no_proof = false;
  bool json = false;
  bool no_progress = false;
};

void declare_mesh(Options& options, MeshArguments& arguments);

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_mesh(const MeshArguments& arguments);

}  // namespace verisq::command_line
