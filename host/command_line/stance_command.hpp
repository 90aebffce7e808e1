/// `verisq stance`: enclosures of wrench, sensitivities and accelerations of a stance model with uncertain parameters.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

/// As typed; `run_stance` checks what depends on the file or on several options.
struct StanceArguments {
  std::string model;
  std::optional<std::string> uncertain;
  std::optional<std::string> mode;
  bool sensitivities = false;
  bool accelerations = false;
  std::optional<std::uint32_t> cells;
  std::optional<std::uint64_t> monte_carlo;
  bool report = false;
  std::optional<std::string> bounce;
  std::optional<std::string> drop_height;  ///< text, so that it is read to the nearest binary64
  bool json = false;
  bool no_progress = false;
};

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_stance(CLI::App& program, StanceArguments& arguments);

/// Throws Error(input) for whatever the user can correct, Error(failure) where a sample escapes from an enclosure.
ExitStatus run_stance(const StanceArguments& arguments);

}  // namespace verisq::command_line
