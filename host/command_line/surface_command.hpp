/// `verisq surface`: a closed oriented surface from a point cloud or a damaged mesh.
#pragma once

#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

/// As typed; `run_surface` checks what depends on several options.
struct SurfaceArguments {
  std::string points;  ///< empty when `mesh` is given
  std::string mesh;    ///< empty when `points` is given
  std::string output;
  std::optional<std::string> method;
  std::optional<std::string> alpha;   ///< text, so that it is read to the nearest binary64
  std::optional<std::string> offset;  ///< likewise
  bool fill_holes = false;
  int smooth = 0;
  bool inward = false;
  bool outward = false;
  bool json = false;
  bool no_progress = false;
};

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_surface(CLI::App& program, SurfaceArguments& arguments);

/// Throws Error(input) for whatever the user can correct; in a build without CGAL, always.
ExitStatus run_surface(const SurfaceArguments& arguments);

}  // namespace verisq::command_line
