/// Looks names up, and says which there are.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <verisq/error.hpp>
#include <verisq/stance_choice.hpp>

namespace verisq::stance {
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
    const std::uint32_t index = parameter_named(model, name, "--uncertain: {} is not one of all, none, {}");
    if (std::ranges::find(uncertain, index) != uncertain.end())
      throw Error(ErrorKind::input, fmt::format("--uncertain: {} twice", name));
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
              fmt::format("--bounce: '{}' is not one of the cylinders {}", name, fmt::join(names, ", ")));
}

Drop drop_of(const Model& model, const ContactCylinder& cylinder, UncertainSet uncertain, double height) {
  const Enclosure stiffness = over(cylinder.stiffness, uncertain);
  if (stiffness.width() > 0.0) {
    throw Error(
        ErrorKind::input,
        fmt::format("--bounce: the stiffness of '{}' is uncertain, and the bounce has an exact one: leave {} out "
                    "of --uncertain",
                    cylinder.name, model.parameters[*cylinder.stiffness.parameter].name));
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
    throw Error(ErrorKind::input, fmt::format("--joint: '{}' is not one of {}", name, fmt::join(names, ", ")));
  return {static_cast<std::size_t>(found - names.begin()), position};
}

}  // namespace verisq::stance
