/// Postures and torques of the cases in which accelerations are sought.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/stance_analysis.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "verify/equilibrium/standing_model.hpp"
#include "verify/stance/kinematics.hpp"
#include "verify/stance/standing_equations.hpp"
#include "verify/stance/standing_problem.hpp"

namespace verisq::stance {
namespace {

void require_instant(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, message);
}

Enclosure exactly(double number) {
  return {number, number};
}

Enclosure ends(const Interval& a) {
  return {a.lower(), a.upper()};
}

/// A joint's place among the bodies, and its name in messages.
struct NamedJoint {
  std::size_t body;
  const Joint* joint;
  std::string name;
};

std::vector<NamedJoint> named_joints(const Model& model) {
  std::vector<NamedJoint> result;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    for (const Joint& joint : model.bodies[i].joints)
      result.push_back({i, &joint, model.bodies[i].name + " " + joint.name});
  }
  return result;
}

/// With these joints elsewhere.
Model moved(Model model, std::span<const JointPosition> elsewhere) {
  const std::vector<NamedJoint> joints = named_joints(model);
  std::vector<bool> given(joints.size(), false);
  for (const auto& [joint, position] : elsewhere) {
    require_instant(joint < joints.size(), fmt::format("accelerations: the model has no joint {}", joint));
    require_instant(std::isfinite(position),
                    fmt::format("accelerations: {} is to be at {}", joints[joint].name, position));
    require_instant(!given[joint], fmt::format("accelerations: {} is given twice", joints[joint].name));
    given[joint] = true;
    const std::size_t first = joint_index(model, joints[joint].body, 0);
    model.bodies[joints[joint].body].joints[joint - first].position = position;
  }
  return model;
}

/// The point of the ground's force on an upright cylinder jumps from one end of its axis to the other.
void refuse_upright_cylinders(const Model& model, const std::vector<Enclosure>& positions) {
  constexpr double least = 1e-12;  // of sin^2
  std::vector<double> at;
  at.reserve(positions.size());
  for (const Enclosure& position : positions) at.push_back(std::midpoint(position.lo, position.hi));
  const std::vector<BodyPose<double>> poses =
      forward_kinematics(tree_of<double>(model, nominal_parameters<double>(model), at));
  for (const ContactCylinder& cylinder : model.cylinders) {
    const Vector3<double> axis = poses[cylinder.body].orientation * standing_details::exact<double>(cylinder.axis);
    require_instant(1.0 - axis[1] * axis[1] > least,
                    fmt::format("accelerations: the axis of the cylinder {} is vertical in this posture, where the "
                                "law of contact has no one point",
                                cylinder.name));
  }
}

Instant in_posture_of(const Model& model) {
  Instant at;
  for (const NamedJoint& joint : named_joints(model)) {
    at.positions.push_back(exactly(joint.joint->position));
    at.velocities.push_back(joint.joint->velocity);
  }
  at.torques.assign(at.positions.size(), exactly(0.0));
  return at;
}

Instant on_ground(Instant at) {
  std::ranges::fill(at.velocities, 0.0);
  at.on_ground = true;
  return at;
}

/// The controllers want the positions of `file`; no time has passed for their integrals.
Instant touching(const Model& file, const Model& posture) {
  Instant at = on_ground(in_posture_of(posture));
  const std::vector<NamedJoint> wanted = named_joints(file);
  for (const Controller& controller : file.controllers) {
    const std::size_t j = joint_index(file, controller.body, controller.joint);
    const Interval error = Interval(at.positions[j].lo) - Interval(wanted[j].joint->position);
    at.torques[j] = ends(Interval(at.torques[j].lo, at.torques[j].hi) - Interval(controller.proportional) * error);
  }
  return at;
}

bool is_held_by_integral(const Model& model, std::size_t joint) {
  return std::ranges::any_of(model.controllers, [&](const Controller& controller) {
    return joint_index(model, controller.body, controller.joint) == joint && controller.integral != 0.0;
  });
}

/// Of the root's height and its tilts.
bool is_sought(const NamedJoint& joint) {
  constexpr std::uint8_t vertical = 1;
  return joint.body == 0 && (joint.joint->kind == JointKind::translation) == (joint.joint->axis == vertical);
}

/// As the motion of `simulate` begins.
Instant standing_still(const Model& model, std::span<const JointPosition> elsewhere) {
  const std::vector<NamedJoint> joints = named_joints(model);
  for (const JointPosition& given : elsewhere)
    require_instant(
        !is_sought(joints[given.joint]),
        fmt::format("accelerations: {} is what the equilibrium says, and not to be given", joints[given.joint].name));
  const Equilibrium nominal = equilibrium(model, {}, {.control = JointControl::held});
  require_instant(nominal.standing && nominal.stands == 1.0,
                  "accelerations: the nominal body is not proven to stand on all of its cylinders");
  Instant at = on_ground(in_posture_of(model));
  at.positions = nominal.standing->positions;
  const std::size_t of_root = model.bodies.front().joints.size();
  for (std::size_t j = of_root; j < at.torques.size(); ++j) {
    at.torques[j] = nominal.standing->torques[j];
    require_instant(is_held_by_integral(model, j) || at.torques[j] == exactly(0.0),
                    fmt::format("accelerations: {} has no integral control, which is to hold it", joints[j].name));
  }
  return at;
}

}  // namespace

Instant instant(const Model& model, AccelerationCase at, std::span<const JointPosition> elsewhere) {
  const Model posture = moved(model, elsewhere);
  if (at == AccelerationCase::fall) return in_posture_of(posture);
  const Instant result =
      at == AccelerationCase::contact ? touching(model, posture) : standing_still(posture, elsewhere);
  refuse_upright_cylinders(model, result.positions);
  return result;
}

}  // namespace verisq::stance
