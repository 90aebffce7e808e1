/// The closest points of many points, and of two models in many poses, by all processors of the host.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <verisq/closest_point.hpp>
#include <verisq/columns.hpp>
#include <verisq/model.hpp>
#include <verisq/model_distance.hpp>
#include <verisq/signed_distance.hpp>

namespace verisq {

struct ClosestPointOptions {
  /// Of distances where no closest point is proven, as that of SignedDistance; model units.
  double tolerance;
  /// What is known of these distances; then nothing is searched for. Empty, or as many as points.
  std::span<const Enclosure> known = {};
  /// Polled by several threads; once true, it must stay true, and ends the work early. Empty: never.
  std::function<bool()> interrupted = {};
};

/// What was found of many points.
struct ClosestPointSummary {
  std::size_t points = 0;      ///< finished rows, from the front: all unless interrupted
  std::size_t unique = 0;      ///< of these
  double widest_point = 0.0;   ///< of the boxes of unique ones, the widest of their intervals, in model units
  double widest_normal = 0.0;  ///< of points only
  bool interrupted = false;

  [[nodiscard]] bool operator==(const ClosestPointSummary&) const = default;
};

/// Row i is SignedDistance::closest_point of point i; rows that are not finished are valid, and say no more than what
/// is known. Throws Error(input) unless there are as many rows as points, and for a point that is not finite.
ClosestPointSummary closest_points(const SignedDistance& distance, const PointColumns& points,
                                   std::span<ClosestPoint> rows, const ClosestPointOptions& options);

/// Row i is PairDistance::closest_points for pose i; where that says nothing, the models not being proven separate, and
/// in rows that are not finished, the boxes are infinite. Throws Error(input) unless there are as many rows as poses.
ClosestPointSummary closest_points(const PairDistance& distance, std::span<const Pose> poses,
                                   std::span<ClosestPoints> rows, const std::function<bool()>& interrupted = {});

/// Of finished rows.
[[nodiscard]] ClosestPointSummary summary_of(std::span<const ClosestPoint> rows);
[[nodiscard]] ClosestPointSummary summary_of(std::span<const ClosestPoints> rows);

/// Of the rows of both.
[[nodiscard]] ClosestPointSummary joined(const ClosestPointSummary& a, const ClosestPointSummary& b);

}  // namespace verisq
