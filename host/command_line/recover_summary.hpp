/// The summary of a recovery on the standard output: for people, or as one JSON object.
#pragma once

#include <optional>
#include <string>
#include <verisq/containment.hpp>
#include <verisq/deviation.hpp>
#include <verisq/recovery.hpp>

#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

/// What was asked for and what came of it.
struct ContainedWords {
  Containment containment;
  ContainmentProof proof;
  std::size_t proofs;  ///< that were tried
};

/// Without its dashes.
[[nodiscard]] std::string option_of(Containment containment);

/// Why it is not proven. Precondition: it is not.
[[nodiscard]] std::string obstacle(const ContainedWords& contained);

struct RecoverReport {
  const Recovery& recovery;
  bool of_mesh;                     ///< else of a cloud
  std::optional<double> deviation;  ///< asked for
  std::optional<ContainedWords> contained;
  std::optional<Deviation> proven;  ///< of the mesh
  std::string output;               ///< the model file
  ReportFiles files;                ///< those that were written
  double seconds;

  /// Whether the model is as near as asked, by estimate; true where nothing was asked.
  [[nodiscard]] bool reached() const;

  /// Whether the model is proven to be where it was asked to be; true where nothing was asked.
  [[nodiscard]] bool is_contained() const { return !contained || contained->proof.proven; }
};

[[nodiscard]] std::string readable(const RecoverReport& report);

/// One line.
[[nodiscard]] std::string json(const RecoverReport& report);

}  // namespace verisq::command_line
