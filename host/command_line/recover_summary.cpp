/// The two forms of the summary. Deviations on the way are estimates; that of the result is proven.
#include "host/command_line/recover_summary.hpp"

#include <fmt/format.h>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/json_value.hpp"

namespace verisq::command_line {
namespace {

std::string columns(const EstimatedDeviation& deviation) {
  return fmt::format("{:>12.4g}{:>12.4g}{:>12.4g}", deviation.mean, deviation.percentile_95, deviation.largest);
}

std::string table(const RecoverReport& report) {
  std::string text = fmt::format("{:<12}{:>12}{:>12}{:>12}", "primitives", "mean", "95 %", "largest");
  if (report.of_mesh) text += fmt::format("{:>12}{:>12}{:>12}", "back: mean", "95 %", "largest");
  text += "\n";
  for (const RecoveryStage& stage : report.recovery.stages) {
    const std::string name = stage.containment ? fmt::format("{}, {}", stage.primitives, option_of(*stage.containment))
                                               : fmt::format("{}", stage.primitives);
    text += fmt::format("{:<12}{}", name, columns(stage.to_model));
    if (stage.to_mesh) text += columns(*stage.to_mesh);
    text += "\n";
  }
  return text;
}

/// Of the result, both ways.
std::string proven_lines(const Deviation& proven, const std::string& units) {
  std::string text;
  if (proven.from_mesh) {
    const DistanceStatistics& mesh = *proven.from_mesh;
    text += fmt::format("mesh to model      largest in {}{}, proven", outward_digits(mesh.largest), units);
    if (mesh.mean) text += fmt::format("; mean {}{}", outward_digits(*mesh.mean), units);
    if (!mesh.percentiles.empty()) text += fmt::format("; 95 % {}{}", outward_digits(mesh.percentiles[0]), units);
    text += "\n";
  }
  if (proven.from_model)
    text +=
        fmt::format("model to mesh      largest in {}{}, proven\n", outward_digits(proven.from_model->largest), units);
  return text;
}

/// Of all triangles.
std::string contained_line(const ContainedWords& contained) {
  const char* const word = contained.containment == Containment::within ? "inside the mesh" : "outside the mesh";
  if (!contained.proof.proven) return fmt::format("{:<19}not proven\n", word);
  const char* const what = contained.containment == Containment::within
                               ? "every point of the model in the mesh's solid"
                               : "every point of the mesh's solid in the model";
  return fmt::format("{:<19}proven: {}\n", word, what);
}

JsonValue as_json(const std::optional<ContainedWords>& contained) {
  if (!contained) return {};
  const ContainmentProof& proof = contained->proof;
  JsonValue::Array centres;
  for (const std::string& name : proof.centres_outside) centres.push_back(name);
  return JsonObject{{"asked", option_of(contained->containment)},       {"proven", proof.proven},
                    {"triangles_proven", proof.triangles_proven},       {"triangles_refuted", proof.triangles_refuted},
                    {"triangles_undecided", proof.triangles_undecided}, {"centres_outside", centres},
                    {"maybe_with_cavities", proof.maybe_with_cavities}, {"proofs", contained->proofs}};
}

JsonValue as_json(const DistanceStatistics& proven) {
  return JsonObject{{"largest", proven.largest},
                    {"mean", proven.mean},
                    {"percentile_95", proven.percentiles.empty() ? JsonValue() : JsonValue(proven.percentiles[0])}};
}

JsonValue as_json(const std::optional<Deviation>& proven) {
  if (!proven || !proven->from_mesh || !proven->from_model) return {};
  return JsonObject{{"mesh_to_model", as_json(*proven->from_mesh)},
                    {"model_to_mesh", as_json(*proven->from_model)},
                    {"hausdorff", proven->hausdorff},
                    {"to_tolerance", proven->to_tolerance}};
}

JsonValue as_json(const EstimatedDeviation& deviation) {
  return JsonObject{{"mean", deviation.mean},
                    {"root_mean_square", deviation.root_mean_square},
                    {"percentile_95", deviation.percentile_95},
                    {"largest", deviation.largest}};
}

}  // namespace

std::string option_of(Containment containment) {
  return containment == Containment::within ? "inside" : "outside";
}

std::string obstacle(const ContainedWords& contained) {
  const ContainmentProof& proof = contained.proof;
  const std::string option = "--" + option_of(contained.containment);
  if (proof.triangles_refuted + proof.triangles_undecided > 0)
    return fmt::format("{}: is not proven; {} triangles are proven to be on the wrong side, {} are undecided", option,
                       proof.triangles_refuted, proof.triangles_undecided);
  if (!proof.centres_outside.empty())
    return fmt::format("{}: is not proven; {} is not proven to lie within the mesh", option, proof.centres_outside[0]);
  return fmt::format("{}: is not proven; the union of the primitives may have cavities", option);
}

bool RecoverReport::reached() const {
  if (!deviation) return true;
  const RecoveryStage& last = recovery.stages.back();
  return last.to_model.percentile_95 <= *deviation && (!last.to_mesh || last.to_mesh->percentile_95 <= *deviation);
}

std::string readable(const RecoverReport& report) {
  const Recovery& recovery = report.recovery;
  const std::string units = recovery.model.units.empty() ? "" : " " + recovery.model.units;
  std::string text = table(report);
  text += fmt::format("deviations above   estimated from samples{}, not proven\n",
                      units.empty() ? "" : fmt::format(", in{}", units));
  if (report.contained) text += contained_line(*report.contained);
  if (report.proven) text += proven_lines(*report.proven, units);
  text += fmt::format("points             {}{}\n", recovery.points, report.of_mesh ? " sampled on the mesh" : "");
  if (!report.of_mesh) text += fmt::format("outliers           {:.3g} %, estimated\n", 100.0 * recovery.outliers);
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  text += fmt::format("model              {} ({} {})\n", report.output, recovery.model.primitives.size(),
                      recovery.model.primitives.size() == 1 ? "primitive" : "primitives");
  if (!report.files.html.empty()) text += fmt::format("report             {}\n", report.files.html);
  if (!report.files.png.empty()) text += fmt::format("picture            {}\n", report.files.png);
  return text;
}

std::string json(const RecoverReport& report) {
  const Recovery& recovery = report.recovery;
  JsonValue::Array stages;
  for (const RecoveryStage& stage : recovery.stages) {
    stages.push_back(
        JsonObject{{"primitives", stage.primitives},
                   {"estimated_to_model", as_json(stage.to_model)},
                   {"estimated_to_mesh", stage.to_mesh ? as_json(*stage.to_mesh) : JsonValue()},
                   {"containment", stage.containment ? JsonValue(option_of(*stage.containment)) : JsonValue()}});
  }
  const JsonObject object{
      {"primitives", recovery.model.primitives.size()},
      {"stages", stages},
      {"proven", as_json(report.proven)},
      {"containment", as_json(report.contained)},
      {"points", recovery.points},
      {"estimated_outliers", recovery.outliers},
      {"deviation_asked", report.deviation},
      {"deviation_reached", report.reached()},
      {"units", recovery.model.units},
      {"seconds", report.seconds},
      {"interrupted", recovery.interrupted},
      {"output", report.output},
      {"report", report.files.html},
      {"png", report.files.png},
  };
  return object.text() + "\n";
}

}  // namespace verisq::command_line
