/// `verisq surface`, which is the program `verisq-surface`: a closed oriented surface from a point cloud, a damaged
/// mesh or a label of a volume, and the canal within one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/label_volume.hpp>
#include <verisq/surface.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// As typed; `run_surface` checks what depends on several options.
struct SurfaceArguments {
  std::string points;  ///< one of three is given, the others are empty
  std::string mesh;
  std::string volume;
  std::string output;
  std::optional<std::uint16_t> label;
  std::optional<AnatomicalSpace> space;
  std::vector<std::string> thickness;
  std::optional<Point> axis;
  std::string landmarks;  ///< empty where heights are numbers
  std::optional<SurfaceMethod> method;
  std::optional<double> alpha;
  std::optional<double> offset;
  bool fill_holes = false;
  std::optional<int> smooth;
  std::optional<double> edge;
  std::optional<Plane> resection;
  bool inward = false;
  bool outward = false;
  bool json = false;
  bool no_progress = false;
};

void declare_surface(Options& options, SurfaceArguments& arguments);

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_surface(const SurfaceArguments& arguments);

}  // namespace verisq::command_line
