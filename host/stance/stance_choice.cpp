/// This file implements the scopes and the caller's choice of stance_results.hpp.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/stance.hpp>

#include "host/errors/refusal.hpp"
#include "host/stance/stance_results.hpp"
#include "verify/numbers/rounding.hpp"

namespace verisq::stance {
namespace {

using Indices = std::set<std::uint32_t>;

void insert(Indices& indices, const Quantity& quantity) {
  if (quantity.parameter) indices.insert(*quantity.parameter);
}

void insert(Indices& indices, const QuantityVector& vector) {
  for (const Quantity& quantity : vector) insert(indices, quantity);
}

/// The names of the parameters for which `has_effect(index)` is false.
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

Scope wrench_scope(const Model& model, std::span<const WrenchEnclosure> sensitivities) {
  const auto has_effect = [&](std::uint32_t i) {
    return std::ranges::any_of(sensitivities[i], [](const Enclosure& derivative) {
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
  std::vector<std::string> idle{
      "friction, which carries nothing", "all velocities, and what depends on them",
      "ends of cylinders: each presses at two points of its axis, and an end may be above the ground"};
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
  return {fmt::format("one cylinder falls alone, lying flat, with the mass of the body {}; nobody stands on it",
                      quotation(body)),
          {"gravity", "normal contact force of this cylinder"},
          {"all other bodies and cylinders", "stance (positions, velocities, axis and place of the cylinder)", "radius",
           "friction and tangential restitution", controller(model), "applied force"},
          without_effect(model, [&](std::uint32_t i) { return active.contains(i); })};
}

namespace {

/// The whole range where the quantity is an uncertain parameter.
Enclosure over(const Quantity& quantity, UncertainSet uncertain) {
  const bool whole = quantity.parameter && std::ranges::find(uncertain, *quantity.parameter) != uncertain.end();
  return whole ? quantity.range : Enclosure{quantity.nominal, quantity.nominal};
}

}  // namespace

std::uint32_t parameter_named(const Model& model, const std::string& name, const std::string& refusal) {
  const auto found = std::ranges::find(model.parameters, name, &Parameter::name);
  if (found != model.parameters.end()) return static_cast<std::uint32_t>(found - model.parameters.begin());
  std::vector<std::string> names;
  for (const Parameter& parameter : model.parameters) names.push_back(parameter.name);
  throw Error(ErrorKind::input, fmt::format(fmt::runtime(refusal), name, fmt::join(names, ", ")));
}

std::vector<std::uint32_t> uncertain_parameters(const Model& model) {
  std::vector<std::uint32_t> uncertain;
  for (std::uint32_t i = 0; i < model.parameters.size(); ++i) {
    if (model.parameters[i].range.width() != 0.0) uncertain.push_back(i);
  }
  return uncertain;
}

std::vector<std::uint32_t> uncertain_parameters(const Model& model, std::span<const std::string> names) {
  std::vector<std::uint32_t> uncertain;
  for (const std::string& name : names) {
    const std::uint32_t index = parameter_named(model, name, "`uncertain`: {} is not one of all, none, {}");
    if (std::ranges::find(uncertain, index) != uncertain.end())
      throw Error(ErrorKind::input, fmt::format("`uncertain`: {} twice", name));
    uncertain.push_back(index);
  }
  std::ranges::sort(uncertain);
  return uncertain;
}

const ContactCylinder& cylinder_of(const Model& model, const std::string& name) {
  const auto found = std::ranges::find(model.cylinders, name, &ContactCylinder::name);
  if (found != model.cylinders.end()) return *found;
  std::vector<std::string> names;
  for (const ContactCylinder& cylinder : model.cylinders) names.push_back(cylinder.name);
  throw Error(ErrorKind::input,
              fmt::format("`bounce`: {} is not one of the cylinders {}", quotation(name, '\''), quotation(names)));
}

Drop drop_of(const Model& model, const ContactCylinder& cylinder, UncertainSet uncertain, double height) {
  const Enclosure stiffness = over(cylinder.stiffness, uncertain);
  if (stiffness.width() > 0.0) {
    throw Error(ErrorKind::input,
                fmt::format("`bounce`: the stiffness of {} is uncertain, and the bounce has an exact one: leave {} out "
                            "of `uncertain`",
                            quotation(cylinder.name, '\''), model.parameters[*cylinder.stiffness.parameter].name));
  }
  return {.mass = over(model.bodies[cylinder.body].mass, uncertain),
          .radius = over(cylinder.radius, uncertain),
          .height = height,
          .gravity = model.gravity,
          .stiffness = stiffness.lo,
          .exponent = cylinder.exponent,
          .restitution = over(cylinder.normal_restitution, uncertain),
          .impact_velocity = over(cylinder.impact_velocity, uncertain)};
}

JointPosition joint_position(const Model& model, const std::string& name, double position) {
  const std::vector<std::string> names = joint_names(model);
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw Error(ErrorKind::input,
                fmt::format("`joint`: {} is not one of {}", quotation(name, '\''), fmt::join(names, ", ")));
  return {static_cast<std::size_t>(found - names.begin()), position};
}

namespace {

template <class Visit>
void for_each(QuantityVector& vector, const Visit& visit) {
  for (Quantity& quantity : vector) visit(quantity);
}

template <class Visit>
void for_each_quantity(Model& model, const Visit& visit) {
  for_each(model.applied.force, visit);
  visit(model.applied.frequency);
  for (Body& body : model.bodies) {
    for_each(body.offset, visit);
    visit(body.mass);
    for_each(body.centre_of_mass, visit);
    for_each(body.inertia, visit);
  }
  for (ContactCylinder& cylinder : model.cylinders) {
    for_each(cylinder.centre, visit);
    for (Quantity* quantity :
         {&cylinder.radius, &cylinder.stiffness, &cylinder.impact_velocity, &cylinder.normal_restitution,
          &cylinder.tangential_restitution, &cylinder.static_friction, &cylinder.dynamic_friction}) {
      visit(*quantity);
    }
  }
}

}  // namespace

Model narrowed(Model model, std::uint32_t parameter, const Enclosure& range) {
  Parameter& narrow = model.parameters[parameter];
  // The reader's requirements on the ends of a range are valid for its parts.
  if (!(range.lo <= range.hi) || !narrow.range.contains(range.lo) || !narrow.range.contains(range.hi)) {
    throw Error(ErrorKind::input, fmt::format("`range`: {}={},{} is not within the file's range [{}, {}]", narrow.name,
                                              range.lo, range.hi, narrow.range.lo, narrow.range.hi));
  }
  narrow.range = range;
  if (!range.contains(narrow.nominal)) narrow.nominal = std::midpoint(range.lo, range.hi);
  for_each_quantity(model, [&](Quantity& quantity) {
    if (quantity.parameter == parameter) quantity = {narrow.nominal, narrow.range, parameter};
  });
  return model;
}

Model narrowed_within(Model model, UncertainSet uncertain, double per_cent) {
  using verify::Direction;
  for (const std::uint32_t i : uncertain) {
    const auto& [name, unit, description, nominal, range] = model.parameters[i];
    if (nominal == 0.0 && range.width() > 0.0) {
      throw Error(ErrorKind::input,
                  fmt::format("`within`: {} is 0 nominally, and no part of that is a range: give it one by `range`, or "
                              "leave it out of `uncertain`",
                              name));
    }
    const double share = verify::divide(per_cent, 100.0, Direction::up);
    const double off = verify::multiply(std::abs(nominal), share, Direction::up);
    const Enclosure part{std::max(range.lo, verify::subtract(nominal, off, Direction::down)),
                         std::min(range.hi, verify::add(nominal, off, Direction::up))};
    model = narrowed(std::move(model), i, part);
  }
  return model;
}

}  // namespace verisq::stance
