/// `verisq insert`: how deep an implant cuts into the bone on its way in, for each vertex of a mesh.
#pragma once

#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

/// As typed; numbers are text, so that they are read to the nearest binary64.
struct InsertArguments {
  std::string implant;
  std::string mesh;
  std::optional<std::string> poses;  ///< a file, or instead of it:
  std::optional<std::string> along;  ///< a direction, with
  std::optional<std::string> length;
  std::optional<std::string> tolerance;
  std::string device = "auto";
  std::string output;
  bool json = false;
  bool no_progress = false;
};

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_insert(CLI::App& program, InsertArguments& arguments);

/// Throws Error(input) for what the user can correct, before the first distance is computed.
ExitStatus run_insert(const InsertArguments& arguments);

}  // namespace verisq::command_line
