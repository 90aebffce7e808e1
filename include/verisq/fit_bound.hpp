/// How good a fit can be at best: a proven upper bound of the objective over all poses of a range (docs/mathematics.md
/// §24).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/best_fit_certificate.hpp>
#include <verisq/cavity.hpp>
#include <verisq/fit.hpp>
#include <verisq/fitness.hpp>
#include <verisq/model.hpp>

namespace verisq {

struct FitBoundProgress {
  double upper;         ///< proven so far
  std::uint64_t boxes;  ///< of poses, looked at so far
  std::uint64_t open;   ///< that may still hold something better
};

struct FitBoundOptions {
  Fitness fitness;
  double penetration_limit;  ///< at the cavity's points; >= 0, model units
  PoseRange range;
  double known;                 ///< objective of a known pose, finite
  double gap;                   ///< what is to be proven, in (0, 1): known >= (1 - gap) upper
  std::string device = "auto";  ///< as MapOptions::device: proves depths in the implants
  std::function<bool()> interrupted = [] { return false; };  ///< polled a few times a second; true: ends with what is
                                                             ///< proven by then
  std::function<bool()> out_of_time = [] { return false; };  ///< likewise
  std::function<void(const FitBoundProgress&)> progress = [](const FitBoundProgress&) {};
};

/// A pose that the bound came across. Nothing of it is proven.
struct PromisingPose {
  std::size_t implant;  ///< index in the series
  Pose pose;
  double objective;  ///< about
};

struct FitBound {
  double upper;  ///< proven: no implant of the series in any pose of the range whose points are all within the limit
                 ///< has a larger objective; -infinity: there is no such pose
  bool reached;  ///< the gap
  bool interrupted;
  bool out_of_time;
  std::uint64_t boxes;                     ///< of poses, looked at
  std::optional<PromisingPose> promising;  ///< the best that was met and seems better than what is known
  std::string device;                      ///< that proved depths, or "host"
  /// How each implant's range was halved, in preorder, as `BestFitCertificate` has it; of one that was not begun, not
  /// at all.
  std::vector<std::vector<PoseDivision>> divisions;
};

/// Branch and bound over the poses of every implant. The limit holds at the points alone: sides, triangles and
/// constraints of a fit leave fewer poses, so that the bound is one of theirs, too. Throws Error(input) for sizes that
/// are intervals, for implants that are not unions of convex primitives, for an empty series or cavity, for options out
/// of their ranges and as `fit`.
[[nodiscard]] FitBound bound_fit(std::span<const UncertainModel> series, const Cavity& cavity,
                                 const FitBoundOptions& options);

}  // namespace verisq
