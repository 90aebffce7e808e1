/// `verisq surface`, which is the program `verisq-surface`: a closed oriented surface from a point cloud or a damaged
/// mesh.
#pragma once

#include <optional>
#include <string>
#include <verisq/surface.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// As typed; `run_surface` checks what depends on several options.
struct SurfaceArguments {
  std::string points;  ///< empty when `mesh` is given
  std::string mesh;    ///< empty when `points` is given
  std::string output;
  std::optional<SurfaceMethod> method;
  std::optional<double> alpha;
  std::optional<double> offset;
  bool fill_holes = false;
  int smooth = 0;
  bool inward = false;
  bool outward = false;
  bool json = false;
  bool no_progress = false;
};

void declare_surface(Options& options, SurfaceArguments& arguments);

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_surface(const SurfaceArguments& arguments);

}  // namespace verisq::command_line
