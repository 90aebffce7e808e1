/// What `verisq distance` says about one pose: for people, or as one JSON object.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <verisq/model_distance.hpp>

namespace verisq::command_line {

struct DistanceReport {
  Enclosure distance;
  Proximity proximity;
  bool uncertain = false;  ///< a model gives intervals: the enclosure holds for all members; no points, no certificate
  bool searched = false;   ///< by branch and bound: no closest points
  bool interrupted = false;  ///< Ctrl-C came before the tolerance was reached
  bool complete = true;      ///< of certificates: neither that nor the time limit came before all pairs were looked at
  std::optional<Point> common = std::nullopt;
  std::optional<std::array<Point, 2>> near_points = std::nullopt;  ///< of a search; each in its model's own frame
  std::optional<ClosestPoints> closest = std::nullopt;
  std::optional<PairCertificate> certificate = std::nullopt;  ///< where it was asked for
  std::optional<Enclosure> certified = std::nullopt;  ///< of a search: what that proves, which may be less than found
  std::string units = {};                             ///< of both models; empty when not given
  double tolerance = 0.0;
  bool tightest = false;  ///< of a tolerance of 0: the enclosure is as tight as the method gives
};

/// Whether the user got what --tol asked for, of a certificate, too.
[[nodiscard]] inline bool is_verified(const DistanceReport& report) {
  if (report.certified && !verified(*report.certified, report.tolerance)) return false;
  return report.tightest || verified(report.distance, report.tolerance);
}

[[nodiscard]] std::string readable(const DistanceReport& report);

/// JSON has no infinity: an unbounded upper end is null.
[[nodiscard]] std::string json(const DistanceReport& report);

}  // namespace verisq::command_line
