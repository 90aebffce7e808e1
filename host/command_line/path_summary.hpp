/// What `verisq path` says: for people, or as one JSON object.
#pragma once

#include <cstddef>
#include <string>
#include <verisq/path_distance.hpp>

namespace verisq::command_line {

struct PathReport {
  PathDistance found;
  std::size_t poses;
  std::string units;  ///< of both models; empty when not given
  double tolerance;
  double clearance;  ///< that was asked for; 0: any
};

/// Whether the moving model is proven to stay apart from the other, by the clearance.
[[nodiscard]] bool is_free(const PathReport& report);

[[nodiscard]] std::string readable(const PathReport& report);
[[nodiscard]] std::string json(const PathReport& report);

}  // namespace verisq::command_line
