/// Digests compared, maps checked, claims judged one by one.
#include "host/command_line/fit_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/map_file.hpp>

#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/map_check.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

struct FitCheckReport {
  CheckReport vertices;
  std::optional<CheckReport> surface = {};  ///< of triangles, where the fit claims something of them
  std::vector<Finding> findings = {};       ///< one a claim; none of an interrupted check

  [[nodiscard]] bool interrupted() const { return vertices.interrupted || (surface && surface->interrupted); }
  [[nodiscard]] std::ptrdiff_t count(Verdict verdict) const {
    return std::ranges::count(findings, verdict, &Finding::verdict);
  }
  [[nodiscard]] bool all_proved() const {
    return vertices.all_proved() && (!surface || surface->all_proved()) && count(Verdict::refuted) == 0 &&
           count(Verdict::unproved) == 0;
  }
};

bool claims_surface(const FitAnswer& answer) {
  return std::ranges::find(answer.claims, "surface_distance", &ClearanceClaim::what) != answer.claims.end();
}

void refuse_other_file(const std::string& file, const char* what, const SubjectFile& expected,
                       const std::string& certificate) {
  const SubjectFile given = subject_file(file);
  if (given.sha256 == expected.sha256) return;
  refuse(fmt::format("{}: {} is about another {}: its SHA-256 is {}, not {}", file, certificate, what, expected.sha256,
                     given.sha256));
}

/// What is missing, or is not what the answer is about.
void refuse_other_subjects(const FitAnswer& answer, const CheckArguments& arguments) {
  const std::string& certificate = arguments.certificate;
  if (arguments.models.size() != 1)
    refuse(fmt::format("{}: is of a fit: give one --model, the fitted one", certificate));
  if (arguments.inputs.mesh.empty() || arguments.map.empty())
    refuse(fmt::format("{}: is of a fit: give the --mesh, and the --map that holds the certificates of its distances",
                       certificate));
  if (claims_surface(answer) && arguments.surface_map.empty())
    refuse(fmt::format("{}: is of whole triangles, too: give the --surface-map that holds their certificates",
                       certificate));
  if (!arguments.inputs.points.empty() || arguments.inputs.pose || arguments.point_radius != 0.0)
    refuse(fmt::format("{}: is of a fit: not with --points, --pose or --point-radius", certificate));
  refuse_other_file(arguments.models.front(), "model", answer.model, certificate);
  refuse_other_file(arguments.inputs.mesh, "mesh", answer.mesh, certificate);
}

void refuse_other_elements(const MapReader& map, MapElements expected, const std::string& file) {
  if (map.elements() == expected) return;
  refuse(fmt::format("{}: is no map of {}", file, expected == MapElements::vertices ? "vertices" : "triangles"));
}

/// Of vertices that have no row, or an unproved one, nothing is known.
std::vector<Enclosure> check_vertices(const CheckArguments& arguments, FitCheckReport& report) {
  MapReader map(arguments.map);
  refuse_other_elements(map, MapElements::vertices, arguments.map);
  std::vector<Enclosure> distances;
  report.vertices = checked_map(arguments, map, [&](std::uint64_t row, const Enclosure& proven) {
    if (row >= distances.size()) distances.resize(row + 1, {-infinity, infinity});
    distances[row] = proven;
  });
  distances.resize(report.vertices.rows() + report.vertices.missing, {-infinity, infinity});
  return distances;
}

/// The smallest distance of all triangles.
std::optional<Enclosure> check_surface(CheckArguments arguments, FitCheckReport& report) {
  if (arguments.surface_map.empty()) return std::nullopt;
  arguments.map = arguments.surface_map;
  MapReader map(arguments.map);
  refuse_other_elements(map, MapElements::triangles, arguments.map);
  report.surface = checked_map(arguments, map, [](std::uint64_t, const Enclosure&) {});
  if (report.surface->missing > 0) return std::nullopt;
  return report.surface->smallest;
}

void judge_claims(const FitAnswer& answer, const std::vector<Enclosure>& distances,
                  const std::optional<Enclosure>& surface, const CheckArguments& arguments, FitCheckReport& report) {
  if (points_of(answer) != distances.size()) {
    refuse(fmt::format("{}: area_runs: are of {} vertices, and the mesh has {}", arguments.certificate,
                       points_of(answer), distances.size()));
  }
  report.findings = check(answer.claims, terms_of(answer), distances, surface);
}

/// A claim of an unknown name is shown by it.
std::string subject_of(const ClearanceClaim& claim) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 9> words{{
      {"objective", "F of the vertices"},
      {"smallest_distance", "smallest distance of the vertices"},
      {"deepest_penetration", "deepest penetration of a vertex"},
      {"points_within_limit", "vertices no deeper than the limit"},
      {"surface_distance", "smallest distance of the whole surface"},
      {"points_within_band", "vertices whose distance serves"},
      {"mean_distance", "mean distance of the vertices"},
      {"median_distance", "median distance of the vertices"},
      {"distance_of_95", "distance that 95 % of the vertices keep"},
  }};
  const auto* const known = std::ranges::find(words, claim.what, &std::pair<std::string_view, std::string_view>::first);
  const std::string what(known != words.end() ? known->second : claim.what);
  return claim.area.empty() ? what : fmt::format("{}, area {}", what, claim.area);
}

std::string readable(const FitAnswer& answer, const FitCheckReport& report, const CheckArguments& arguments) {
  const std::string units = answer.units.empty() ? std::string() : " " + answer.units;
  std::string text = readable(report.vertices);
  if (report.surface) text += readable(*report.surface);
  text += fmt::format("claims of the fit    {}\n", report.findings.size());
  for (const Verdict verdict : {Verdict::proved, Verdict::refuted, Verdict::unproved})
    text += fmt::format("  {:<19}{}\n", name_of(verdict), report.count(verdict));
  for (std::size_t i = 0; i < report.findings.size(); ++i) {
    const Finding& finding = report.findings[i];
    text += fmt::format("  {:<8} {}: {}\n", name_of(finding.verdict), subject_of(answer.claims[i]),
                        exact_text(answer.claims[i].value));
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}\n", exact_text(finding.proven));
  }
  text += fmt::format("limit                {}{}; distances in {}{} serve\n", answer.penetration_limit, units,
                      exact_text(answer.fitness.serves), units);
  if (answer.areas.size() > 1) text += "areas, weights       of the vertices that the certificate gives them\n";
  if (!report.surface)
    text += "not claimed          anything of what lies between the vertices (--surface-map of fit)\n";
  return text + fmt::format("certificate          {}\n", arguments.certificate);
}

JsonValue claims_of(const FitAnswer& answer, const FitCheckReport& report) {
  JsonValue::Array claims;
  for (std::size_t i = 0; i < report.findings.size(); ++i) {
    const ClearanceClaim& claim = answer.claims[i];
    claims.push_back(JsonObject{{"what", claim.what},
                                {"area", claim.area.empty() ? JsonValue() : JsonValue(claim.area)},
                                {"verdict", name_of(report.findings[i].verdict)},
                                {"claimed", claim.value},
                                {"proven", report.findings[i].proven}});
  }
  return claims;
}

std::string json(const FitAnswer& answer, const FitCheckReport& report, const CheckArguments& arguments) {
  const JsonObject object{{"kind", "fit"},
                          {"vertices", object_of(report.vertices)},
                          {"surface", report.surface ? JsonValue(object_of(*report.surface)) : JsonValue()},
                          {"claims", claims_of(answer, report)},
                          {"penetration_limit", answer.penetration_limit},
                          {"serves", answer.fitness.serves},
                          {"units", answer.units},
                          {"interrupted", report.interrupted()},
                          {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_fit_check(const FitAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  watch_for_interruption();
  FitCheckReport report{};
  const std::vector<Enclosure> distances = check_vertices(arguments, report);
  const std::optional<Enclosure> surface = check_surface(arguments, report);
  if (!report.interrupted()) judge_claims(answer, distances, surface, arguments, report);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.interrupted()) return ExitStatus::interrupted;
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
