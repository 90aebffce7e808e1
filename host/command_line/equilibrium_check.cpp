/// All processors prove the parts of the box; then each claim is compared with what these say together.
#include "host/command_line/equilibrium_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/equilibrium_certificate.hpp>
#include <verisq/stance_file.hpp>

#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

using stance::EquilibriumClaims;
using stance::JointKind;
using stance::ProvenEquilibrium;

struct Claim {
  std::string what;  ///< "position of pelvis ty"
  std::string_view unit;
  Enclosure value;
  Finding finding;
};

struct EquilibriumReport {
  EquilibriumClaims claimed;  ///< `uncertain` of the model
  ProvenEquilibrium proven;
  std::vector<Claim> claims;  ///< none of an interrupted check
  double seconds;

  [[nodiscard]] VerdictCounts counts() const { return counted(claims, &Claim::finding); }
  /// That claim nothing on a side.
  [[nodiscard]] std::ptrdiff_t unbounded() const {
    return std::ranges::count_if(claims, [](const Claim& claim) { return !std::isfinite(claim.value.width()); });
  }
  [[nodiscard]] bool all_proved() const { return !proven.interrupted && unbounded() == 0 && counts().are_all_proved(); }
};

void refuse_other_subjects(const EquilibriumAnswer& answer, const CheckArguments& arguments) {
  const std::string& certificate = arguments.certificate;
  if (arguments.models.size() != 1)
    refuse(fmt::format("{}: is of a model of stance: give that --model (.xml), and no other", certificate));
  if (!arguments.map.empty() || !arguments.surface_map.empty() || !arguments.inputs.mesh.empty() ||
      !arguments.inputs.points.empty() || arguments.inputs.pose || arguments.point_radius != 0.0) {
    refuse(fmt::format("{}: is of a model of stance: not with --map, --mesh, --points, --pose or --point-radius",
                       certificate));
  }
  refuse_other_file(arguments.models.front(), "model", answer.model, certificate);
}

/// The claims with the model's own indices. Throws Error(input) for names that it does not have.
EquilibriumClaims claims_of(const EquilibriumAnswer& answer, const stance::Model& model,
                            const std::string& certificate) {
  EquilibriumClaims claims = answer.claims;
  for (std::size_t i = 0; i < answer.parameters.size(); ++i) {
    const auto named = [&](const stance::Parameter& parameter) { return parameter.name == answer.parameters[i]; };
    const auto found = std::ranges::find_if(model.parameters, named);
    if (found == model.parameters.end())
      refuse(fmt::format("{}: the model has no parameter {}", certificate, answer.parameters[i]));
    const Enclosure& range = claims.ranges[i];
    if (range.lo < found->range.lo || range.hi > found->range.hi) {
      refuse(fmt::format("{}: {} in {} is not within the model's range, {}", certificate, found->name,
                         exact_text(range), exact_text(found->range)));
    }
    claims.uncertain[i] = static_cast<std::uint32_t>(found - model.parameters.begin());
  }
  if (!claims.standing) return claims;
  if (answer.joints != stance::joint_names(model))
    refuse(fmt::format("{}: its joints are not those of the model, in their order", certificate));
  const auto name = [](const stance::ContactCylinder& cylinder) { return cylinder.name; };
  if (!std::ranges::equal(answer.cylinders, model.cylinders, {}, {}, name))
    refuse(fmt::format("{}: its cylinders are not those of the model, in their order", certificate));
  return claims;
}

/// As the findings of `stance::check`.
std::vector<Claim> claims_with(const EquilibriumClaims& claims, const stance::Model& model,
                               const std::vector<Finding>& findings) {
  std::vector<Claim> result{{"share of the box that has an equilibrium on all cylinders, at least",
                             "",
                             {claims.stands, 1.0},
                             findings.front()}};
  if (!claims.standing) return result;
  const std::vector<Enclosure> numbers = stance::numbers_of(*claims.standing);
  const auto add = [&](std::string what, std::string_view unit) {
    const std::size_t i = result.size();
    result.push_back({std::move(what), unit, numbers[i - 1], findings[i]});
  };
  const std::vector<std::string> names = stance::joint_names(model);
  std::vector<bool> turns;
  for (const stance::Body& body : model.bodies) {
    for (const stance::Joint& joint : body.joints) turns.push_back(joint.kind == JointKind::rotation);
  }
  for (std::size_t i = 0; i < names.size(); ++i) add("position of " + names[i], turns[i] ? "rad" : "m");
  for (std::size_t i = 0; i < names.size(); ++i) add("torque that holds " + names[i], turns[i] ? "N m" : "N");
  for (const stance::ContactCylinder& cylinder : model.cylinders) {
    add("force on " + cylinder.name, "N");
    add("penetration of " + cylinder.name, "m");
  }
  add("centre of pressure, x", "m");
  add("centre of pressure, z", "m");
  add("least penetration of all", "m");
  return result;
}

EquilibriumReport checked(const EquilibriumAnswer& answer, const stance::Model& model,
                          const CheckArguments& arguments) {
  EquilibriumReport report{claims_of(answer, model, arguments.certificate), {}, {}, 0.0};
  ProgressBar bar(!arguments.no_progress, "%");
  const Stopwatch time;
  report.proven = stance::prove(model, report.claimed, answer.certificate,
                                {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                 .interrupted = interrupted,
                                 .progress = [&bar](double done) { bar.update_state("cells", done); }});
  report.seconds = time.seconds();
  if (!report.proven.interrupted)
    report.claims = claims_with(report.claimed, model, stance::check(report.claimed, report.proven));
  return report;
}

std::string_view words(stance::JointControl control) {
  return control == stance::JointControl::held ? "held where the file has them"
                                               : "turned from where the file has them as the proportional gains allow";
}

/// What the numbers are of.
std::string box_of(const EquilibriumAnswer& answer) {
  if (answer.parameters.empty()) return "of                   the body whose parameters are nominal\n";
  std::string text =
      answer.claims.stands == 1.0
          ? "of                   all values of these parameters, together\n"
          : "of                   those values of these parameters, together, that the certificate says stand;\n"
            "                     of the others NOTHING is claimed\n";
  for (std::size_t i = 0; i < answer.parameters.size(); ++i)
    text += fmt::format("  {:<19}{}\n", answer.parameters[i], exact_text(answer.claims.ranges[i]));
  return text + "  all others         at their nominal values\n";
}

std::string readable(const EquilibriumAnswer& answer, const EquilibriumReport& report,
                     const CheckArguments& arguments) {
  std::string text = verdicts_in_words("claims", report.counts());
  if (report.unbounded() > 0)
    text +=
        fmt::format("  WITHOUT AN END     {}: of these nothing is claimed on one side at least\n", report.unbounded());
  for (const auto& [what, unit, value, finding] : report.claims) {
    text += fmt::format("  {:<8} {}: {}{}{}\n", name_of(finding.verdict), what, exact_text(value),
                        unit.empty() ? "" : " ", unit);
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}\n", exact_text(finding.proven));
  }
  text += box_of(answer);
  text += fmt::format("joints               {}\n", words(answer.claims.control));
  text += fmt::format("cells                {} that are said to stand, of which {} are not proven to\n",
                      report.proven.parts, report.proven.unproved_parts);
  text += "not claimed          whether the body stays there or topples\n";
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  return text + fmt::format("certificate          {}{}\n", arguments.certificate,
                            report.proven.interrupted ? " (interrupted)" : "");
}

std::string json(const EquilibriumAnswer& answer, const EquilibriumReport& report, const CheckArguments& arguments) {
  JsonValue::Array claims;
  for (const auto& [what, unit, value, finding] : report.claims) {
    claims.push_back(JsonObject{{"what", what},
                                {"unit", unit},
                                {"verdict", name_of(finding.verdict)},
                                {"claimed", value},
                                {"proven", finding.proven}});
  }
  JsonObject box;
  for (std::size_t i = 0; i < answer.parameters.size(); ++i) box.set(answer.parameters[i], answer.claims.ranges[i]);
  const JsonObject object{{"kind", "equilibrium"},
                          {"claims", claims},
                          {"without_an_end", report.unbounded()},
                          {"uncertain", box},
                          {"stands", answer.claims.stands},
                          {"joints", answer.claims.control == stance::JointControl::held ? "held" : "proportional"},
                          {"cells", report.proven.parts},
                          {"unproved_cells", report.proven.unproved_parts},
                          {"seconds", report.seconds},
                          {"interrupted", report.proven.interrupted},
                          {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_equilibrium_check(const EquilibriumAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const stance::Model model = stance::read_model(arguments.models.front());
  watch_for_interruption();
  const EquilibriumReport report = checked(answer, model, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.proven.interrupted) return ExitStatus::interrupted;
  return report.all_proved() && answer.claims.stands == 1.0 ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
