/// `verisq recover`: a model from a point cloud or a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/report_files.hpp"

namespace verisq::command_line {

/// As typed; `run_recover` checks what depends on several options.
struct RecoverArguments {
  std::string points;  ///< empty when `mesh` is given
  std::string mesh;    ///< empty when `points` is given
  std::string output;
  std::optional<std::size_t> primitives;
  std::optional<double> deviation;
  bool taper = false;
  bool bend = false;
  std::optional<double> outliers;
  bool inside = false;
  bool outside = false;
  std::uint64_t seed = 1;
  std::string units;
  std::string device = "auto";
  bool no_proof = false;
  ReportFiles report;
  bool json = false;
  bool no_progress = false;
};

void declare_recover(Options& options, RecoverArguments& arguments);

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_recover(const RecoverArguments& arguments);

}  // namespace verisq::command_line
