/// The summary of a prepared surface on the standard output: for people, or as one JSON object.
#pragma once

#include <cstddef>
#include <string>
#include <verisq/surface.hpp>

namespace verisq::command_line {

struct SurfaceReport {
  const PreparedSurface& surface;
  const SurfaceCheck& check;  ///< of the file
  const SurfaceOptions& options;
  std::size_t points;  ///< of the input
  std::string output;  ///< the file
  double seconds;
};

[[nodiscard]] std::string readable(const SurfaceReport& report);

/// One line.
[[nodiscard]] std::string json(const SurfaceReport& report);

}  // namespace verisq::command_line
