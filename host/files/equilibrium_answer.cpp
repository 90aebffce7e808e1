/// Claims by the names of the model, parts as a whole tree.
#include "host/files/equilibrium_answer.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/files/certificate_fields.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

using stance::EquilibriumPart;
using stance::JointControl;
using stance::Standing;

/// Finite, and not empty.
Enclosure read_range(const JsonValue& lo, const JsonValue& hi) {
  const Enclosure range{lo.number(), hi.number()};
  if (range.lo > range.hi) hi.fail("must not be below the lower end");
  return range;
}

std::string read_new_name(const JsonValue& value, const std::vector<std::string>& names) {
  std::string name = value.name();
  if (std::ranges::find(names, name) != names.end()) value.fail("is named before");
  return name;
}

/// [{"parameter", "lo", "hi"}, ...]
void read_uncertain(const JsonValue& value, EquilibriumAnswer& answer) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    const JsonValue parameter = value.element(i);
    parameter.check_keys({"parameter", "lo", "hi"});
    answer.parameters.push_back(read_new_name(parameter.at("parameter"), answer.parameters));
    answer.claims.uncertain.push_back(static_cast<std::uint32_t>(i));
    answer.claims.ranges.push_back(read_range(parameter.at("lo"), parameter.at("hi")));
  }
}

void read_joints(const JsonValue& value, EquilibriumAnswer& answer, Standing& standing) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    const JsonValue joint = value.element(i);
    joint.check_keys({"joint", "position", "torque"});
    answer.joints.push_back(read_new_name(joint.at("joint"), answer.joints));
    standing.positions.push_back(read_claim(joint.at("position")));
    standing.torques.push_back(read_claim(joint.at("torque")));
  }
}

void read_cylinders(const JsonValue& value, EquilibriumAnswer& answer, Standing& standing) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    const JsonValue cylinder = value.element(i);
    cylinder.check_keys({"cylinder", "force", "penetration"});
    answer.cylinders.push_back(read_new_name(cylinder.at("cylinder"), answer.cylinders));
    standing.loads.push_back({read_claim(cylinder.at("force")), read_claim(cylinder.at("penetration"))});
  }
}

Standing read_standing(const JsonValue& value, EquilibriumAnswer& answer) {
  value.check_keys({"joints", "cylinders", "centre_of_pressure", "least_penetration"});
  Standing standing{};
  read_joints(value.at("joints"), answer, standing);
  read_cylinders(value.at("cylinders"), answer, standing);
  const JsonValue pressure = value.at("centre_of_pressure");
  pressure.check_keys({"x", "z"});
  standing.centre_of_pressure_x = read_claim(pressure.at("x"));
  standing.centre_of_pressure_z = read_claim(pressure.at("z"));
  standing.least_penetration = read_claim(value.at("least_penetration"));
  return standing;
}

EquilibriumPart read_part(const JsonValue& value, std::size_t parameters) {
  value.check_keys({"halved", "postures"});
  EquilibriumPart part;
  if (const auto halved = value.find("halved")) {
    part.halved = read_index(*halved);
    if (*part.halved >= parameters) halved->fail("must be the index of an uncertain parameter");
  }
  const auto postures = value.find("postures");
  if (!postures) return part;
  if (part.halved) postures->fail("must not be of a part that is halved");
  if (postures->size() == 0) postures->fail("must not be empty");
  for (std::size_t i = 0; i < postures->size(); ++i) {
    const JsonValue range = postures->element(i);
    if (range.size() != 2) range.fail("must be an array of 2 numbers");
    part.postures.push_back(read_range(range.element(0), range.element(1)));
  }
  return part;
}

/// In preorder, all of one tree.
std::vector<EquilibriumPart> read_parts(const JsonValue& value, std::size_t parameters) {
  std::vector<EquilibriumPart> parts;
  std::size_t expected = 1;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (expected == 0) value.element(i).fail("is beyond the last part of the box");
    parts.push_back(read_part(value.element(i), parameters));
    expected += parts.back().halved ? 1U : 0U;
    expected -= parts.back().halved ? 0U : 1U;
  }
  if (expected > 0) value.fail("must have two parts for each that is halved");
  return parts;
}

JointControl read_control(const JsonValue& value) {
  if (value.text() == "held") return JointControl::held;
  if (value.text() != "proportional") value.fail("must be \"held\" or \"proportional\"");
  return JointControl::proportional;
}

}  // namespace

EquilibriumAnswer read_equilibrium(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "joints", "uncertain", "stands", "standing", "reference", "parts"});
  const JsonValue models = root.at("models");
  if (models.size() != 1) models.fail("must be an array of one model");
  EquilibriumAnswer answer;
  answer.model = read_subject_file(models.element(0));
  answer.claims.control = read_control(root.at("joints"));
  read_uncertain(root.at("uncertain"), answer);
  const JsonValue stands = root.at("stands");
  answer.claims.stands = nonnegative_number(stands);
  if (answer.claims.stands > 1.0) stands.fail("must be at most 1");
  if (const auto standing = root.find("standing")) answer.claims.standing = read_standing(*standing, answer);
  answer.certificate.reference = finite_numbers<3>(root.at("reference"));
  answer.certificate.parts = read_parts(root.at("parts"), answer.parameters.size());
  return answer;
}

}  // namespace verisq
