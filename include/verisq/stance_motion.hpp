/// The motion of a standing body, and of one that bounces; what a caller chooses of a stance model.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/stance.hpp>

namespace verisq::stance {

// A verified drop and bounce of one contact cylinder (docs/stance.md §6).

/// A cylinder that lies along z, alone, falls on the ground y = 0 under gravity. The ground pushes with
/// k delta^n max(0, 1 + D delta'/v_N), where D follows from the restitution: Hunt-Crossley, exponent n of 1 or 1.5.
/// Numbers in an Enclosure are any within: each bounce has one of them all the while.
struct Drop {
  Enclosure mass;             ///< kg; above 0
  Enclosure radius;           ///< m; acts on nothing: the lowest point falls by the height whatever the radius
  double height;              ///< of the lowest point above the ground at rest, m; above 0
  double gravity;             ///< m/s^2
  double stiffness;           ///< k, N / m^n
  double exponent;            ///< n, 1 or 1.5
  Enclosure restitution;      ///< e_N in (0, 1), at touch-down with the speed v_N
  Enclosure impact_velocity;  ///< v_N, m/s; above 0
};

/// Contains the bounces for all numbers of the drop.
struct Bounce {
  Enclosure touch_down_time, touch_down_speed;  ///< s, m/s
  /// A body that stays on the ground has rebound speed 0. Where it may, the time's upper end is infinite, and the lower
  /// end is that of the bodies that lift off, if any may.
  Enclosure lift_off_time, rebound_speed;
  Enclosure deepest_penetration;    ///< m
  Enclosure effective_restitution;  ///< rebound speed by touch-down speed
  double steps;                     ///< of the verified integration
  bool proven;                      ///< false: the integration gave up; ends may then be infinite
};

struct BounceOptions {
  double relative_tolerance = 1e-6;  ///< of the local error, to the rebound speed that it would have without gravity
  std::function<bool()> interrupted = {};
};

/// Not proven, with infinite ends, for a drop that is none: never throws for numbers.
[[nodiscard]] Bounce bounce(const Drop& drop, const BounceOptions& options = {});

// How a body that stands moves in the sagittal plane, proven (docs/stance.md §9).

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

/// The contact of a cylinder, or of each one of a pair that moves alike.
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

// The parts of a stance model that an analysis takes, chosen by name: uncertain parameters, a cylinder to be dropped.

/// All parameters that have a deviation; the others are certain.
[[nodiscard]] std::vector<std::uint32_t> uncertain_parameters(const Model& model);

/// Those of these names, in the model's order. Throws Error(input) that names `verisq stance --uncertain` for a name
/// that the model does not have, or twice.
[[nodiscard]] std::vector<std::uint32_t> uncertain_parameters(const Model& model, std::span<const std::string> names);

/// `refusal` is the message of the Error(input) for a name that the model does not have, with {} for the name and for
/// those that there are.
[[nodiscard]] std::uint32_t parameter_named(const Model& model, const std::string& name, const std::string& refusal);

/// The model with a part of a parameter's range, in which a nominal value that lies outside becomes the midpoint.
/// Throws Error(input) for a range that is no part of the parameter's.
[[nodiscard]] Model narrowed(Model model, std::uint32_t parameter, const Enclosure& range);

/// Narrows each uncertain parameter to the part of its range that is at most `per_cent` of the nominal value off it,
/// rounded outward. Throws Error(input) for a nominal value of 0, which has no parts.
[[nodiscard]] Model narrowed_within(Model model, UncertainSet uncertain, double per_cent);

/// Throws Error(input) for a name that no cylinder has.
[[nodiscard]] const ContactCylinder& cylinder_of(const Model& model, const std::string& name);

/// The cylinder alone, with the mass of its body, from `height` (m, above 0): its numbers take their whole range where
/// they are uncertain. Throws Error(input) where its stiffness is: a drop has an exact one.
[[nodiscard]] Drop drop_of(const Model& model, const ContactCylinder& cylinder, UncertainSet uncertain, double height);

/// The joint of that name at a position. Throws Error(input), naming `verisq stance --joint`, for a name that no joint
/// has.
[[nodiscard]] JointPosition joint_position(const Model& model, const std::string& name, double position);

}  // namespace verisq::stance
