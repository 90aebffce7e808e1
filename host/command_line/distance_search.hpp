/// The distance of models that are bent or built by set operations, with progress, Ctrl-C and a time limit.
#pragma once

#include <optional>
#include <verisq/model.hpp>

#include "host/command_line/distance_summary.hpp"

namespace verisq::command_line {

struct DistanceSearch {
  double tolerance;
  std::optional<double> seconds;  ///< the limit; nothing: none
  bool show_progress;
  bool with_certificate;  ///< what is proven again, and by what, is asked for, too
};

/// As ModelSearch; an early end is told on standard error.
[[nodiscard]] DistanceReport searched_distance(const Model& a, const Model& b, const Pose& pose,
                                               const DistanceSearch& search);

}  // namespace verisq::command_line
