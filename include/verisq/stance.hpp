/// Human stance with uncertain parameters: models, their files, wrenches, sensitivities, motion and bounces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/enclosure.hpp>

namespace verisq::stance {

// A model of human stance: a tree of rigid bodies, contact cylinders, a controller, and numbers that may be uncertain
// (paper §3, docs/stance.md).

/// A number of the model. Where it is a parameter of the analysis, `parameter` is its index in Model::parameters, and
/// `nominal` and `range` are that parameter's. Where it is none, `range` is `nominal` alone: analyses take parameters
/// over ranges, and nothing else.
struct Quantity {
  double nominal = 0.0;
  Enclosure range{0.0, 0.0};  ///< contains `nominal`
  std::optional<std::uint32_t> parameter = {};
};

using QuantityVector = std::array<Quantity, 3>;

/// A parameter that an analysis may treat as uncertain, or differentiate by.
struct Parameter {
  std::string name;         ///< unique: "mp"
  std::string unit;         ///< "kg"; free text
  std::string description;  ///< "pelvis mass"; free text
  double nominal;
  Enclosure range;
};

/// Axes: x forward, y up, z lateral. One degree of freedom each.
enum class JointKind : std::uint8_t { translation, rotation };

struct Joint {
  std::string name;
  JointKind kind;
  std::uint8_t axis;  ///< 0, 1, 2 for x, y, z, in the frame that the joints before it have reached
  double position;    ///< in the stance that is analysed, m or rad
  double velocity;
};

/// A rigid body and the joints that carry it, in their order from the parent on.
struct Body {
  std::string name;
  std::optional<std::uint32_t> parent;  ///< index in Model::bodies, smaller than this body's; the root has none
  QuantityVector offset;                ///< of the first joint, in the parent's frame, m
  std::vector<Joint> joints;
  Quantity mass;                  ///< kg
  QuantityVector centre_of_mass;  ///< in the body's frame, m
  QuantityVector inertia;         ///< principal moments about the centre of mass, axes of the body, kg m^2
};

/// Hunt-Crossley contact of a cylinder with the ground y = 0 (docs/stance.md §4). Of the analyses of the whole body it
/// acts in the motion, and in the equilibrium and the accelerations on the ground by place, axis, radius, stiffness and
/// exponent; a Drop takes mass, normal
/// restitution, impact velocity, stiffness and exponent from it.
struct ContactCylinder {
  std::string name;
  std::uint32_t body;
  QuantityVector centre;       ///< in the body's frame, m
  std::array<double, 3> axis;  ///< in the body's frame, of length 1 as nearly as its numbers say
  Quantity radius;             ///< m
  double half_length;          ///< m
  Quantity stiffness;          ///< k, N / m^n
  double exponent;             ///< n: 1 or 1.5
  Quantity impact_velocity;    ///< v_N, m/s: the speed at which a touch-down has the normal restitution
  Quantity normal_restitution;
  Quantity tangential_restitution;
  Quantity static_friction;
  Quantity dynamic_friction;
  double stribeck_velocity;        ///< v_s, m/s
  double bristle_stiffness = 0.0;  ///< k_t, N/m: of friction that sticks; 0 where the file says nothing of bristles
  double bristle_damping = 0.0;    ///< c_t, N s/m
};

/// PID on one joint: torque = -proportional e - integral (integral of e) - derivative velocity. It acts in the
/// equilibrium, in the motion, and in the accelerations of a body that is let go on the ground.
struct Controller {
  std::uint32_t body;
  std::uint32_t joint;  ///< index in that body's joints
  double proportional;
  double integral;
  double derivative;
};

/// A force that acts as force cos(frequency t) on the point that the root wrench is about: the world's origin, which
/// the root's translations carry along. The analysis is at t = 0.
struct AppliedForce {
  QuantityVector force;  ///< N
  Quantity frequency;    ///< 1/s
};

struct Model {
  double gravity;  ///< m/s^2, along -y
  std::vector<Body> bodies;
  std::vector<ContactCylinder> cylinders;
  std::vector<Controller> controllers;
  AppliedForce applied;
  std::vector<Parameter> parameters;

  [[nodiscard]] std::size_t degrees_of_freedom() const {
    std::size_t count = 0;
    for (const Body& body : bodies) count += body.joints.size();
    return count;
  }
};

/// "pelvis ty": all joints, bodies in order, as results have them.
[[nodiscard]] inline std::vector<std::string> joint_names(const Model& model) {
  std::vector<std::string> names;
  for (const Body& body : model.bodies) {
    for (const Joint& joint : body.joints) names.push_back(body.name + " " + joint.name);
  }
  return names;
}

// Reads stance models (XML).

/// Throws Error(input) with one line naming file, line and value for everything that is no such model: XML errors,
/// unknown elements and attributes, missing ones, numbers that are not finite, reversed ranges, names that are used
/// twice or unknown, masses and radii that are not positive.
[[nodiscard]] Model read_model(const std::filesystem::path& path);

/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Model parse_model(std::string_view xml, std::string_view name);

// Verified uncertainty analysis of a stance model: wrench, sensitivities, reference uncertainty, accelerations
// (docs/stance.md).

/// How much the evaluation knows of dependencies.
enum class Mode : std::uint8_t {
  paper,  ///< as the paper's program: the expression of w6 in which px occurs three times
  tight,  ///< each parameter once, monotonicity, subdivision
};

/// Components of the wrench of gravity and the applied force on the root of the tree at rest, without ground contact,
/// friction and controller, in the order of the paper's w1 ... w6: forces along x, y,
/// z are w1, w2, w3 (N), moments about x, y, z are w4, w5, w6 (N m): see docs/stance.md §1 for the paper's labels.
constexpr std::size_t wrench_size = 6;
using WrenchEnclosure = std::array<Enclosure, wrench_size>;

/// Indices of parameters that take their whole range; all others are at their nominal value.
using UncertainSet = std::span<const std::uint32_t>;

[[nodiscard]] WrenchEnclosure wrench(const Model& model, UncertainSet uncertain, Mode mode);

/// Partial derivatives of the wrench by parameter, over the box of the uncertain set.
[[nodiscard]] WrenchEnclosure sensitivity(const Model& model, UncertainSet uncertain, std::uint32_t parameter,
                                          Mode mode);

/// Sum over the parameters of |derivative| times the parameter.
struct ReferenceUncertainty {
  WrenchEnclosure by_value;                   ///< the paper's: times the parameter's range
  std::array<double, wrench_size> by_radius;  ///< times half its width, rounded up: half the width of w, to first order
};
[[nodiscard]] ReferenceUncertainty reference_uncertainty(const Model& model, UncertainSet derivatives_over,
                                                         UncertainSet parameters, Mode mode);

/// The same with given derivatives, those by parameters[i] in derivatives[i]: rounded as a table prints them, for
/// instance.
[[nodiscard]] ReferenceUncertainty reference_uncertainty(const Model& model, UncertainSet parameters,
                                                         std::span<const WrenchEnclosure> derivatives);

/// The wrench at one sample of the uncertain parameters, in plain floating point.
[[nodiscard]] std::array<double, wrench_size> sampled_wrench(const Model& model, std::span<const double> parameters);

/// The situation of the body whose accelerations are sought.
enum class AccelerationCase : std::uint8_t {
  fall,      ///< it falls freely from the file's posture: no contact, friction and controller
  contact,   ///< let go at rest in the file's posture, the ground and the controllers' proportional parts act
  standing,  ///< at rest in its nominal equilibrium, held by the torques of that
};

/// A key: "fall", "contact", "standing".
[[nodiscard]] constexpr std::string_view to_string(AccelerationCase at) {
  switch (at) {
    case AccelerationCase::fall: return "fall";
    case AccelerationCase::contact: return "contact";
    case AccelerationCase::standing: break;
  }
  return "standing";
}

/// Another posture than the file's.
struct JointPosition {
  std::size_t joint;  ///< among all, bodies in order
  double position;    ///< m or rad
};

/// Where the body is, how it moves and what acts on it but gravity and the applied force. Numbers of all joints.
struct Instant {
  std::vector<Enclosure> positions;  ///< m or rad
  std::vector<double> velocities;    ///< m/s or rad/s
  std::vector<Enclosure> torques;    ///< N m or N
  bool on_ground = false;            ///< the ground presses on the cylinders; only for a body at rest
};

/// - fall: the file's posture and velocities, no torques.
/// - contact: the file's posture at rest; a joint that `elsewhere` moves off the file's position by e has the torque
///   -proportional e of its controller.
/// - standing: the nominal body in equilibrium on all of its cylinders, joints held where the file or `elsewhere` has
///   them, with the torques that hold it (stance_equilibrium.hpp); enclosed, which adds some 1e-9 to the accelerations.
/// Throws Error(input) for a joint that the model lacks or that is given twice; for a cylinder that stands upright on
/// the ground; where the nominal body is not proven to stand, or a joint has no integral control to hold it; for an
/// equilibrium whose own unknowns, the root's height and tilt, are given.
[[nodiscard]] Instant instant(const Model& model, AccelerationCase at, std::span<const JointPosition> elsewhere = {});

struct AccelerationOptions {
  std::uint32_t cells = 64;  ///< the finest division of each uncertain parameter's range, rounded up to a power of 2
  std::function<bool()> interrupted = {};              ///< ends the division: the enclosures are wider then
  std::function<void(double fraction)> progress = {};  ///< of the work, about; never falls
};

/// Enclosures of all joint accelerations at the instant under gravity, the applied force at t = 0 and what the instant
/// says, over the box of parameters: posture and torques are the same for all of them. The ground presses as in
/// `equilibrium`, where it is touched, and carries nothing by friction: the bristles of a body at rest are not
/// stretched yet. Each end is sought by branch and bound, with Krawczyk's operator on each cell (docs/stance.md §3),
/// until a sample comes within a hundredth of the component's width of it, or its cells are as fine as asked for, or
/// 20,000 cells were examined in all. Infinite ends where nothing could be proven. The result does not depend on the
/// number of cores. Precondition: the instant is of the model.
[[nodiscard]] std::vector<Enclosure> accelerations(const Model& model, UncertainSet uncertain, const Instant& at,
                                                   const AccelerationOptions& options);

/// In free fall.
[[nodiscard]] std::vector<Enclosure> accelerations(const Model& model, UncertainSet uncertain,
                                                   const AccelerationOptions& options);

/// The same at one sample, in plain floating point, in the middle of the instant's posture.
[[nodiscard]] std::vector<double> sampled_accelerations(const Model& model, const Instant& at,
                                                        std::span<const double> parameters);
[[nodiscard]] std::vector<double> sampled_accelerations(const Model& model, std::span<const double> parameters);

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
