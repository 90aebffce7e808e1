/// All processors check the samples; then each claim is compared with what these prove.
#include "host/command_line/deviation_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>
#include <verisq/deviation_certificate.hpp>
#include <verisq/mesh_file.hpp>

#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/cloud_input.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

struct Claim {
  std::string of;    ///< "mesh", "vertices" or "points", from where to the model; "model", to these; "both" ways
  std::string what;  ///< "largest", "mean", "95 %"
  Enclosure value;
  Finding finding;
};

struct DeviationCheckReport {
  ProvenDeviation proven;
  std::vector<Claim> claims;  ///< none of an interrupted check
  std::string units;
  double seconds;

  [[nodiscard]] VerdictCounts counts() const { return counted(claims, &Claim::finding); }
  /// That claim nothing from above.
  [[nodiscard]] std::ptrdiff_t unbounded() const {
    return std::ranges::count_if(claims, [](const Claim& claim) { return !std::isfinite(claim.value.hi); });
  }
  [[nodiscard]] bool all_proved() const { return !proven.interrupted && unbounded() == 0 && counts().are_all_proved(); }
};

bool is_cloud(const DeviationAnswer& answer) {
  return answer.certificate.triangles.empty();
}

/// What is missing, or is not what the answer is about.
void refuse_other_subjects(const DeviationAnswer& answer, const CheckArguments& arguments) {
  const std::string& certificate = arguments.certificate;
  const char* const wanted = is_cloud(answer) ? "--points" : "--mesh";
  const std::string& given = is_cloud(answer) ? arguments.inputs.points : arguments.inputs.mesh;
  const std::string& other = is_cloud(answer) ? arguments.inputs.mesh : arguments.inputs.points;
  if (arguments.models.size() != 1) refuse(fmt::format("{}: is of a deviation: give one --model", certificate));
  if (given.empty() || !other.empty()) refuse(fmt::format("{}: is of a deviation: give the {}", certificate, wanted));
  if (!arguments.map.empty() || !arguments.surface_map.empty() || arguments.point_radius != 0.0)
    refuse(fmt::format("{}: is of a deviation, and holds its distances itself: not with --map or --point-radius",
                       certificate));
  if (arguments.inputs.pose)
    refuse(fmt::format("{}: is of a deviation, and says itself how the model was moved: not with --pose", certificate));
  refuse_other_file(arguments.models.front(), "model", answer.model, certificate);
  refuse_other_file(given, is_cloud(answer) ? "cloud" : "mesh", answer.mesh, certificate);
}

void refuse_other_sizes(const DeviationAnswer& answer, const Mesh& mesh, const CheckArguments& arguments) {
  const auto& [vertices, triangles, surface] = answer.certificate;
  if (vertices.size() == mesh.vertices.size() && triangles.size() == mesh.triangles.size()) return;
  refuse(fmt::format("{}: is of {} vertices and {} triangles, and there are {} and {}", arguments.certificate,
                     vertices.size(), triangles.size(), mesh.vertices.size(), mesh.triangles.size()));
}

std::string percentile_in_words(const DeviationAnswer& answer, std::size_t i) {
  return fmt::format("{} %", answer.percentiles[i]);
}

void add_claims(const DeviationAnswer& answer, const char* of, const DistanceSummary& claimed,
                const DistanceSummary& proven, std::vector<Claim>& claims) {
  const std::vector<Finding> findings = check(claimed, proven);
  claims.push_back({of, "largest", claimed.largest, findings[0]});
  claims.push_back({of, "mean", claimed.mean, findings[1]});
  for (std::size_t i = 0; i < answer.percentiles.size(); ++i) {
    claims.push_back({of, percentile_in_words(answer, i), claimed.percentiles[i], findings[2 + i]});
  }
}

/// What is claimed of the model's surface, if anything.
void add_other_way(const DeviationAnswer& answer, const ProvenDeviation& proven, std::vector<Claim>& claims) {
  if (!proven.from_model) return;
  claims.push_back({"model", "largest", *answer.from_model, check(*answer.from_model, *proven.from_model)});
  if (const auto& claimed = answer.statistics_from_model) {
    const std::vector<Finding> findings = check(*claimed, *proven.statistics_from_model);
    claims.push_back({"model", "mean", claimed->mean, findings[0]});
    for (std::size_t i = 0; i < answer.percentiles.size(); ++i)
      claims.push_back({"model", percentile_in_words(answer, i), claimed->percentiles[i], findings[1 + i]});
  }
  claims.push_back({"both", "largest", *answer.hausdorff, check(*answer.hausdorff, *proven.hausdorff)});
}

DeviationCheckReport checked(const DeviationAnswer& answer, const Model& model, const Mesh& mesh,
                             const CheckArguments& arguments) {
  ProgressBar bar(!arguments.no_progress, "points");
  const Stopwatch time;
  DeviationCheckReport report{.proven = DeviationChecker(model)(
                                  mesh, answer.certificate,
                                  {.percentiles = answer.percentiles,
                                   .statistics_of_model = answer.statistics_from_model.has_value(),
                                   .check = {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                             .interrupted = interrupted,
                                             .progress = [&bar](double done) { bar.update_state("samples", done); }}}),
                              .claims = {},
                              .units = model.units,
                              .seconds = time.seconds()};
  if (report.proven.interrupted) return report;
  if (answer.from_mesh) add_claims(answer, "mesh", *answer.from_mesh, *report.proven.from_mesh, report.claims);
  add_claims(answer, is_cloud(answer) ? "points" : "vertices", answer.of_vertices, report.proven.of_vertices,
             report.claims);
  add_other_way(answer, report.proven, report.claims);
  return report;
}

std::string direction_of(const std::string& of, const DeviationAnswer& answer) {
  if (of == "both") return "both ways (Hausdorff)";
  return of == "model" ? fmt::format("model to {}", is_cloud(answer) ? "points" : "mesh") : of + " to model";
}

std::string not_claimed(const DeviationAnswer& answer) {
  return fmt::format("{}how far the model's surface lies from the {}",
                     answer.from_model ? "mean and percentiles of " : "", is_cloud(answer) ? "points" : "mesh");
}

std::string readable(const DeviationAnswer& answer, const DeviationCheckReport& report,
                     const CheckArguments& arguments) {
  const std::string units = report.units.empty() ? std::string() : " " + report.units;
  std::string text = verdicts_in_words("claims", report.counts());
  if (report.unbounded() > 0)
    text += fmt::format("  WITHOUT AN END     {}: of these nothing is claimed from above\n", report.unbounded());
  for (const auto& [of, what, value, finding] : report.claims) {
    text += fmt::format("  {:<8} {}, {}: {}{}\n", name_of(finding.verdict), direction_of(of, answer), what,
                        exact_text(value), units);
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}{}\n", exact_text(finding.proven), units);
  }
  text += fmt::format("samples              {}, of which {} say less than they claim\n", report.proven.samples,
                      report.proven.unproved_samples);
  if (answer.pose) text += fmt::format("model moved by       {}: translation, quaternion\n", option_text(*answer.pose));
  if (!answer.statistics_from_model) text += fmt::format("not claimed          {}\n", not_claimed(answer));
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  return text + fmt::format("certificate          {}{}\n", arguments.certificate,
                            report.proven.interrupted ? " (interrupted)" : "");
}

std::string json(const DeviationAnswer& answer, const DeviationCheckReport& report, const CheckArguments& arguments) {
  JsonValue::Array claims;
  for (const auto& [of, what, value, finding] : report.claims) {
    claims.push_back(JsonObject{{"of", of},
                                {"what", what},
                                {"verdict", name_of(finding.verdict)},
                                {"claimed", value},
                                {"proven", finding.proven}});
  }
  const JsonObject object{{"kind", "deviation"},
                          {"claims", claims},
                          {"without_an_end", report.unbounded()},
                          {"samples", report.proven.samples},
                          {"unproved_samples", report.proven.unproved_samples},
                          {"pose", answer.pose ? JsonValue(*answer.pose) : JsonValue()},
                          {"units", report.units},
                          {"seconds", report.seconds},
                          {"interrupted", report.proven.interrupted},
                          {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_deviation_check(const DeviationAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const Model model = read_model_at(answer.pose, arguments.models.front());
  refuse_other_units(model.units, "model", answer.units, arguments.certificate);
  const Mesh mesh = is_cloud(answer) ? read_cloud(arguments.inputs.points) : read_mesh(arguments.inputs.mesh);
  refuse_other_sizes(answer, mesh, arguments);
  watch_for_interruption();
  const DeviationCheckReport report = checked(answer, model, mesh, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.proven.interrupted) return ExitStatus::interrupted;
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
