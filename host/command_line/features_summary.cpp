/// The two forms of the summary, and the lines of a report.
#include "host/command_line/features_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/json_value.hpp"

namespace verisq::command_line {
namespace {

const char* unit_of(const Feature& feature) {
  return feature.unit == FeatureUnit::length ? "mm" : "deg";
}

std::string value_of(const Feature& feature) {
  return fmt::format("{} {}", outward_digits(feature.value), unit_of(feature));
}

/// What a change does, in a surgeon's words.
struct Consequence {
  std::string_view name;
  const char* of_more;
  const char* of_less;
};
constexpr std::array consequences{
    Consequence{"offset_change", "more offset", "less offset"},
    Consequence{"length_change", "leg longer", "leg shorter"},
    Consequence{"version_change", "neck farther ahead: more anteversion", "neck farther back: less anteversion"},
    Consequence{"ccd_change", "neck steeper: valgus", "neck flatter: varus"},
};

/// Only where the whole interval says so.
std::string consequence_of(const Feature& feature) {
  const auto* const found = std::ranges::find(consequences, feature.name, &Consequence::name);
  if (found == consequences.end()) return {};
  if (feature.value.lo > 0.0) return fmt::format("   {}", found->of_more);
  if (feature.value.hi < 0.0) return fmt::format("   {}", found->of_less);
  return "   more or less: not decided at this landmark radius";
}

std::string text(const Point& point) {
  return fmt::format("{:.4f}, {:.4f}, {:.4f}", point[0], point[1], point[2]);
}

std::string side_name(const std::optional<Side>& side) {
  if (!side) return "not known";
  return *side == Side::left ? "left" : "right";
}

std::string table(const FemurFeatures& found) {
  std::string result;
  for (const Feature& feature : found.features) {
    result += fmt::format("{:<28}{}{}\n", feature.name, value_of(feature), consequence_of(feature));
    result += fmt::format("{:<28}  {}\n", "", feature.method);
  }
  for (const std::string& missing : found.missing) result += fmt::format("missing: {}\n", missing);
  return result;
}

std::string table(const FemurFrame& frame) {
  std::string result = fmt::format("frame (ISB), origin         {}\n", text(frame.origin));
  const auto axis = [&](const char* name, const FrameAxis& of) {
    result += fmt::format("  {:<26}{:.7f}, {:.7f}, {:.7f}, within {:.3g} deg\n", name, of.direction[0], of.direction[1],
                          of.direction[2], of.tilt_degrees);
  };
  axis("x, ahead", frame.x);
  axis("y, up", frame.y);
  axis("z, to the right", frame.z);
  return result;
}

JsonValue json_of(const FemurFeatures& found) {
  JsonValue::Array features;
  for (const Feature& feature : found.features) {
    features.push_back(JsonObject{
        {"name", feature.name}, {"method", feature.method}, {"unit", unit_of(feature)}, {"value", feature.value}});
  }
  return {features};
}

JsonValue json_of(const FrameAxis& axis) {
  return JsonObject{{"direction", axis.direction}, {"tilt_degrees", axis.tilt_degrees}};
}

JsonValue json_of(const std::optional<FemurFrame>& frame) {
  if (!frame) return {};
  return JsonObject{
      {"origin", frame->origin}, {"x", json_of(frame->x)}, {"y", json_of(frame->y)}, {"z", json_of(frame->z)}};
}

JsonValue json_of(const FemurLandmarks& landmarks) {
  JsonObject result;
  for (const auto& [name, point] : named_landmarks) {
    if (const std::optional<Point>& at = landmarks.*point) result.set(name, *at);
  }
  return result;
}

}  // namespace

std::string readable(const FeaturesReport& report) {
  std::string result = fmt::format("side                        {}\n", side_name(report.side));
  for (const std::string& note : report.notes) result += fmt::format("found               {}\n", note);
  for (const auto& [name, point] : named_landmarks) {
    if (const std::optional<Point>& at = report.landmarks.*point) result += fmt::format("{:<28}{}\n", name, text(*at));
  }
  result += report.landmark_radius > 0.0
                ? fmt::format("\nProven for all landmarks within {:.6g} mm of these:\n", report.landmark_radius)
                : "\nIf these landmarks were exact (--landmark-radius says how well they are known):\n";
  result += table(report.bone);
  if (report.bone.frame) result += table(*report.bone.frame);
  if (!report.changes) return result;
  result += "\nThe implant in its place, its own points exact, against the bone as it was:\n";
  for (const std::string& note : report.implant_notes) result += fmt::format("implant's           {}\n", note);
  return result + table(*report.changes);
}

std::string json(const FeaturesReport& report) {
  const JsonObject object{
      {"side", report.side ? JsonValue(side_name(report.side)) : JsonValue()},
      {"landmark_radius", report.landmark_radius},
      {"head_radius", report.landmarks.head_radius},
      {"landmarks", json_of(report.landmarks)},
      {"notes", report.notes},
      {"features", json_of(report.bone)},
      {"frame", json_of(report.bone.frame)},
      {"missing", report.bone.missing},
      {"implant_points", report.implant_notes},
      {"changes", report.changes ? json_of(*report.changes) : JsonValue()},
      {"changes_missing", report.changes ? JsonValue(report.changes->missing) : JsonValue()},
  };
  return object.text() + "\n";
}

std::vector<ReportLine> report_lines(const FeaturesReport& report) {
  std::vector<ReportLine> lines{{"side", side_name(report.side)},
                                {"landmarks known to", fmt::format("{:.6g} mm", report.landmark_radius)}};
  if (report.changes) {
    for (const Feature& feature : report.changes->features)
      lines.push_back(
          {fmt::format("{} ({})", feature.name, feature.method), value_of(feature) + consequence_of(feature)});
  }
  for (const Feature& feature : report.bone.features)
    lines.push_back({fmt::format("{} ({})", feature.name, feature.method), value_of(feature)});
  return lines;
}

}  // namespace verisq::command_line
