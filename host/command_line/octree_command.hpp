/// `verisq octree`: cubes proven inside and outside a model, and its volume between two bounds.
#pragma once

#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

/// As typed; `run_octree` checks what depends on the file or on several options.
struct OctreeArguments {
  std::string model;
  std::optional<int> depth;
  std::optional<std::string> tolerance;  ///< text, so that it is read to the nearest binary64
  std::optional<std::size_t> budget;
  std::string device = "auto";
  std::string output;
  std::string max_output = "1GiB";
  bool white = false;
  bool json = false;
  bool no_progress = false;
};

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_octree(CLI::App& program, OctreeArguments& arguments);

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_octree(const OctreeArguments& arguments);

}  // namespace verisq::command_line
