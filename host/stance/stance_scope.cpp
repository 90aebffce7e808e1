/// The analyses, each with the numbers of the model that its equations have.
#include "host/stance/stance_scope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace verisq::stance {
namespace {

using Indices = std::set<std::uint32_t>;

void insert(Indices& indices, const Quantity& quantity) {
  if (quantity.parameter) indices.insert(*quantity.parameter);
}

void insert(Indices& indices, const QuantityVector& vector) {
  for (const Quantity& quantity : vector) insert(indices, quantity);
}

/// Names of the parameters of which `has_effect(index)` is false.
template <class Predicate>
std::vector<std::string> without_effect(const Model& model, const Predicate& has_effect) {
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < model.parameters.size(); ++i) {
    if (!has_effect(i)) names.push_back(model.parameters[i].name);
  }
  return names;
}

std::string ground_contact(const Model& model) {
  return fmt::format("ground contact (cylinders: {})", model.cylinders.size());
}

std::string controller(const Model& model) {
  return fmt::format("controller (joints: {})", model.controllers.size());
}

}  // namespace

Scope wrench_scope(const Model& model, UncertainSet uncertain, Mode mode) {
  const auto has_effect = [&](std::uint32_t i) {
    return std::ranges::any_of(sensitivity(model, uncertain, i, mode), [](const Enclosure& derivative) {
      return derivative != Enclosure{0.0, 0.0};
    });
  };
  return {"the weight of all bodies and the applied force, as one wrench, at rest; the feet stand on nothing",
          {"gravity", "applied force at t = 0"},
          {ground_contact(model), "friction", controller(model), "joint velocities", "inertia"},
          without_effect(model, has_effect)};
}

namespace {

Indices active_in_accelerations(const Model& model, AccelerationCase at) {
  Indices active;
  insert(active, model.applied.force);
  for (const Body& body : model.bodies) {
    insert(active, body.offset);
    insert(active, body.mass);
    insert(active, body.centre_of_mass);
    insert(active, body.inertia);
  }
  if (at == AccelerationCase::fall) return active;
  for (const ContactCylinder& cylinder : model.cylinders) {
    insert(active, cylinder.centre);
    insert(active, cylinder.radius);
    insert(active, cylinder.stiffness);
  }
  return active;
}

std::string meaning_of_accelerations(AccelerationCase at) {
  switch (at) {
    case AccelerationCase::fall:
      return "the body falls freely with its joints loose and its legs hanging; the feet stand on nothing";
    case AccelerationCase::contact:
      return "the body is let go at rest in the posture of the file and --joint, on what of the ground its cylinders "
             "touch there; nothing is said of whether it stands";
    case AccelerationCase::standing: break;
  }
  return "the body with other parameters, at rest in the posture and with the torques in which the nominal one is in "
         "equilibrium: how it begins to move from there";
}

}  // namespace

Scope acceleration_scope(const Model& model, AccelerationCase at) {
  const Indices active = active_in_accelerations(model, at);
  Scope scope{meaning_of_accelerations(at),
              {"gravity", "applied force at t = 0", "inertia"},
              {},
              without_effect(model, [&](std::uint32_t i) { return active.contains(i); })};
  if (at == AccelerationCase::fall) {
    scope.acts.emplace_back("joint velocities");
    scope.does_not_act = {ground_contact(model), "friction", controller(model)};
    return scope;
  }
  scope.acts.emplace_back("elastic force of all cylinders that touch the ground");
  scope.acts.emplace_back(at == AccelerationCase::contact
                              ? "proportional part of the controller, of joints that --joint moves"
                              : "torques that hold the nominal body");
  scope.does_not_act = {"friction, whose bristles are not stretched yet",
                        "joint velocities, and what depends on them (damping of contact and controller)"};
  if (at == AccelerationCase::contact) scope.does_not_act.emplace_back("integral part of the controller");
  return scope;
}

namespace {

Indices active_in_equilibrium(const Model& model) {
  Indices active;
  insert(active, model.applied.force[1]);
  for (const Body& body : model.bodies) {
    insert(active, body.offset);
    insert(active, body.mass);
    insert(active, body.centre_of_mass);
  }
  for (const ContactCylinder& cylinder : model.cylinders) {
    insert(active, cylinder.centre);
    insert(active, cylinder.radius);
    insert(active, cylinder.stiffness);
  }
  return active;
}

}  // namespace

Scope equilibrium_scope(const Model& model, JointControl control) {
  const Indices active = active_in_equilibrium(model);
  std::vector<std::string> acts{"gravity", "vertical applied force at t = 0", "elastic force of all cylinders"};
  if (control == JointControl::proportional) acts.emplace_back("proportional part of the controller");
  std::vector<std::string> idle{"friction, which carries nothing", "all velocities, and what depends on them"};
  idle.emplace_back(control == JointControl::held ? "controller: what holds the joints is told"
                                                  : "integral and derivative parts of the controller");
  return {
      control == JointControl::held
          ? "the body is in equilibrium on all of its cylinders, its joints where the file has them; whether it stays "
            "there or topples is NOT said here (--stability does)"
          : "the body is in equilibrium on all of its cylinders, its joints turned as the proportional gains allow; "
            "whether it stays there or topples is NOT said here (--stability does)",
      std::move(acts), std::move(idle), without_effect(model, [&](std::uint32_t i) { return active.contains(i); })};
}

Scope stability_scope(const Model& model, JointControl control) {
  Indices active = active_in_equilibrium(model);
  for (const Body& body : model.bodies) insert(active, body.inertia);
  for (const ContactCylinder& cylinder : model.cylinders) {
    insert(active, cylinder.normal_restitution);
    insert(active, cylinder.impact_velocity);
  }
  std::vector<std::string> acts{"gravity", "vertical applied force at t = 0", "inertia",
                                "elastic and damping force of all cylinders", "friction that sticks, by its bristles"};
  acts.emplace_back(control == JointControl::held ? "all parts of the controller"
                                                  : "proportional and derivative parts of the controller");
  std::vector<std::string> idle{"friction that slips: the feet stay where they stand, for small disturbances",
                                "how large a disturbance may be: NOT said"};
  if (control == JointControl::proportional) idle.emplace_back("integral part of the controller");
  return {
      "whether the body returns to rest after small disturbances of its equilibrium, by the eigenvalues of its "
      "linearised motion",
      std::move(acts), std::move(idle), without_effect(model, [&](std::uint32_t i) { return active.contains(i); })};
}

namespace {

std::string beginning_of(const MotionOptions& options) {
  if (options.drop) {
    return fmt::format(
        "let go at rest in the file's posture, its lowest sole {} m above the ground, the controllers' "
        "integrals those of its nominal equilibrium",
        *options.drop);
  }
  if (options.lift != 0.0) return fmt::format("let go at rest {} m above its nominal equilibrium", options.lift);
  return "from its nominal equilibrium on";
}

}  // namespace

Scope motion_scope(const Model& model, const MotionOptions& options) {
  Indices active;
  const auto planar = [&](const QuantityVector& v) {
    insert(active, v[0]);
    insert(active, v[1]);
  };
  planar(model.applied.force);
  insert(active, model.applied.frequency);
  for (const Body& body : model.bodies) {
    planar(body.offset);
    insert(active, body.mass);
    planar(body.centre_of_mass);
    insert(active, body.inertia[2]);
  }
  for (const ContactCylinder& cylinder : model.cylinders) {
    planar(cylinder.centre);
    for (const Quantity* quantity :
         {&cylinder.radius, &cylinder.stiffness, &cylinder.impact_velocity, &cylinder.normal_restitution,
          &cylinder.static_friction, &cylinder.dynamic_friction})
      insert(active, *quantity);
  }
  return {"the body moves in its sagittal plane, both legs alike, " + beginning_of(options),
          {"gravity", "inertia", "contact with its damping", "friction with bristles", "controller", "applied force",
           "push"},
          {"motion out of the sagittal plane", "tangential restitution"},
          without_effect(model, [&](std::uint32_t i) { return active.contains(i); })};
}

Scope bounce_scope(const Model& model, const ContactCylinder& cylinder) {
  const std::string& body = model.bodies[cylinder.body].name;
  Indices active;
  insert(active, model.bodies[cylinder.body].mass);
  insert(active, cylinder.stiffness);
  insert(active, cylinder.normal_restitution);
  insert(active, cylinder.impact_velocity);
  return {
      fmt::format("one cylinder falls alone, lying flat, with the mass of the body '{}'; nobody stands on it", body),
      {"gravity", "normal contact force of this cylinder"},
      {"all other bodies and cylinders", "stance (positions, velocities, axis and place of the cylinder)", "radius",
       "friction and tangential restitution", controller(model), "applied force"},
      without_effect(model, [&](std::uint32_t i) { return active.contains(i); })};
}

}  // namespace verisq::stance
