/// The summary of a prepared surface on the standard output: for people, or as one JSON object.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <verisq/canal.hpp>
#include <verisq/surface.hpp>

#include "host/command_line/label_input.hpp"

namespace verisq::command_line {

struct SurfaceReport {
  const PreparedSurface& surface;
  const SurfaceCheck& check;  ///< of the file
  const SurfaceOptions& options;
  std::size_t points;             ///< of the input
  const LabelInput* label;        ///< null where the input is no volume
  std::optional<WallCheck> wall;  ///< of a canal
  std::string output;             ///< the file
  double seconds;
};

[[nodiscard]] std::string readable(const SurfaceReport& report);

/// One line.
[[nodiscard]] std::string json(const SurfaceReport& report);

}  // namespace verisq::command_line
