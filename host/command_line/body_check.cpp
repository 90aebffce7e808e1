/// Proves where a body stands still, and the features of a femur, again.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

using stance::EquilibriumClaims;
using stance::JointKind;
using stance::ProvenEquilibrium;

struct Claim {
  std::string what;  ///< "position of "
  std::string name;  ///< "pelvis ty", which is the file's; empty where the claim is of nothing that has one
  std::string_view unit;
  Enclosure value;
  Finding finding;
};

struct EquilibriumReport {
  EquilibriumClaims claimed;  ///< `uncertain` of the model
  ProvenEquilibrium proven;
  std::vector<Claim> claims;  ///< none for an interrupted check
  double seconds;

  [[nodiscard]] VerdictCounts counts() const { return counted(claims, &Claim::finding); }
  /// The number of claims with an unbounded side.
  [[nodiscard]] std::ptrdiff_t unbounded() const {
    return std::ranges::count_if(claims, [](const Claim& claim) { return !std::isfinite(claim.value.width()); });
  }
  [[nodiscard]] bool all_proved() const { return !proven.interrupted && unbounded() == 0 && counts().are_all_proved(); }
};

void refuse_other_arguments(const CheckArguments& arguments) {
  const std::string& certificate = arguments.certificate;
  if (arguments.models.size() != 1)
    refuse(fmt::format("{}: is of a model of stance: give that --model (.xml), and no other", certificate));
  if (!arguments.map.empty() || !arguments.surface_map.empty() || !arguments.inputs.mesh.empty() ||
      !arguments.inputs.points.empty() || arguments.inputs.pose || arguments.point_radius != 0.0) {
    refuse(fmt::format("{}: is of a model of stance: not with --map, --mesh, --points, --pose or --point-radius",
                       certificate));
  }
}

/// The claims with the model's own indices. Throws Error(input) for names that it does not have.
EquilibriumClaims claims_of(const EquilibriumAnswer& answer, const stance::Model& model,
                            const std::string& certificate) {
  EquilibriumClaims claims = answer.claims;
  for (std::size_t i = 0; i < answer.parameters.size(); ++i) {
    const auto named = [&](const stance::Parameter& parameter) { return parameter.name == answer.parameters[i]; };
    const auto found = std::ranges::find_if(model.parameters, named);
    if (found == model.parameters.end())
      refuse(fmt::format("{}: the model has no parameter {}", certificate, quotation(answer.parameters[i])));
    const Enclosure& range = claims.ranges[i];
    if (range.lo < found->range.lo || range.hi > found->range.hi) {
      refuse(fmt::format("{}: {} in {} is not within the model's range, {}", certificate, quotation(found->name),
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

/// In the order of the findings of `stance::check`.
std::vector<Claim> claims_with(const EquilibriumClaims& claims, const stance::Model& model,
                               const std::vector<Finding>& findings) {
  std::vector<Claim> result{{"share of the box that has an equilibrium on all cylinders, at least",
                             "",
                             "",
                             {claims.stands, 1.0},
                             findings.front()}};
  if (!claims.standing) return result;
  const std::vector<Enclosure> numbers = stance::numbers_of(*claims.standing);
  const auto add = [&](const char* what, const std::string& name, std::string_view unit) {
    const std::size_t i = result.size();
    result.push_back({what, name, unit, numbers[i - 1], findings[i]});
  };
  const std::vector<std::string> names = stance::joint_names(model);
  std::vector<bool> turns;
  for (const stance::Body& body : model.bodies) {
    for (const stance::Joint& joint : body.joints) turns.push_back(joint.kind == JointKind::rotation);
  }
  for (std::size_t i = 0; i < names.size(); ++i) add("position of ", names[i], turns[i] ? "rad" : "m");
  for (std::size_t i = 0; i < names.size(); ++i) add("torque that holds ", names[i], turns[i] ? "N m" : "N");
  for (const stance::ContactCylinder& cylinder : model.cylinders) {
    add("force on ", cylinder.name, "N");
    add("penetration of ", cylinder.name, "m");
  }
  add("centre of pressure, x", "", "m");
  add("centre of pressure, z", "", "m");
  add("least penetration of all points", "", "m");
  return result;
}

EquilibriumReport checked(const EquilibriumAnswer& answer, const stance::Model& model,
                          const CheckArguments& arguments) {
  EquilibriumReport report{claims_of(answer, model, arguments.certificate), {}, {}, 0.0};
  ProgressBar bar(!arguments.no_progress, "%");
  const Stopwatch time;
  report.proven = stance::prove(model, report.claimed, answer.certificate,
                                {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                 .interrupted = arguments.ended,
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

/// Describes the box of parameters of the numbers.
std::string box_of(const EquilibriumAnswer& answer) {
  if (answer.parameters.empty()) return "of                   the body whose parameters are nominal\n";
  std::string text =
      answer.claims.stands == 1.0
          ? "of                   all values of these parameters, together\n"
          : "of                   those values of these parameters, together, that the certificate says stand;\n"
            "                     of the others NOTHING is claimed\n";
  for (std::size_t i = 0; i < answer.parameters.size(); ++i)
    text += fmt::format("  in {:<16} {}\n", exact_text(answer.claims.ranges[i]), quotation(answer.parameters[i]));
  return text + "  all others         at their nominal values\n";
}

std::string readable(const EquilibriumAnswer& answer, const EquilibriumReport& report,
                     const CheckArguments& arguments) {
  std::string text = verdicts_in_words("claims", report.counts());
  text += unbounded_in_words(static_cast<std::uint64_t>(report.unbounded()));
  for (const auto& [what, name, unit, value, finding] : report.claims) {
    text += fmt::format("  {:<8} {}{}{}: {}{}\n", name_of(finding.verdict), exact_text(value), unit.empty() ? "" : " ",
                        unit, what, name.empty() ? "" : quotation(name));
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}\n", exact_text(finding.proven));
  }
  text += box_of(answer);
  text += fmt::format("joints               {}\n", words(answer.claims.control));
  text += fmt::format("cells                {} that are said to stand, of which {} are not proven to\n",
                      report.proven.parts, report.proven.unproved_parts);
  text += "not claimed          whether the body stays there or topples\n";
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  return text + fmt::format("certificate          {}{}\n", quotation(arguments.certificate),
                            mark_of_end(report.proven.interrupted));
}

std::string json(const EquilibriumAnswer& answer, const EquilibriumReport& report, const CheckArguments& arguments) {
  JsonValue::Array claims;
  for (const auto& [what, name, unit, value, finding] : report.claims) {
    claims.push_back(JsonObject{{"what", what + name},
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

ExitStatus run_check(const EquilibriumAnswer& answer, const CheckArguments& arguments) {
  refuse_other_arguments(arguments);
  const std::string& file = arguments.models.front();
  const stance::Model model = stance::parse_model(bytes_of(file, "model", answer.model, arguments.certificate), file);
  watch_for_interruption();
  const EquilibriumReport report = checked(answer, model, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.proven.interrupted) return status_of_end();
  return report.all_proved() && answer.claims.stands == 1.0 ? ExitStatus::verified : ExitStatus::unverified;
}

namespace {

struct Line {
  std::string name;
  std::string method;
  std::string_view unit;
  Enclosure claimed;
  Finding finding;
};

void refuse_other_subjects(const FeaturesAnswer& answer, const CheckArguments& arguments) {
  const std::string& certificate = arguments.certificate;
  if (!arguments.map.empty() || !arguments.surface_map.empty() || !arguments.inputs.points.empty() ||
      arguments.inputs.pose || arguments.point_radius != 0.0) {
    refuse(
        fmt::format("{}: is of a femur's features: not with --map, --points, --pose or --point-radius", certificate));
  }
  if (arguments.models.size() == 1 && !answer.implant && answer.mesh) {
    refuse_other_file(arguments.models.front(), "model", *answer.mesh, certificate);
  } else if (arguments.models.size() > (answer.implant ? 1U : 0U)) {
    refuse(fmt::format("{}: is of {}: give no other --model", certificate,
                       answer.implant ? "one implant" : "no implant, and of no model"));
  } else if (!arguments.models.empty()) {
    refuse_other_file(arguments.models.front(), "implant", *answer.implant, certificate);
  }
  if (arguments.inputs.mesh.empty()) return;
  if (!answer.mesh) refuse(fmt::format("{}: is of landmarks that were found in no mesh: no --mesh", certificate));
  refuse_other_file(arguments.inputs.mesh, "mesh", *answer.mesh, certificate);
}

std::string_view unit_of(const Feature& feature) {
  return feature.unit == FeatureUnit::length ? "mm" : "degrees";
}

std::vector<Line> lines_of(const FeatureClaims& claims, const FeatureFindings& findings) {
  std::vector<Line> lines;
  const auto add = [&](const std::vector<Feature>& features, const std::vector<Finding>& found) {
    for (std::size_t i = 0; i < features.size(); ++i) {
      const Feature& feature = features[i];
      lines.push_back({feature.name, feature.method, unit_of(feature), feature.value, found[i]});
    }
  };
  add(claims.features, findings.features);
  if (claims.frame) {
    const std::array axes{&claims.frame->x, &claims.frame->y, &claims.frame->z};
    for (std::size_t i = 0; i < axes.size(); ++i) {
      lines.push_back({fmt::format("frame_{}", "xyz"[i]),
                       "how far the axis tilts from the direction that is stated",
                       "degrees",
                       {0.0, axes[i]->tilt_degrees},
                       (*findings.frame)[i]});
    }
  }
  add(claims.changes, findings.changes);
  return lines;
}

/// The number of claims with an unbounded side, or with any angle.
std::ptrdiff_t unbounded(const std::vector<Line>& lines) {
  return std::ranges::count_if(lines, [](const Line& line) {
    const bool any_angle = line.unit == "degrees" && line.claimed.lo <= 0.0 && line.claimed.hi >= 180.0;
    return any_angle || !std::isfinite(line.claimed.width());
  });
}

std::string points_of(const FemurLandmarks& landmarks) {
  std::string text;
  for (const auto& [name, point] : named_landmarks) {
    if (const auto& at = landmarks.*point)
      text += fmt::format("  {:<26} ({:.17g}, {:.17g}, {:.17g})\n", name, (*at)[0], (*at)[1], (*at)[2]);
  }
  return text;
}

std::string readable(const FeaturesAnswer& answer, const std::vector<Line>& lines, const CheckArguments& arguments) {
  std::string text = verdicts_in_words("claims", counted(lines, &Line::finding));
  text += unbounded_in_words(static_cast<std::uint64_t>(unbounded(lines)));
  for (const auto& [name, method, unit, claimed, finding] : lines) {
    text += fmt::format("  {:<8} {} {}: {} ({})\n", name_of(finding.verdict), exact_text(claimed), unit,
                        quotation(name), quotation(method));
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}\n", exact_text(finding.proven));
  }
  text += fmt::format("landmarks            within {} mm of where the certificate has them; side: {}\n",
                      answer.claims.landmark_radius,
                      !answer.claims.side                 ? "not said"
                      : *answer.claims.side == Side::left ? "left"
                                                          : "right");
  if (answer.claims.landmarks.head_radius)
    text += fmt::format("  {:<26} {:.17g}\n", "head_radius", *answer.claims.landmarks.head_radius);
  text += points_of(answer.claims.landmarks);
  if (answer.claims.implant) text += "implant              its points are exact\n" + points_of(*answer.claims.implant);
  text += "  are they those of the bone, and the implant's its own? That is not proved, but for you to see\n";
  return text + fmt::format("certificate          {}\n", quotation(arguments.certificate));
}

JsonValue json_of(const FemurLandmarks& landmarks) {
  JsonObject object;
  for (const auto& [name, point] : named_landmarks) {
    if (const auto& at = landmarks.*point) object.set(name, *at);
  }
  return object;
}

JsonValue json_of(const std::optional<Side>& side) {
  if (!side) return {};
  return *side == Side::left ? "left" : "right";
}

std::string json(const FeaturesAnswer& answer, const std::vector<Line>& lines, const CheckArguments& arguments) {
  JsonValue::Array claims;
  for (const auto& [name, method, unit, claimed, finding] : lines) {
    claims.push_back(JsonObject{{"name", name},
                                {"method", method},
                                {"unit", unit},
                                {"verdict", name_of(finding.verdict)},
                                {"claimed", claimed},
                                {"proven", finding.proven}});
  }
  const JsonObject object{{"kind", "features"},
                          {"claims", claims},
                          {"without_an_end", unbounded(lines)},
                          {"landmark_radius", answer.claims.landmark_radius},
                          {"side", json_of(answer.claims.side)},
                          {"head_radius", answer.claims.landmarks.head_radius},
                          {"landmarks", json_of(answer.claims.landmarks)},
                          {"implant", answer.claims.implant ? json_of(*answer.claims.implant) : JsonValue()},
                          {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_check(const FeaturesAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const std::vector<Line> lines = lines_of(answer.claims, check(answer.claims));
  fmt::print("{}", arguments.json ? json(answer, lines, arguments) : readable(answer, lines, arguments));
  const bool all = !lines.empty() && counted(lines, &Line::finding).are_all_proved() && unbounded(lines) == 0;
  return all ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
