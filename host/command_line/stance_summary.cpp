/// The output of `verisq stance`, and its page.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/command_line/stance_command.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/report/html_report.hpp"
#include "host/stance/stance_results.hpp"
#include "report/page_template.hpp"

namespace verisq::command_line {
namespace {

using namespace stance;

constexpr std::array<std::string_view, wrench_size> component_words{
    "force along x", "force along y", "force along z", "moment about x", "moment about y", "moment about z"};

std::string_view component_unit(std::size_t component) {
  return component < 3 ? "N" : "N m";
}

std::string_view word(Mode mode) {
  return mode == Mode::paper ? "paper" : "tight";
}

/// The kinds of all joints, bodies in order.
std::vector<JointKind> joint_kinds(const stance::Model& model) {
  std::vector<JointKind> kinds;
  for (const Body& body : model.bodies) {
    for (const Joint& joint : body.joints) kinds.push_back(joint.kind);
  }
  return kinds;
}

std::string_view acceleration_unit(JointKind kind) {
  return kind == JointKind::rotation ? "rad/s^2" : "m/s^2";
}

bool is_zero(const Enclosure& enclosure) {
  return enclosure == Enclosure{0.0, 0.0};
}

/// One line: numbers as the file gives them, which decimals hold to the last bit.
std::string parameter_text(const Parameter& parameter) {
  const std::string unit = parameter.unit == "1" ? "" : parameter.unit;
  const std::string description = parameter.description.empty() ? "" : quotation(parameter.description);
  return fmt::format("  {:<8}{:<15} {:<6}{}\n", parameter.name,
                     fmt::format("[{}, {}]", parameter.range.lo, parameter.range.hi), unit, description);
}

/// How much of enclosure k the samples fill; nothing without samples.
std::string filled_text(const std::optional<Samples>& samples, std::size_t k, const Enclosure& claimed) {
  if (!samples || samples->count == 0) return "";
  return fmt::format("  {:5.1f} % filled", 100.0 * filled_part(samples->hull[k], claimed));
}

std::string samples_text(const std::optional<Samples>& samples) {
  if (!samples) return "";
  return fmt::format("  {} samples, none escapes\n", samples->count);
}

std::string uncertain_text(const StanceSummary& summary) {
  if (summary.uncertain.empty()) return "nothing is uncertain\n";
  std::string text = "uncertain\n";
  for (const std::uint32_t i : summary.uncertain) text += parameter_text(summary.model.parameters[i]);
  return text;
}

/// Without blanks at the ends of lines.
std::string stripped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n') result.erase(result.find_last_not_of(' ') + 1);
    result += c;
  }
  return result;
}

/// The meaning and the limits of the numbers above it.
std::string scope_text(const Scope& scope) {
  std::string text = fmt::format("  meaning: {}\n  acts: {}\n  does NOT act: {}\n", scope.meaning,
                                 fmt::join(scope.acts, ", "), fmt::join(scope.does_not_act, ", "));
  if (scope.parameters_without_effect.empty()) return text;
  return text + fmt::format("  parameters without effect here: {}\n", fmt::join(scope.parameters_without_effect, ", "));
}

std::string wrench_text(const StanceSummary& summary) {
  std::string text = fmt::format("\nwrench on the root, {} mode\n", word(summary.mode));
  for (std::size_t k = 0; k < wrench_size; ++k) {
    const Enclosure& enclosure = (*summary.wrench)[k];
    text += fmt::format("  {}  {:<15} {:<4}{:<30}{}\n", component_name(k), component_words[k], component_unit(k),
                        outward_digits(enclosure), filled_text(summary.wrench_samples, k, enclosure));
  }
  return text + scope_text(summary.wrench_scope) + samples_text(summary.wrench_samples);
}

std::string sensitivities_text(const StanceSummary& summary) {
  std::string text = "\nsensitivities (those not listed are exactly 0)\n";
  for (std::size_t i = 0; i < summary.sensitivities.size(); ++i) {
    for (std::size_t k = 0; k < wrench_size; ++k) {
      const Enclosure& enclosure = summary.sensitivities[i][k];
      if (is_zero(enclosure)) continue;
      text += fmt::format("  d{}/d{:<8}{}\n", component_name(k), summary.model.parameters[i].name,
                          outward_digits(enclosure));
    }
  }
  return text;
}

std::string reference_text(const ReferenceUncertainty& reference) {
  std::string text = fmt::format("\nreference uncertainty\n  {:<8}{:<32}{}\n", "", "r: |dw/dp| p",
                                 "|dw/dp| times half the width of p");
  for (std::size_t k = 0; k < wrench_size; ++k) {
    text += fmt::format("  {:<8}{:<32}{}\n", component_name(k), outward_digits(reference.by_value[k]),
                        upper_digits(reference.by_radius[k]));
  }
  return text;
}

std::string_view words(AccelerationCase at) {
  switch (at) {
    case AccelerationCase::fall: return "in free fall";
    case AccelerationCase::contact: return "in contact with the ground";
    case AccelerationCase::standing: break;
  }
  return "at the nominal equilibrium";
}

std::string accelerations_text(const StanceSummary& summary) {
  std::string text = fmt::format("\njoint accelerations {}\n", words(summary.acceleration_case));
  const std::vector<std::string> names = stance::joint_names(summary.model);
  const std::vector<JointKind> kinds = joint_kinds(summary.model);
  for (const auto& [joint, position] : summary.elsewhere)
    text += fmt::format("  at {} {}: {}\n", position, kinds[joint] == JointKind::rotation ? "rad" : "m",
                        quotation(names[joint]));
  for (std::size_t k = 0; k < summary.accelerations.size(); ++k) {
    const Enclosure& enclosure = summary.accelerations[k];
    text += fmt::format("  {:<34}{:<8}{}  {}\n", outward_digits(enclosure), acceleration_unit(kinds[k]),
                        filled_text(summary.acceleration_samples, k, enclosure), quotation(names[k]));
  }
  return text + scope_text(summary.acceleration_scope) + samples_text(summary.acceleration_samples);
}

std::string_view word(JointControl control) {
  return control == JointControl::held ? "held" : "proportional";
}

/// Rounded down: only all of the box is 100 % of it.
std::string share_text(double share) {
  return fmt::format("{:.7g} % of the box", std::floor(1e7 * share) / 1e5);
}

std::string standing_text(const StanceSummary& summary, const Standing& standing) {
  std::string text;
  const auto line = [&](const std::string& name, std::string_view unit, const Enclosure& enclosure) {
    text += fmt::format("  {:<34}{:<6}{}\n", outward_digits(enclosure), unit, name);
  };
  const std::vector<std::string> names = joint_names(summary.model);
  const std::vector<JointKind> kinds = joint_kinds(summary.model);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (standing.positions[k].width() > 0.0)
      line(fmt::format("position of {}", quotation(names[k])), kinds[k] == JointKind::rotation ? "rad" : "m",
           standing.positions[k]);
  }
  for (std::size_t c = 0; c < standing.loads.size(); ++c) {
    line(fmt::format("force on {}", quotation(summary.model.cylinders[c].name)), "N", standing.loads[c].force);
    line("its penetration", "m", standing.loads[c].penetration);
  }
  line("least penetration of all points", "m", standing.least_penetration);
  line("centre of pressure, x", "m", standing.centre_of_pressure_x);
  line("centre of pressure, z", "m", standing.centre_of_pressure_z);
  for (std::size_t k = summary.model.bodies.front().joints.size(); k < names.size(); ++k)
    line(fmt::format("torque of {}", quotation(names[k])), kinds[k] == JointKind::rotation ? "N m" : "N",
         standing.torques[k]);
  return text;
}

std::string certificate_text(const StanceSummary& summary) {
  if (!summary.certified) return {};
  return fmt::format("  certificate: proves {}; its own ranges are in it, and in JSON: {}\n",
                     share_text(summary.certified->stands), quotation(summary.certificate));
}

std::string equilibrium_text(const StanceSummary& summary) {
  const Equilibrium& found = *summary.equilibrium;
  std::string text = fmt::format("\nequilibrium on the ground, joints {}\n", word(summary.control));
  text += fmt::format("  proven to have an equilibrium on all cylinders: {}\n", share_text(found.stands));
  text += fmt::format("  proven not to, within {:g} rad of the file's posture and {:g} m of its feet's height: {}\n",
                      equilibrium_reach_of_tilt, equilibrium_reach_of_height, share_text(found.not_on_all));
  text += fmt::format("  open: {}\n", share_text(found.open));
  if (found.standing) text += standing_text(summary, *found.standing);
  return text + certificate_text(summary) + scope_text(summary.equilibrium_scope);
}

std::string eigenvalues_text(const std::vector<EigenvalueEnclosure>& eigenvalues) {
  constexpr std::size_t most_lines = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(most_lines, eigenvalues.size()); ++i) {
    const EigenvalueEnclosure& eigenvalue = eigenvalues[i];
    const bool is_real = eigenvalue.imaginary == Enclosure{0.0, 0.0};
    text += fmt::format("    {}{}{}\n", outward_digits(eigenvalue.real),
                        is_real ? "" : " + i " + outward_digits(eigenvalue.imaginary),
                        eigenvalue.count == 1 ? "" : fmt::format(", {} of them", eigenvalue.count));
  }
  if (eigenvalues.size() <= most_lines) return "  eigenvalues, 1/s\n" + text;
  return fmt::format("  rightmost eigenvalues, 1/s (JSON has all)\n{}", text);
}

std::string stability_text(const StanceSummary& summary) {
  const Stability& found = *summary.stability;
  std::string text = fmt::format("\nstability of the equilibrium, joints {}\n", word(summary.stability_control));
  text += fmt::format("  proven stable, small disturbances die out: {}\n", share_text(found.stable));
  text += fmt::format("  proven unstable, some grow however small they are: {}\n", share_text(found.unstable));
  text += fmt::format("  open: {}\n", share_text(found.open));
  if (found.growth.lo <= found.growth.hi)
    text += fmt::format("  greatest rate of growth (below 0: of decay), 1/s  {}\n", outward_digits(found.growth));
  if (!found.eigenvalues.empty()) text += eigenvalues_text(found.eigenvalues);
  return text + scope_text(summary.stability_scope);
}

std::string motion_text(const StanceSummary& summary) {
  const Motion& motion = *summary.motion;
  std::string text = fmt::format("\nmotion in the sagittal plane, proven from 0 to {} s{}\n",
                                 lower_digits(motion.reached), motion.proven ? "" : "; from there on OPEN");
  if (!motion.open.empty()) text += fmt::format("  open: {}\n", motion.open);
  text += fmt::format("  {:<40}{:<40}then of\n", "position, m or rad", "velocity, m/s or rad/s");
  for (std::size_t j = 0; j < motion.joints.size(); ++j)
    text += fmt::format("  {:<40}{:<40}{}\n", outward_digits(motion.positions[j]), outward_digits(motion.velocities[j]),
                        quotation(motion.joints[j]));
  for (std::size_t c = 0; c < motion.contacts.size(); ++c) {
    Enclosure all = motion.slabs.empty() ? Enclosure{0.0, infinity} : motion.slabs.front().contacts[c].normal;
    for (const MotionSlab& slab : motion.slabs) {
      all.lo = std::min(all.lo, slab.contacts[c].normal.lo);
      all.hi = std::max(all.hi, slab.contacts[c].normal.hi);
    }
    text += fmt::format("  within {} N all the while, force on each {}\n", outward_digits(all),
                        quotation(motion.contacts[c]));
  }
  return text + scope_text(summary.motion_scope);
}

std::string reconstructed_text(const Cell& cell) {
  if (cell.reconstructed.empty()) return "";
  return fmt::format(" (reconstructed: {})", fmt::join(cell.reconstructed, ", "));
}

std::string table_text(const PaperTable& table) {
  std::string text = fmt::format("{}\n  {:<4}{:<12}{:<24}{:<24}verdict\n", table.title, "", "", "verisq", "paper");
  for (const Cell& cell : table.cells) {
    text +=
        fmt::format("  {:<4}{:<12}{:<24}{:<24}{}{}{}{}\n", cell.row, cell.column, stance::text(cell.ours), cell.printed,
                    stance::word(cell.verdict), cell.reason.empty() ? "" : ": ", cell.reason, reconstructed_text(cell));
  }
  return text + "\n";
}

std::string paper_text(const PaperReport& report) {
  std::string text =
      "Directed rounding to the second digit. w1, w2 are forces (N), w4, w6 moments (N m): the paper's labels are "
      "swapped.\n"
      "The wrench is that of gravity and the applied force alone: ground contact, friction and controller do NOT act.\n"
      "'reconstructed' names constants that enter a cell and that the paper does not give: they were chosen so that "
      "the\n"
      "model reproduces Tables 2 to 4. That such a cell matches is no evidence for these constants.\n\n";
  for (const PaperTable& table : report.tables) text += table_text(table);
  text +=
      "  The paper's r multiplies sensitivities that are rounded first. From unrounded ones, and as half the width\n"
      "  of w to first order:\n";
  for (const std::size_t k : {0, 1, 3, 5}) {
    text += fmt::format("  {:<16}{:<24}{}\n", component_name(k),
                        stance::text(rounded_outward(report.unrounded.by_value[k])),
                        upper_digits(report.unrounded.by_radius[k]));
  }
  return text;
}

std::string bounce_text(const StanceSummary& summary) {
  const Bounce& bounce = *summary.bounce;
  std::string text = fmt::format("\ndropped from {:g} m: {}\n", summary.drop->height, quotation(summary.dropped));
  const auto line = [&](std::string_view name, std::string_view unit, const Enclosure& enclosure) {
    text += fmt::format("  {:<24}{:<6}{}\n", name, unit, outward_digits(enclosure));
  };
  line("mass", "kg", summary.drop->mass);
  line("normal restitution", "", summary.drop->restitution);
  line("impact velocity v_N", "m/s", summary.drop->impact_velocity);
  line("touch-down time", "s", bounce.touch_down_time);
  line("touch-down speed", "m/s", bounce.touch_down_speed);
  line("deepest penetration", "m", bounce.deepest_penetration);
  line("lift-off time", "s", bounce.lift_off_time);
  line("rebound speed", "m/s", bounce.rebound_speed);
  line("effective restitution", "", bounce.effective_restitution);
  text += scope_text(summary.bounce_scope);
  text += fmt::format("  {} steps{}\n", bounce.steps, bounce.proven ? "" : "; NOT proven");
  return text;
}

JsonObject json_of(const Scope& scope) {
  return {{"meaning", scope.meaning},
          {"acts", scope.acts},
          {"does_not_act", scope.does_not_act},
          {"parameters_without_effect", scope.parameters_without_effect}};
}

JsonValue json_with_samples(const Enclosure& enclosure, const std::optional<Samples>& samples, std::size_t k) {
  if (!samples || samples->count == 0) return enclosure;
  return JsonObject{{"lo", enclosure.lo},
                    {"hi", enclosure.hi},
                    {"sampled", samples->hull[k]},
                    {"filled", filled_part(samples->hull[k], enclosure)}};
}

JsonObject json_of(const WrenchEnclosure& wrench, const std::optional<Samples>& samples = std::nullopt) {
  JsonObject object;
  for (std::size_t k = 0; k < wrench_size; ++k) object.set(component_name(k), json_with_samples(wrench[k], samples, k));
  return object;
}

JsonValue json_of_parameters(const stance::Model& model) {
  JsonValue::Array array;
  for (const Parameter& parameter : model.parameters) {
    array.push_back(JsonObject{{"name", parameter.name},
                               {"unit", parameter.unit},
                               {"description", parameter.description},
                               {"nominal", parameter.nominal},
                               {"lo", parameter.range.lo},
                               {"hi", parameter.range.hi}});
  }
  return array;
}

JsonObject json_of_sensitivities(const StanceSummary& summary) {
  JsonObject object;
  for (std::size_t i = 0; i < summary.sensitivities.size(); ++i) {
    object.set(summary.model.parameters[i].name, json_of(summary.sensitivities[i]));
  }
  return object;
}

JsonObject json_of(const ReferenceUncertainty& reference) {
  JsonObject radius;
  for (std::size_t k = 0; k < wrench_size; ++k) radius.set(component_name(k), reference.by_radius[k]);
  return {{"by_value", json_of(reference.by_value)}, {"by_radius", radius}};
}

JsonObject json_of_accelerations(const StanceSummary& summary) {
  JsonObject object;
  const std::vector<std::string> names = stance::joint_names(summary.model);
  for (std::size_t k = 0; k < summary.accelerations.size(); ++k) {
    object.set(names[k], json_with_samples(summary.accelerations[k], summary.acceleration_samples, k));
  }
  return object;
}

/// Positions by joint.
JsonObject json_of_elsewhere(const StanceSummary& summary) {
  JsonObject object;
  const std::vector<std::string> names = stance::joint_names(summary.model);
  for (const auto& [joint, position] : summary.elsewhere) object.set(names[joint], position);
  return object;
}

JsonObject json_of(const Standing& standing, const stance::Model& model) {
  JsonObject positions;
  JsonObject torques;
  const std::vector<std::string> names = joint_names(model);
  for (std::size_t k = 0; k < names.size(); ++k) {
    positions.set(names[k], standing.positions[k]);
    torques.set(names[k], standing.torques[k]);
  }
  JsonObject loads;
  for (std::size_t c = 0; c < standing.loads.size(); ++c) {
    loads.set(model.cylinders[c].name,
              JsonObject{{"force", standing.loads[c].force}, {"penetration", standing.loads[c].penetration}});
  }
  return {
      {"positions", positions},
      {"torques", torques},
      {"cylinders", loads},
      {"least_penetration", standing.least_penetration},
      {"centre_of_pressure", JsonObject{{"x", standing.centre_of_pressure_x}, {"z", standing.centre_of_pressure_z}}}};
}

/// Each with its verdict and its part of the uncertain parameters' box.
template <class Cells>
JsonValue::Array json_of_cells(const Cells& cells, const StanceSummary& summary) {
  JsonValue::Array array;
  for (const auto& cell : cells) {
    JsonObject ranges;
    for (std::size_t k = 0; k < cell.ranges.size(); ++k)
      ranges.set(summary.model.parameters[summary.uncertain[k]].name, cell.ranges[k]);
    array.push_back(JsonObject{{"verdict", to_string(cell.verdict)}, {"parameters", ranges}});
  }
  return array;
}

JsonObject json_of_stability(const StanceSummary& summary) {
  const Stability& found = *summary.stability;
  JsonValue::Array eigenvalues;
  for (const EigenvalueEnclosure& eigenvalue : found.eigenvalues)
    eigenvalues.push_back(
        JsonObject{{"real", eigenvalue.real}, {"imaginary", eigenvalue.imaginary}, {"count", eigenvalue.count}});
  JsonObject object{{"joints", word(summary.stability_control)},
                    {"stable", found.stable},
                    {"unstable", found.unstable},
                    {"open", found.open},
                    {"eigenvalues", eigenvalues},
                    {"cells", json_of_cells(found.cells, summary)},
                    {"scope", json_of(summary.stability_scope)}};
  if (found.growth.lo <= found.growth.hi) object.set("growth", found.growth);
  return object;
}

JsonObject json_of_equilibrium(const StanceSummary& summary) {
  const Equilibrium& found = *summary.equilibrium;
  JsonObject object{
      {"joints", word(summary.control)},
      {"stands", found.stands},
      {"not_on_all", found.not_on_all},
      {"not_on_all_within", JsonObject{{"rad", equilibrium_reach_of_tilt}, {"m", equilibrium_reach_of_height}}},
      {"open", found.open},
      {"cells", json_of_cells(found.cells, summary)},
      {"scope", json_of(summary.equilibrium_scope)}};
  if (found.standing) object.set("standing", json_of(*found.standing, summary.model));
  if (!summary.certified) return object;
  object.set("certificate", summary.certificate);
  JsonObject certified{{"stands", summary.certified->stands}};
  if (const auto& standing = summary.certified->standing) certified.set("standing", json_of(*standing, summary.model));
  object.set("certified", certified);
  return object;
}

JsonObject json_of_motion(const StanceSummary& summary) {
  const Motion& motion = *summary.motion;
  JsonObject positions;
  JsonObject velocities;
  for (std::size_t j = 0; j < motion.joints.size(); ++j) {
    positions.set(motion.joints[j], motion.positions[j]);
    velocities.set(motion.joints[j], motion.velocities[j]);
  }
  return {{"reached", motion.reached},
          {"proven", motion.proven},
          {"open", motion.open},
          {"steps", motion.slabs.size()},
          {"positions", positions},
          {"velocities", velocities},
          {"scope", json_of(summary.motion_scope)}};
}

JsonObject json_of(const PaperReport& report) {
  JsonValue::Array tables;
  for (const PaperTable& table : report.tables) {
    JsonValue::Array cells;
    for (const Cell& cell : table.cells) {
      cells.push_back(JsonObject{{"row", cell.row},
                                 {"column", cell.column},
                                 {"verisq", stance::text(cell.ours)},
                                 {"paper", cell.printed},
                                 {"verdict", stance::word(cell.verdict)},
                                 {"reason", cell.reason},
                                 {"reconstructed", cell.reconstructed}});
    }
    tables.push_back(JsonObject{{"title", table.title}, {"cells", cells}});
  }
  return {{"tables", tables},
          {"unrounded", json_of(report.unrounded)},
          {"all_explained", report.all_explained()},
          {"reconstructed_constants", reconstructed_constants()},
          {"reconstructed_from", "Tables 2 to 4: a match of a cell that these constants enter is no evidence for them"},
          {"does_not_act", std::array{"ground contact", "friction", "controller"}}};
}

JsonObject json_of(const Bounce& bounce, const std::string& dropped, const Drop& drop, const Scope& scope) {
  return {{"cylinder", dropped},
          {"scope", json_of(scope)},
          {"height", drop.height},
          {"mass", drop.mass},
          {"radius", drop.radius},
          {"restitution", drop.restitution},
          {"impact_velocity", drop.impact_velocity},
          {"touch_down_time", bounce.touch_down_time},
          {"touch_down_speed", bounce.touch_down_speed},
          {"deepest_penetration", bounce.deepest_penetration},
          {"lift_off_time", bounce.lift_off_time},
          {"rebound_speed", bounce.rebound_speed},
          {"effective_restitution", bounce.effective_restitution},
          {"steps", bounce.steps},
          {"proven", bounce.proven}};
}

}  // namespace

std::string component_name(std::size_t component) {
  return fmt::format("w{}", component + 1);
}

std::vector<std::string> notes(const stance::Model& model) {
  std::vector<std::string> names;
  for (const ContactCylinder& cylinder : model.cylinders) {
    if (cylinder.dynamic_friction.range.hi > cylinder.static_friction.range.lo) names.push_back(cylinder.name);
  }
  if (names.empty()) return {};
  if (names.size() == model.cylinders.size()) return {"dynamic friction may exceed static friction on all cylinders"};
  return {fmt::format("dynamic friction may exceed static friction on {}", quotation(names))};
}

std::string readable(const StanceSummary& summary) {
  std::string text;
  if (summary.paper) text += paper_text(*summary.paper);
  if (summary.wrench) text += uncertain_text(summary) + wrench_text(summary);
  if (!summary.sensitivities.empty()) text += sensitivities_text(summary);
  if (summary.reference) text += reference_text(*summary.reference);
  if (!summary.accelerations.empty()) text += accelerations_text(summary);
  if (summary.equilibrium) text += equilibrium_text(summary);
  if (summary.stability) text += stability_text(summary);
  if (summary.motion) text += motion_text(summary);
  if (summary.bounce) text += bounce_text(summary);
  text += "\n";
  for (const std::string& note : notes(summary.model)) text += fmt::format("note: {}\n", note);
  text += fmt::format("time {:.3g} s{}\n", summary.seconds, summary.interrupted ? ", interrupted" : "");
  return stripped(text);
}

JsonObject json_value(const StanceSummary& summary) {
  JsonValue::Array uncertain;
  for (const std::uint32_t i : summary.uncertain) uncertain.push_back(summary.model.parameters[i].name);
  JsonObject object{{"model", summary.file}, {"parameters", json_of_parameters(summary.model)}};
  if (summary.paper) object.set("paper", json_of(*summary.paper));
  if (summary.wrench) {
    object.set("uncertain", uncertain);
    object.set("mode", word(summary.mode));
    object.set("wrench", json_of(*summary.wrench, summary.wrench_samples));
    object.set("wrench_scope", json_of(summary.wrench_scope));
  }
  if (summary.wrench_samples) object.set("samples", summary.wrench_samples->count);
  if (!summary.sensitivities.empty()) object.set("sensitivities", json_of_sensitivities(summary));
  if (summary.reference) object.set("reference_uncertainty", json_of(*summary.reference));
  if (!summary.accelerations.empty()) {
    object.set("accelerations", json_of_accelerations(summary));
    object.set("accelerations_case", to_string(summary.acceleration_case));
    object.set("accelerations_joints", json_of_elsewhere(summary));
    object.set("accelerations_scope", json_of(summary.acceleration_scope));
  }
  if (summary.acceleration_samples) object.set("acceleration_samples", summary.acceleration_samples->count);
  if (summary.equilibrium) object.set("equilibrium", json_of_equilibrium(summary));
  if (summary.stability) object.set("stability", json_of_stability(summary));
  if (summary.motion) object.set("motion", json_of_motion(summary));
  if (summary.bounce)
    object.set("bounce", json_of(*summary.bounce, summary.dropped, *summary.drop, summary.bounce_scope));
  object.set("notes", notes(summary.model));
  object.set("interrupted", summary.interrupted);
  object.set("seconds", summary.seconds);
  return object;
}

std::string json(const StanceSummary& summary) {
  return json_value(summary).text() + "\n";
}

namespace {

using namespace stance;

JsonValue ends(const Enclosure& enclosure) {
  return std::array{enclosure.lo, enclosure.hi};
}

/// x and y, lower and upper ends.
JsonValue ends(const SidePoint& point) {
  return std::array{point.x.lo, point.x.hi, point.y.lo, point.y.hi};
}

template <class Items, class Part>
JsonValue list_of(const Items& items, const Part& part) {
  JsonValue::Array list;
  for (const auto& item : items) list.push_back(part(item));
  return list;
}

Enclosure range_of(const Quantity& quantity, UncertainSet uncertain) {
  for (const std::uint32_t i : uncertain) {
    if (quantity.parameter == i) return quantity.range;
  }
  return {quantity.nominal, quantity.nominal};
}

/// The drawn parts of the model: a line from each body to the one that carries it, a disc for each cylinder.
class Figure {
 public:
  Figure(const StanceSummary& summary, std::vector<std::uint32_t> bodies, std::vector<std::uint32_t> cylinders)
      : summary_(summary), bodies_(std::move(bodies)), cylinders_(std::move(cylinders)) {}

  /// The whole model.
  [[nodiscard]] static Figure whole(const StanceSummary& summary) {
    return {summary, counted(summary.model.bodies.size()), counted(summary.model.cylinders.size())};
  }

  /// One of each pair.
  [[nodiscard]] static Figure of(const StanceSummary& summary, const SagittalModel& sagittal) {
    std::vector<std::uint32_t> bodies;
    std::vector<std::uint32_t> cylinders;
    for (const SagittalBody& body : sagittal.bodies) bodies.push_back(body.body);
    for (const SagittalContact& contact : sagittal.contacts) cylinders.push_back(contact.cylinder);
    return {summary, std::move(bodies), std::move(cylinders)};
  }

  [[nodiscard]] JsonObject shape() const {
    const stance::Model& model = summary_.model;
    const auto line = [&](std::uint32_t b) -> JsonValue {
      const Body& body = model.bodies[b];
      return JsonObject{{"name", body.name}, {"parent", body.parent ? JsonValue(place(*body.parent)) : JsonValue()}};
    };
    const auto disc = [&](std::uint32_t c) -> JsonValue {
      const ContactCylinder& cylinder = model.cylinders[c];
      return JsonObject{{"name", cylinder.name}, {"radius", ends(range_of(cylinder.radius, summary_.uncertain))}};
    };
    return {{"bodies", list_of(bodies_, line)}, {"cylinders", list_of(cylinders_, disc)}};
  }

  [[nodiscard]] JsonValue points(const std::vector<Enclosure>& positions) const {
    const SideView view = side_view(summary_.model, summary_.uncertain, positions);
    return JsonObject{{"bodies", list_of(bodies_, [&](std::uint32_t b) { return ends(view.origins[b]); })},
                      {"cylinders", list_of(cylinders_, [&](std::uint32_t c) { return ends(view.cylinders[c]); })},
                      {"trunk", ends(view.trunk)}};
  }

 private:
  static std::vector<std::uint32_t> counted(std::size_t count) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < count; ++i) all.push_back(i);
    return all;
  }

  /// Parents are drawn, too, or a body of their pair is.
  [[nodiscard]] std::size_t place(std::uint32_t body) const {
    return static_cast<std::size_t>(std::find(bodies_.begin(), bodies_.end(), body) - bodies_.begin());
  }

  const StanceSummary& summary_;
  std::vector<std::uint32_t> bodies_;
  std::vector<std::uint32_t> cylinders_;
};

/// The names do not show which joints turn and which move.
JsonValue joints_of(const stance::Model& model) {
  const std::vector<std::string> names = joint_names(model);
  JsonValue::Array joints;
  for (const Body& body : model.bodies) {
    for (const Joint& joint : body.joints) {
      joints.push_back(JsonObject{{"name", names[joints.size()]},
                                  {"is_translation", joint.kind == JointKind::translation},
                                  {"is_of_root", !body.parent.has_value()}});
    }
  }
  return joints;
}

JsonValue standing_of(const StanceSummary& summary) {
  if (!summary.equilibrium || !summary.equilibrium->standing) return {};
  const Figure figure = Figure::whole(summary);
  return JsonObject{{"figure", figure.shape()}, {"points", figure.points(summary.equilibrium->standing->positions)}};
}

JsonValue motion_of(const StanceSummary& summary) {
  if (!summary.motion) return {};
  const Motion& motion = *summary.motion;
  const SagittalModel sagittal = sagittal_model(summary.model, summary.uncertain);
  const Figure figure = Figure::of(summary, sagittal);
  const auto list = [](const std::vector<Enclosure>& enclosures) {
    return list_of(enclosures, [](const Enclosure& each) { return ends(each); });
  };
  const auto slab = [&](const MotionSlab& each) -> JsonValue {
    return JsonObject{
        {"from", each.from},
        {"to", each.to},
        {"positions", list(each.positions)},
        {"velocities", list(each.velocities)},
        {"normal", list_of(each.contacts, [](const MotionContact& contact) { return ends(contact.normal); })},
        {"friction", list_of(each.contacts, [](const MotionContact& contact) { return ends(contact.friction); })},
        {"points", figure.points(all_positions(sagittal, each.positions))}};
  };
  return JsonObject{{"duration", summary.motion_duration},
                    {"joints", motion.joints},
                    {"contacts", motion.contacts},
                    {"figure", figure.shape()},
                    {"slabs", list_of(motion.slabs, slab)}};
}

}  // namespace

std::string stance_page_data(const StanceSummary& summary) {
  return JsonObject{{"format", "verisq-stance/1"},
                    {"result", json_value(summary)},
                    {"joints", joints_of(summary.model)},
                    {"standing", standing_of(summary)},
                    {"motion", motion_of(summary)}}
      .text();
}

void write_stance_page(const std::string& file, const StanceSummary& summary) {
  report::write_filled_page(file, report::stance_page_template(), stance_page_data(summary));
}

}  // namespace verisq::command_line
