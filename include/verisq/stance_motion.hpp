/// How a body that stands moves in the sagittal plane, proven (docs/stance.md §9).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>
#include <verisq/stance_analysis.hpp>

namespace verisq::stance {

/// A force along x on the model's reference point, where the applied force acts: from `start`, for `duration`, force
/// sin^2(pi (t - start) / duration).
struct Push {
  double force;     ///< N, at its greatest
  double start;     ///< s, not negative
  double duration;  ///< s, above 0
};

struct MotionOptions {
  double duration;    ///< s, above 0
  double lift = 0.0;  ///< m: how far above its equilibrium the body is let go
  /// m, not negative: instead it is let go in the file's posture, which need not be that of the equilibrium, the lowest
  /// point of its cylinders so far above the ground, to rounding.
  std::optional<double> drop = {};
  std::optional<Push> push = {};
  std::function<bool()> interrupted = {};
  std::function<void(double fraction)> progress = {};
};

/// Of a cylinder, or each of a pair that moves alike.
struct MotionContact {
  Enclosure normal;    ///< upward on the cylinder, N
  Enclosure friction;  ///< along x on the cylinder, N
};

/// Contains all motions, for all parameters of the box, at all times of it.
struct MotionSlab {
  double from, to;                    ///< s
  std::vector<Enclosure> positions;   ///< of Motion::joints, m or rad
  std::vector<Enclosure> velocities;  ///< m/s or rad/s
  std::vector<MotionContact> contacts;
};

struct Motion {
  std::vector<std::string> joints;    ///< "pelvis tx", "femur rz"; of a pair without its side
  std::vector<std::string> contacts;  ///< of cylinders, likewise
  std::vector<MotionSlab> slabs;      ///< one after the other, from 0 to `reached`
  std::vector<Enclosure> positions;   ///< at `reached`
  std::vector<Enclosure> velocities;
  double reached = 0.0;  ///< s: from there on nothing is proven
  bool proven = false;   ///< all of the duration
  bool interrupted = false;
  std::string open = {};  ///< why it ended before, in words; empty where it did not
};

/// Starts at rest, bristles at 0, in the equilibrium of the nominal parameters with the joints held where the file has
/// them, by the integrals, or lifted from there, or dropped with these integrals. Gravity, the applied force, the push,
/// contact, friction and the controllers act. Throws Error(input) for a model that is not mirror-symmetric, has no such
/// proven equilibrium, or whose controllers cannot hold it.
[[nodiscard]] Motion simulate(const Model& model, UncertainSet uncertain, const MotionOptions& options);

}  // namespace verisq::stance
