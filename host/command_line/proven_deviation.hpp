/// The deviation of a model and a mesh, one of which a command has just made: proven, with a progress bar.
#pragma once

#include <string>
#include <vector>
#include <verisq/deviation.hpp>

namespace verisq::command_line {

struct ProofArguments {
  std::string device;
  bool no_progress;
  bool statistics;  ///< mean and percentiles, too
};

/// Of the statistics.
inline const std::vector<double> proven_percentiles{95.0};

/// Ctrl-C ends it early.
[[nodiscard]] Deviation proven_deviation(const Model& model, const Mesh& mesh, const ProofArguments& arguments);

}  // namespace verisq::command_line
