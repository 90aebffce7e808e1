/// A model of human stance: a tree of rigid bodies, contact cylinders, a controller, and numbers that may be uncertain
/// (paper §3, docs/stance.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>

namespace verisq::stance {

/// A number of the model. Where it is a parameter of the analysis, `parameter` is its index in Model::parameters, and
/// `nominal` and `range` are that parameter's. Where it is none, `range` is `nominal` alone: analyses take parameters
/// over ranges, and nothing else.
struct Quantity {
  double nominal = 0.0;
  Enclosure range{0.0, 0.0};  ///< contains `nominal`
  std::optional<std::uint32_t> parameter = {};
};

using QuantityVector = std::array<Quantity, 3>;

/// What an analysis may treat as uncertain, or differentiate by.
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

}  // namespace verisq::stance
