/// The distance of two models of which one moves along a path of poses, at all times and not at the poses alone.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

enum class PathProximity : std::uint8_t {
  apart,      ///< proven: no common point at any time
  meeting,    ///< proven: a common point at some time
  undecided,  ///< neither: they touch, or nearly
};

struct PathDistanceOptions {
  /// Largest width of the smallest distance, in model units, >= 0; at least 2^-43 of the largest length at hand.
  double tolerance;
  double time_tolerance = 1e-6;  ///< of the first contact, in times from one pose to the next, > 0
  std::function<bool()> interrupted = {};
  /// Called now and then with what is proven so far of the smallest distance, and how many moments were looked at.
  std::function<void(const Enclosure& smallest, std::uint64_t moments)> progress = {};
};

/// Time k is that of pose k.
struct PathDistance {
  Enclosure smallest;  ///< contains the smallest distance of all times: [0, 0] if they are proven to meet
  double smallest_at;  ///< a time at which the distance is at most `smallest.hi`
  PathProximity proximity;
  double apart_before;            ///< proven: no common point at any time before; the end of the path if `apart`
  std::optional<double> meet_at;  ///< a common point is proven at this time: the first contact is not later
  /// `smallest` is at most the tolerance wide, and of a meeting the first contact is known to the time tolerance.
  bool reached;
  bool interrupted;
  std::uint64_t moments;  ///< at which distances were enclosed
};

/// B moves by the poses, after its primitives' own, A rests in its frame. Between two poses the translation is linear
/// in time and the rotation turns about a fixed axis at constant speed, by the smaller angle; a single pose is a body
/// at rest. Proven between the poses by how far directions still separate the primitives, where both models are unions
/// of convex ones, else, which takes more moments, by how fast points move (docs/mathematics.md §26). Throws
/// Error(input) for a path without poses, for poses that are not finite or have a zero quaternion, for half a turn from
/// one pose to the next, which has two ways, for tolerances that are negative or no numbers, and for a model that is
/// proven to have no point at all.
[[nodiscard]] PathDistance distance_along(std::span<const Pose> path, const Model& a, const Model& b,
                                          const PathDistanceOptions& options);

}  // namespace verisq
