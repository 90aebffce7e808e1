/// Digests compared, maps checked, claims judged one by one.
#include "host/command_line/fit_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/map_file.hpp>
#include <verisq/model_file.hpp>

#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/map_check.hpp"
#include "host/command_line/side_check.hpp"
#include "host/command_line/stated_terms.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

struct FitCheckReport {
  CheckReport vertices;
  std::optional<CheckReport> surface = {};  ///< of triangles, where the fit claims something of them
  Clearance proven = {};                    ///< what the vertices' distances say together
  std::vector<Finding> findings = {};       ///< one a claim; none of an interrupted check
  SideCheckReport sides = {};

  [[nodiscard]] bool interrupted() const {
    return vertices.interrupted || (surface && surface->interrupted) || sides.interrupted;
  }
  [[nodiscard]] VerdictCounts counts() const { return counted(findings, std::identity()); }
  [[nodiscard]] bool all_proved() const {
    return vertices.all_proved() && (!surface || surface->all_proved()) && counts().are_all_proved() &&
           sides.all_proved();
  }
};

bool claims_surface(const FitAnswer& answer) {
  return std::ranges::find(answer.claims, "surface_distance", &ClearanceClaim::what) != answer.claims.end();
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
  refuse_other_units(read_uncertain_model(arguments.models.front()).units, "model", answer.units, certificate);
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
  if (points_of(answer.terms) != distances.size()) {
    refuse(fmt::format("{}: area_runs: are of {} vertices, and the mesh has {}", arguments.certificate,
                       points_of(answer.terms), distances.size()));
  }
  report.proven = clearance_of(terms_of(answer.terms), distances);
  report.findings = check(answer.claims, report.proven, surface);
}

/// What a claim is about, in words, and whether that is a length.
struct Words {
  std::string_view what;
  std::string_view words;
  bool is_length;
};

constexpr std::array<Words, 9> all_words{{
    {"objective", "F of the vertices", false},
    {"smallest_distance", "smallest signed distance of the vertices", true},
    {"deepest_penetration", "deepest penetration of a vertex", true},
    {"points_within_limit", "vertices no deeper than the limit", false},
    {"surface_distance", "distance of the whole surface, 0 where it meets or enters the implant", true},
    {"points_within_band", "vertices whose distance serves", false},
    {"mean_distance", "mean distance of the vertices", true},
    {"median_distance", "median distance of the vertices", true},
    {"distance_of_95", "distance that 95 % of the vertices do not exceed", true},
}};

/// A claim of an unknown name is shown by it.
std::string in_words(const FitAnswer& answer, const ClearanceClaim& claim) {
  const auto* const known = std::ranges::find(all_words, claim.what, &Words::what);
  const bool is_known = known != all_words.end();
  const std::string what = is_known ? std::string(known->words) : fmt::format("\"{}\", unknown", claim.what);
  const std::string value = exact_text(claim.value);
  const std::string area = claim.area.empty() ? std::string() : fmt::format(", area {}", claim.area);
  return fmt::format("{}{}: {}", what, area, is_known && known->is_length ? with_units(value, answer.units) : value);
}

/// What the proven distances say of the limit, whatever is claimed of it.
std::string limit_in_words(const FitAnswer& answer, const FitCheckReport& report) {
  const std::uint64_t points = points_of(answer.terms);
  std::string text = with_units(fmt::format("{}", answer.terms.penetration_limit), answer.units);
  const std::uint64_t too_deep = report.proven.proven_too_deep;
  const std::uint64_t shallow = report.proven.proven_shallow;
  if (too_deep > 0) return text + fmt::format(": EXCEEDED, proven of {} of {} vertices", too_deep, points);
  if (shallow == points) return text + fmt::format(": kept, proven of all {} vertices", points);
  return text + fmt::format(": kept, proven of {} of {} vertices; of the others not decided", shallow, points);
}

std::string claims_in_words(const FitAnswer& answer, const FitCheckReport& report) {
  if (report.interrupted()) return fmt::format("claims of the fit    {}, not judged\n", answer.claims.size());
  std::string text = verdicts_in_words("claims of the fit", report.counts());
  for (std::size_t i = 0; i < report.findings.size(); ++i) {
    const Finding& finding = report.findings[i];
    text += fmt::format("  {:<8} {}\n", name_of(finding.verdict), in_words(answer, answer.claims[i]));
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}\n", exact_text(finding.proven));
  }
  return text + fmt::format("limit                {}\n", limit_in_words(answer, report));
}

std::string readable(const FitAnswer& answer, const FitCheckReport& report, const CheckArguments& arguments) {
  std::string text = readable(report.vertices);
  if (report.surface) text += readable(*report.surface);
  text += claims_in_words(answer, report) + sides_in_words(answer, report.sides);
  text += criterion_in_words(answer.terms, answer.units);
  text += fmt::format("not claimed          {}{}areas in contact, changes of features, how near the best fit is\n",
                      answer.sides.empty() ? "whether the implant lies inside, outside or beside the mesh, " : "",
                      claims_surface(answer) ? "" : "what lies between the vertices, ");
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
                          {"sides", sides_of(answer, report.sides)},
                          {"penetration_limit", answer.terms.penetration_limit},
                          {"proven_within_limit", report.proven.proven_shallow},
                          {"proven_too_deep", report.proven.proven_too_deep},
                          {"target", answer.terms.fitness.target},
                          {"scale", answer.terms.fitness.scale},
                          {"serves", answer.terms.fitness.serves},
                          {"areas", areas_of(answer.terms)},
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
  if (!report.interrupted()) report.sides = checked_sides(answer, arguments);
  if (!report.interrupted()) judge_claims(answer, distances, surface, arguments, report);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.interrupted()) return ExitStatus::interrupted;
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
