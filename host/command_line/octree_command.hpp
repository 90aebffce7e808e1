/// `verisq octree`: cubes proven inside and outside a model, and its volume between two bounds.
#pragma once

#include <optional>
#include <string>
#include <verisq/model.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// As typed; `run_octree` checks what depends on the file or on several options.
struct OctreeArguments {
  std::string model;
  std::optional<Pose> pose;
  std::optional<int> depth;
  std::optional<double> tolerance;  ///< of the volume
  std::optional<std::size_t> budget;
  std::string device = "auto";
  std::string output;
  std::string max_output = "1GiB";  ///< text, which messages repeat
  bool white = false;
  bool json = false;
  bool no_progress = false;
};

void declare_octree(Options& options, OctreeArguments& arguments);

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_octree(const OctreeArguments& arguments);

}  // namespace verisq::command_line
