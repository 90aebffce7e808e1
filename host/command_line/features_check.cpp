/// The landmarks are all that a claim needs.
#include "host/command_line/features_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/features_certificate.hpp>

#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/json_value.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
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

/// That claim nothing on a side, or any angle.
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
  if (unbounded(lines) > 0)
    text +=
        fmt::format("  WITHOUT AN END     {}: of these nothing is claimed on one side at least\n", unbounded(lines));
  for (const auto& [name, method, unit, claimed, finding] : lines) {
    text += fmt::format("  {:<8} {} {} {} ({})\n", name_of(finding.verdict), name, exact_text(claimed), unit, method);
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
  return text + fmt::format("certificate          {}\n", arguments.certificate);
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

ExitStatus run_features_check(const FeaturesAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const std::vector<Line> lines = lines_of(answer.claims, check(answer.claims));
  fmt::print("{}", arguments.json ? json(answer, lines, arguments) : readable(answer, lines, arguments));
  const bool all = counted(lines, &Line::finding).are_all_proved() && unbounded(lines) == 0;
  return all ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
