/// This file implements sagittal_model.hpp.
#include "verify/stance/sagittal_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "verify/numbers/interval.hpp"
#include "verify/proof/equilibrium_checker.hpp"
#include "verify/stance/rnea.hpp"
#include "verify/stance/standing.hpp"

namespace verisq::stance {
namespace {

[[noreturn]] void refuse_motion(const std::string& what) {
  throw Error(ErrorKind::input, "simulation in the sagittal plane: " + what);
}

/// What two names have in common from a word on: "right femur" and "left femur" give "femur".
std::string common_name(const std::string& a, const std::string& b) {
  const auto [end, unused] = std::mismatch(a.rbegin(), a.rend(), b.rbegin(), b.rend());
  const std::string suffix(end.base(), a.end());
  if (suffix.size() == a.size()) return a;
  const std::size_t space = suffix.find(' ');
  return space == std::string::npos || space + 1 == suffix.size() ? a : suffix.substr(space + 1);
}

class Pairing {
 public:
  Pairing(const Model& model, UncertainSet uncertain)
      : model_(model), uncertain_(uncertain), result_{model, {}, {}, {}} {}

  [[nodiscard]] SagittalModel run() {
    if (model_.bodies.empty() || model_.cylinders.empty())
      refuse_motion("a model needs bodies and cylinders to stand on");
    place_.resize(model_.bodies.size());
    for (std::uint32_t i = 0; i < model_.bodies.size(); ++i) {
      if (!place_[i]) add_body(i);
    }
    for (std::uint32_t i = 0; i < model_.cylinders.size(); ++i) add_cylinder(i);
    check_applied();
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool is_uncertain(const Quantity& q) const {
    if (!q.parameter || std::ranges::find(uncertain_, *q.parameter) == uncertain_.end()) return false;
    return q.range.lo < q.range.hi;
  }

  [[nodiscard]] bool is_certain(const Quantity& q, double value) const {
    return !is_uncertain(q) && q.nominal == value;
  }

  [[nodiscard]] bool equal(const Quantity& a, const Quantity& b) const {
    if (is_uncertain(a) || is_uncertain(b)) return a.parameter == b.parameter;
    return a.nominal == b.nominal;
  }

  void add_body(std::uint32_t i) {
    const Body& body = model_.bodies[i];
    const std::optional<std::uint32_t> mate = mate_of(i);
    check_in_plane(body, mate.has_value());
    SagittalBody added{i, {}, mate ? 2.0 : 1.0, {}};
    if (body.parent) added.parent = place_[*body.parent];
    place_[i] = result_.bodies.size();
    if (mate) place_[*mate] = place_[i];
    if (body.parent) {
      add_joint_of(i, mate, added);
    } else {
      add_root(added);
    }
    result_.bodies.push_back(added);
  }

  /// The body on the other side.
  [[nodiscard]] std::optional<std::uint32_t> mate_of(std::uint32_t i) const {
    const Body& body = model_.bodies[i];
    if (!body.parent) return std::nullopt;
    const std::size_t parent = *place_[*body.parent];
    const bool beside = result_.bodies[parent].copies == 2.0;
    if (!beside && is_certain(body.offset[2], 0.0)) return std::nullopt;
    for (std::uint32_t j = i + 1; j < model_.bodies.size(); ++j) {
      const Body& other = model_.bodies[j];
      if (place_[j] || !other.parent || place_[*other.parent] != parent) continue;
      if (beside == (other.parent == body.parent)) continue;
      if (mirrored(i, j)) return j;
    }
    refuse_motion(fmt::format("the body {} has no mirror image: the same on the other side", body.name));
  }

  [[nodiscard]] bool mirrored(std::uint32_t i, std::uint32_t j) const {
    const Body& a = model_.bodies[i];
    const Body& b = model_.bodies[j];
    const auto alike = [&](const QuantityVector& u, const QuantityVector& v) {
      return equal(u[0], v[0]) && equal(u[1], v[1]);
    };
    if (is_uncertain(a.offset[2]) || is_uncertain(b.offset[2]) || a.offset[2].nominal != -b.offset[2].nominal)
      return false;
    const bool same_joints = std::ranges::equal(a.joints, b.joints, [](const Joint& p, const Joint& q) {
      return p.kind == q.kind && p.axis == q.axis && p.position == q.position;
    });
    if (!same_joints || !alike(a.offset, b.offset) || !alike(a.centre_of_mass, b.centre_of_mass)) return false;
    if (!equal(a.mass, b.mass) || !equal(a.inertia[2], b.inertia[2])) return false;
    const std::optional<std::size_t> turned = turning_joint(a);
    if (!turned) return true;
    const Controller p = controller_of(i, *turned);
    const Controller q = controller_of(j, *turned);
    return p.proportional == q.proportional && p.integral == q.integral && p.derivative == q.derivative;
  }

  /// A body's centre of mass lies in the plane that its leg moves in; joints across the plane are straight.
  void check_in_plane(const Body& body, bool beside) const {
    if (!is_certain(body.centre_of_mass[2], 0.0))
      refuse_motion(fmt::format("the centre of mass of {} is off its plane: z must be 0 and not uncertain", body.name));
    const bool first_of_leg = beside && result_.bodies[*place_[*body.parent]].copies == 1.0;
    if (!first_of_leg && !is_certain(body.offset[2], 0.0))
      refuse_motion(fmt::format("the joints of {} are off the plane of its leg: the offset's z must be 0", body.name));
    for (const Joint& joint : body.joints) {
      if (!is_sagittal(joint) && joint.position != 0.0)
        refuse_motion(fmt::format("the joint {} {} leads out of the plane: its position is {}, not 0", body.name,
                                  joint.name, joint.position));
    }
  }

  [[nodiscard]] static bool is_sagittal(const Joint& joint) {
    return joint.kind == JointKind::rotation ? joint.axis == 2 : joint.axis != 2;
  }

  [[nodiscard]] static std::optional<std::size_t> turning_joint(const Body& body) {
    const auto turns = [](const Joint& joint) { return joint.kind == JointKind::rotation && joint.axis == 2; };
    const auto found = std::ranges::find_if(body.joints, turns);
    if (found == body.joints.end()) return std::nullopt;
    return static_cast<std::size_t>(found - body.joints.begin());
  }

  [[nodiscard]] Controller controller_of(std::uint32_t body, std::size_t joint) const {
    for (const Controller& controller : model_.controllers) {
      if (controller.body == body && controller.joint == joint) return controller;
    }
    return {body, static_cast<std::uint32_t>(joint), 0.0, 0.0, 0.0};
  }

  [[nodiscard]] SagittalJoint joint_at(std::uint32_t body, std::size_t joint, double copies) const {
    const Controller controller = controller_of(body, joint);
    const Joint& of_model = model_.bodies[body].joints[joint];
    return {model_.bodies[body].name + " " + of_model.name,
            of_model.position,
            copies * controller.proportional,
            copies * controller.integral,
            copies * controller.derivative,
            {joint_index(model_, body, joint)}};
  }

  void add_root(SagittalBody& root) {
    const Body& body = model_.bodies[root.body];
    std::vector<std::size_t> found;
    for (std::size_t j = 0; j < body.joints.size(); ++j) {
      if (is_sagittal(body.joints[j])) found.push_back(j);
    }
    const auto is = [&](std::size_t k, JointKind kind, std::uint8_t axis) {
      return body.joints[found[k]].kind == kind && body.joints[found[k]].axis == axis;
    };
    if (found.size() != 3 || !is(0, JointKind::translation, 0) || !is(1, JointKind::translation, 1) ||
        !is(2, JointKind::rotation, 2))
      refuse_motion(fmt::format("{} needs translations along x and y and then a rotation about z", body.name));
    for (const std::size_t j : found) result_.joints.push_back(joint_at(root.body, j, 1.0));
    root.joint = 2;
  }

  void add_joint_of(std::uint32_t i, const std::optional<std::uint32_t>& mate, SagittalBody& added) {
    const Body& body = model_.bodies[i];
    const std::optional<std::size_t> turned = turning_joint(body);
    const auto sagittal = std::ranges::count_if(body.joints, is_sagittal);
    if (sagittal != (turned ? 1 : 0))
      refuse_motion(fmt::format("{} has joints in the plane besides one rotation about z", body.name));
    if (!turned) return;
    added.joint = result_.joints.size();
    SagittalJoint joint = joint_at(i, *turned, added.copies);
    if (mate) {
      joint.name = common_name(body.name, model_.bodies[*mate].name) + " " + body.joints[*turned].name;
      joint.joints.push_back(joint_index(model_, *mate, *turned));
    }
    result_.joints.push_back(joint);
  }

  void add_cylinder(std::uint32_t i) {
    const ContactCylinder& cylinder = model_.cylinders[i];
    const SagittalBody& body = result_.bodies[*place_[cylinder.body]];
    if (std::abs(cylinder.axis[2]) != 1.0 || cylinder.axis[0] != 0.0 || cylinder.axis[1] != 0.0 ||
        !is_certain(cylinder.centre[2], 0.0))
      refuse_motion(
          fmt::format("the cylinder {} must lie along z with its middle in the plane of its body", cylinder.name));
    if (!(cylinder.bristle_stiffness > 0.0) || !(cylinder.bristle_damping > 0.0))
      refuse_motion(fmt::format("the cylinder {} needs bristle_stiffness and bristle_damping", cylinder.name));
    if (body.body != cylinder.body) {
      check_is_mirrored(cylinder);
      return;
    }
    std::string name = cylinder.name;
    if (body.copies == 2.0) name = common_name(name, mirror_image(cylinder, i).name);
    result_.contacts.push_back({i, name, *place_[cylinder.body]});
  }

  [[nodiscard]] bool alike(const ContactCylinder& a, const ContactCylinder& b) const {
    const auto same = [&](const Quantity ContactCylinder::*quantity) { return equal(a.*quantity, b.*quantity); };
    return equal(a.centre[0], b.centre[0]) && equal(a.centre[1], b.centre[1]) && same(&ContactCylinder::radius) &&
           same(&ContactCylinder::stiffness) && a.exponent == b.exponent && same(&ContactCylinder::impact_velocity) &&
           same(&ContactCylinder::normal_restitution) && same(&ContactCylinder::static_friction) &&
           same(&ContactCylinder::dynamic_friction) && a.stribeck_velocity == b.stribeck_velocity &&
           a.bristle_stiffness == b.bristle_stiffness && a.bristle_damping == b.bristle_damping;
  }

  /// As many like it on the other side as on its own: then each has one of its own.
  [[nodiscard]] const ContactCylinder& mirror_image(const ContactCylinder& cylinder, std::uint32_t index) const {
    const ContactCylinder* image = nullptr;
    int balance = 0;
    for (const ContactCylinder& other : model_.cylinders) {
      if (place_[other.body] != place_[cylinder.body] || !alike(cylinder, other)) continue;
      balance += other.body == cylinder.body ? 1 : -1;
      if (other.body != cylinder.body && image == nullptr) image = &other;
    }
    if (image == nullptr || balance != 0)
      refuse_motion(
          fmt::format("the cylinder {} has no mirror image: the same on the other side", model_.cylinders[index].name));
    return *image;
  }

  void check_is_mirrored(const ContactCylinder& cylinder) const {
    for (const ContactCylinder& other : model_.cylinders) {
      if (place_[other.body] == place_[cylinder.body] && other.body != cylinder.body && alike(cylinder, other)) return;
    }
    refuse_motion(fmt::format("the cylinder {} has no mirror image: the same on the other side", cylinder.name));
  }

  void check_applied() const {
    if (!is_certain(model_.applied.force[2], 0.0)) refuse_motion("the applied force's z must be 0 and not uncertain");
  }

  const Model& model_;
  UncertainSet uncertain_;
  SagittalModel result_;
  std::vector<std::optional<std::size_t>> place_;  ///< of each body of the model in the result
};

}  // namespace

SagittalModel sagittal_model(const Model& model, UncertainSet uncertain) {
  return Pairing(model, uncertain).run();
}

namespace {

using verify::Interval;

/// Half of the range's width.
Interval radius(const Enclosure& range) {
  return (Interval(range.hi) - Interval(range.lo)) / Interval(2);
}

}  // namespace

ReferenceUncertainty reference_uncertainty(const Model& model, UncertainSet parameters,
                                           std::span<const WrenchEnclosure> derivatives) {
  ReferenceUncertainty result;
  for (std::size_t k = 0; k < wrench_size; ++k) {
    Interval by_value = 0;
    Interval by_radius = 0;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Enclosure& range = model.parameters[parameters[i]].range;
      const Interval magnitude = abs(Interval(derivatives[i][k].lo, derivatives[i][k].hi));
      by_value += magnitude * Interval(range.lo, range.hi);
      by_radius += magnitude * radius(range);
    }
    result.by_value[k] = {by_value.lower(), by_value.upper()};
    result.by_radius[k] = by_radius.upper();
  }
  return result;
}

ReferenceUncertainty reference_uncertainty(const Model& model, UncertainSet derivatives_over, UncertainSet parameters,
                                           Mode mode) {
  std::vector<WrenchEnclosure> derivatives;
  derivatives.reserve(parameters.size());
  for (const std::uint32_t parameter : parameters) {
    derivatives.push_back(sensitivity(model, derivatives_over, parameter, mode));
  }
  return reference_uncertainty(model, parameters, derivatives);
}

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
