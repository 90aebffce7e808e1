/// What `verisq path` says: for people, or as one JSON object.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <verisq/path_certificate.hpp>
#include <verisq/path_distance.hpp>

namespace verisq::command_line {

struct PathReport {
  PathDistance found;
  std::size_t poses;
  std::string units;  ///< of both models; empty when not given
  double tolerance;
  double clearance;                                    ///< that was asked for; 0: any
  std::string certificate = {};                        ///< its file; empty without
  std::optional<PathClaims> certified = std::nullopt;  ///< what that proves, which may be less than found
};

/// Whether the moving model is proven to stay apart from the other, by the clearance; by a certificate, too, where
/// there is one.
[[nodiscard]] bool is_free(const PathReport& report);

[[nodiscard]] std::string readable(const PathReport& report);
[[nodiscard]] std::string json(const PathReport& report);

}  // namespace verisq::command_line
