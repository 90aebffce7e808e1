/// The summary of a recovery on the standard output: for people, or as one JSON object.
#pragma once

#include <optional>
#include <string>
#include <verisq/deviation.hpp>
#include <verisq/recovery.hpp>

namespace verisq::command_line {

struct RecoverReport {
  const Recovery& recovery;
  bool of_mesh;                     ///< else of a cloud
  std::optional<double> deviation;  ///< asked for
  std::optional<Deviation> proven;  ///< of the mesh
  std::string output;               ///< the model file
  double seconds;

  /// Whether the model is as near as asked, by estimate; true where nothing was asked.
  [[nodiscard]] bool reached() const;
};

[[nodiscard]] std::string readable(const RecoverReport& report);

/// One line.
[[nodiscard]] std::string json(const RecoverReport& report);

}  // namespace verisq::command_line
