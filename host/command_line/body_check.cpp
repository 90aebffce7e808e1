/// Proves where a body stands still, and the features of a femur, again.
#include <fmt/core.h>
#include <fmt/format.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <verisq/features.hpp>
#include <verisq/stance.hpp>
#include <verisq/stance_equilibrium.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

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

std::string readable(const EquilibriumAnswer& answer, const JudgedAnswer& judged) {
  std::string text = claims_in_words(judged, [](const JudgedClaim& claim) {
    return fmt::format("{}{}{}: {}{}", exact_text(claim.claimed), claim.unit.empty() ? "" : " ", claim.unit, claim.what,
                       claim.of.empty() ? "" : quotation(claim.of));
  });
  text += box_of(answer);
  text += fmt::format("joints               {}\n", words(answer.claims.control));
  text += fmt::format("cells                {} that are said to stand, of which {} are not proven to\n", judged.parts,
                      judged.unproved_parts);
  return text + "not claimed          whether the body stays there or topples\n";
}

JsonObject object_of(const EquilibriumAnswer& answer, const JudgedAnswer& judged) {
  JsonObject box;
  for (std::size_t i = 0; i < answer.parameters.size(); ++i) box.set(answer.parameters[i], answer.claims.ranges[i]);
  return {{"kind", "equilibrium"},
          {"claims", claims_of(judged,
                               [](const JudgedClaim& claim) {
                                 return JsonObject{{"what", claim.what + claim.of}, {"unit", claim.unit}};
                               })},
          {"without_an_end", judged.unbounded()},
          {"uncertain", box},
          {"stands", answer.claims.stands},
          {"joints", answer.claims.control == stance::JointControl::held ? "held" : "proportional"},
          {"cells", judged.parts},
          {"unproved_cells", judged.unproved_parts}};
}

}  // namespace

ExitStatus run_check(const EquilibriumAnswer& answer, const CheckArguments& arguments) {
  refuse_other_arguments(arguments);
  const std::string& file = arguments.models.front();
  const stance::Model model =
      stance::parse_model(subject_bytes(file, "model", answer.model, arguments.certificate), file);
  const ExitStatus status = proved_again(
      {.elements = "%",
       .steps = "cells",
       .judge = [&](const CheckOptions& options) { return judge(answer, arguments.certificate, model, options); },
       .words = [&](const JudgedAnswer& judged) { return readable(answer, judged); },
       .members = [&](const JudgedAnswer& judged) { return object_of(answer, judged); }},
      arguments);
  return status == ExitStatus::verified && answer.claims.stands != 1.0 ? ExitStatus::unverified : status;
}

namespace {

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

std::string points_of(const FemurLandmarks& landmarks) {
  std::string text;
  for (const auto& [name, point] : named_landmarks) {
    if (const auto& at = landmarks.*point)
      text += fmt::format("  {:<26} ({:.17g}, {:.17g}, {:.17g})\n", name, (*at)[0], (*at)[1], (*at)[2]);
  }
  return text;
}

std::string readable(const FeaturesAnswer& answer, const JudgedAnswer& judged, const CheckArguments& arguments) {
  std::string text = claims_in_words(judged, [](const JudgedClaim& claim) {
    return fmt::format("{} {}: {} ({})", exact_text(claim.claimed), claim.unit, quotation(claim.of),
                       quotation(claim.what));
  });
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

std::string json(const FeaturesAnswer& answer, const JudgedAnswer& judged, const CheckArguments& arguments) {
  const JsonValue claims = claims_of(judged, [](const JudgedClaim& claim) {
    return JsonObject{{"name", claim.of}, {"method", claim.what}, {"unit", claim.unit}};
  });
  const JsonObject object{{"kind", "features"},
                          {"claims", claims},
                          {"without_an_end", judged.unbounded()},
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
  const JudgedAnswer judged = judge(answer);
  fmt::print("{}", arguments.json ? json(answer, judged, arguments) : readable(answer, judged, arguments));
  return judged.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
