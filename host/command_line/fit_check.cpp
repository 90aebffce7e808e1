/// Proves fits again: their distances, the sides of their parts, and how good a fit can be at best.
#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/files.hpp>
#include <verisq/fit.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

std::vector<std::uint64_t> points_by_area(const StatedTerms& terms) {
  std::vector<std::uint64_t> points(terms.areas.size(), 0);
  for (const AreaRun& run : terms.area_runs) points[run.area] += run.points;
  return points;
}

}  // namespace

std::string with_units(const std::string& number, const std::string& units) {
  return number + units_behind(units);
}

std::string criterion_in_words(const StatedTerms& terms, const std::string& units) {
  std::string text = fmt::format(
      "criterion            distances in {} serve; F adds up weight times f, which is 1 at "
      "{} and 1/2 at {} from there\n",
      with_units(exact_text(terms.fitness.serves), units), with_units(fmt::format("{}", terms.fitness.target), units),
      with_units(fmt::format("{}", terms.fitness.scale), units));
  const std::vector<std::uint64_t> points = points_by_area(terms);
  for (std::size_t i = 0; i < terms.areas.size(); ++i) {
    text += fmt::format("area                 weight {}, {} vertices, which the certificate names {}\n",
                        terms.areas[i].weight, points[i], quotation(terms.areas[i].name));
  }
  return text;
}

JsonValue areas_of(const StatedTerms& terms) {
  JsonValue::Array areas;
  const std::vector<std::uint64_t> points = points_by_area(terms);
  for (std::size_t i = 0; i < terms.areas.size(); ++i) {
    areas.push_back(
        JsonObject{{"name", terms.areas[i].name}, {"weight", terms.areas[i].weight}, {"points", points[i]}});
  }
  return areas;
}

namespace {

std::vector<std::string> names_of(const Model& model) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < model.primitives.size(); ++k) names.push_back(name_of_primitive(model, k));
  return names;
}

void refuse_other_primitives(const FitAnswer& answer, const Model& model, const CheckArguments& arguments) {
  for (const SideClaim& claim : answer.sides) {
    if (claim.primitive >= model.primitives.size()) {
      refuse(fmt::format("{}: sides: primitive {} of {}, which has {}", arguments.certificate, claim.primitive,
                         arguments.models.front(), model.primitives.size()));
    }
  }
}

/// Describes the surface: its orientation, and its closing if it is open.
std::string mesh_in_words(const SideCheckReport& report) {
  std::string text = "the mesh";
  if (report.outward) text += fmt::format(", whose normals point {}", *report.outward ? "outward" : "inward");
  if (report.rims == 0) return text;
  const std::string over = report.rims == 1 ? "its rim" : fmt::format("its {} rims", report.rims);
  return text + fmt::format(", closed over {} by fans", over);
}

/// Parts that lie less deep may be anywhere.
std::string depth_in_words(const FitAnswer& answer) {
  const double limit = answer.terms.penetration_limit;
  if (limit == 0.0) return "all of it";
  return fmt::format("all of it that is deeper in it than {}", with_units(fmt::format("{}", limit), answer.units));
}

/// Reports errors of the mesh with its name.
SideChecker checker_of(const Model& model, const CheckArguments& arguments, double penetration_limit) try {
  return {model, read_mesh(arguments.inputs.mesh), penetration_limit};
} catch (const Error& error) {
  const bool is_named = std::string_view(error.what()).starts_with(arguments.inputs.mesh);
  if (error.kind() != ErrorKind::input || is_named) throw;
  refuse(fmt::format("{}: {}", arguments.inputs.mesh, error.what()));
}

/// The primitives without a claim.
std::vector<std::string> others_of(const FitAnswer& answer, const SideCheckReport& report) {
  std::vector<std::string> others = report.names;
  for (const SideClaim& claim : answer.sides) others[claim.primitive].clear();
  std::erase(others, "");
  return others;
}

}  // namespace

bool SideCheckReport::all_proved() const {
  return std::ranges::all_of(verdicts, [](Verdict verdict) { return verdict == Verdict::proved; });
}

SideCheckReport checked_sides(const FitAnswer& answer, const CheckArguments& arguments) {
  SideCheckReport report;
  if (answer.sides.empty()) return report;
  const Model model = read_model(arguments.models.front());
  refuse_other_primitives(answer, model, arguments);
  report.names = names_of(model);
  const SideChecker checker = checker_of(model, arguments, answer.terms.penetration_limit);
  report.rims = checker.rims();
  report.outward = checker.faces_outward();
  ProgressBar bar(!arguments.no_progress, "%");
  const CheckOptions options{.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                             .interrupted = arguments.ended,
                             .progress = [&bar](double done) { bar.update_state("sides", done); }};
  for (const SideClaim& claim : answer.sides) report.verdicts.push_back(verdict_of(checker(claim, options)));
  report.interrupted = arguments.ended();
  if (report.interrupted) report.verdicts.clear();
  return report;
}

std::string sides_in_words(const FitAnswer& answer, const SideCheckReport& report) {
  if (answer.sides.empty()) return "";
  if (report.interrupted) return fmt::format("sides                {}, not judged\n", answer.sides.size());
  std::string text = verdicts_in_words("sides of the mesh", counted(report.verdicts, [](Verdict verdict) {
                                         return Finding{verdict, {}};
                                       }));
  for (std::size_t i = 0; i < answer.sides.size(); ++i) {
    const auto& [primitive, side] = answer.sides[i];
    text += fmt::format("  {:<8} {} lies {} of {}: {}\n", to_string(report.verdicts[i]), depth_in_words(answer),
                        to_string(side), mesh_in_words(report), quotation(report.names[primitive]));
  }
  const std::vector<std::string> others = others_of(answer, report);
  if (!others.empty()) text += fmt::format("  nothing is claimed, may lie on any side: {}\n", quotation(others));
  return text + "  are these the sides and the limit that were meant? That is not proved, but for you to see\n";
}

JsonValue sides_of(const FitAnswer& answer, const SideCheckReport& report) {
  if (answer.sides.empty()) return {};
  JsonValue::Array claims;
  for (std::size_t i = 0; i < answer.sides.size(); ++i) {
    const auto& [primitive, side] = answer.sides[i];
    claims.push_back(JsonObject{
        {"primitive", report.names[primitive]},
        {"side", std::string(to_string(side))},
        {"verdict", report.interrupted ? JsonValue() : JsonValue(std::string(to_string(report.verdicts[i])))}});
  }
  return JsonObject{{"rims", report.rims},
                    {"faces_outward", report.outward ? JsonValue(*report.outward) : JsonValue()},
                    {"penetration_limit", answer.terms.penetration_limit},
                    {"claims", claims},
                    {"not_claimed", others_of(answer, report)}};
}

namespace {

struct FitCheckReport {
  CheckReport vertices;
  std::optional<CheckReport> surface = {};  ///< for triangles, if the fit has claims about them
  Clearance proven = {};                    ///< the joint statements of the vertices' distances
  std::vector<Finding> findings = {};       ///< one for each claim; none for an interrupted check
  std::uint64_t unbounded = 0;              ///< claims that have an infinite end
  SideCheckReport sides = {};

  [[nodiscard]] bool interrupted() const {
    return vertices.interrupted || (surface && surface->interrupted) || sides.interrupted;
  }
  [[nodiscard]] VerdictCounts counts() const { return counted(findings, std::identity()); }
  [[nodiscard]] bool all_proved() const {
    return vertices.all_proved() && (!surface || surface->all_proved()) && counts().all() > 0 &&
           counts().are_all_proved() && unbounded == 0 && sides.all_proved();
  }
};

bool claims_surface(const FitAnswer& answer) {
  return std::ranges::find(answer.claims, "surface_distance", &ClearanceClaim::what) != answer.claims.end();
}

/// Refuses inputs that are missing, or that do not belong to the answer.
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

/// Nothing is known about vertices without a row, or with an unproved one.
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
  report.unbounded = static_cast<std::uint64_t>(std::ranges::count_if(
      answer.claims, [](const ClearanceClaim& claim) { return !std::isfinite(claim.value.width()); }));
}

/// The subject of a claim, in words, and whether it is a length.
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
  const std::string what = is_known ? std::string(known->words) : quotation(claim.what) + ", unknown";
  const std::string value = exact_text(claim.value);
  const std::string area = claim.area.empty() ? std::string() : ", area " + quotation(claim.area);
  return fmt::format("{}: {}{}", is_known && known->is_length ? with_units(value, answer.units) : value, what, area);
}

/// The proven statement about the limit, whatever is claimed.
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
  std::string text = verdicts_in_words("claims of the fit", report.counts()) + unbounded_in_words(report.unbounded);
  for (std::size_t i = 0; i < report.findings.size(); ++i) {
    const Finding& finding = report.findings[i];
    text += fmt::format("  {:<8} {}\n", to_string(finding.verdict), in_words(answer, answer.claims[i]));
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
  return text + fmt::format("certificate          {}\n", quotation(arguments.certificate));
}

JsonValue claims_of(const FitAnswer& answer, const FitCheckReport& report) {
  JsonValue::Array claims;
  for (std::size_t i = 0; i < report.findings.size(); ++i) {
    const ClearanceClaim& claim = answer.claims[i];
    claims.push_back(JsonObject{{"what", claim.what},
                                {"area", claim.area.empty() ? JsonValue() : JsonValue(claim.area)},
                                {"verdict", to_string(report.findings[i].verdict)},
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
                          {"without_an_end", report.unbounded},
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

ExitStatus run_check(const FitAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  watch_for_interruption();
  FitCheckReport report{};
  const std::vector<Enclosure> distances = check_vertices(arguments, report);
  const std::optional<Enclosure> surface = check_surface(arguments, report);
  if (!report.interrupted()) report.sides = checked_sides(answer, arguments);
  refuse_other_subjects(answer, arguments);  // maps are checked against the files: they must still be the same
  if (!report.interrupted()) judge_claims(answer, distances, surface, arguments, report);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.interrupted()) return status_of_end();
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

namespace {

struct BestFitCheckReport {
  ProvenBestFit proven;
  Verdict verdict;
  double seconds;
};

/// Refuses inputs that are missing, or that do not belong to the answer.
void refuse_other_subjects(const BestFitAnswer& answer, const CheckArguments& arguments) {
  const std::string& certificate = arguments.certificate;
  if (arguments.models.size() != answer.models.size()) {
    refuse(fmt::format("{}: is of {} implants: give each by --model, in its order, as it lies in its own file, not {}",
                       certificate, answer.models.size(), arguments.models.size()));
  }
  if (arguments.inputs.mesh.empty()) refuse(fmt::format("{}: is of fits into a bone: give the --mesh", certificate));
  if (!arguments.map.empty() || !arguments.surface_map.empty())
    refuse(fmt::format("{}: is of all poses, not of the one of a map: not with --map", certificate));
  if (!arguments.inputs.points.empty() || arguments.inputs.pose || arguments.point_radius != 0.0)
    refuse(fmt::format("{}: is of fits: not with --points, --pose or --point-radius", certificate));
}

std::vector<Model> implants_of(const BestFitAnswer& answer, const CheckArguments& arguments) {
  std::vector<Model> implants;
  for (std::size_t i = 0; i < answer.models.size(); ++i) {
    implants.push_back(subject_model(arguments.models[i], answer.models[i], arguments.certificate));
    refuse_other_units(implants.back().units, "models", answer.units, arguments.certificate);
  }
  return implants;
}

BestFitCheckReport checked(const BestFitAnswer& answer, const std::vector<Model>& implants, const Mesh& bone,
                           const CheckArguments& arguments) {
  const BestFitClaim claim = claim_of(answer);
  ProgressBar bar(!arguments.no_progress, "%");
  const Stopwatch time;
  BestFitCheckReport report{};
  report.proven = BestFitChecker(implants, bone.vertices, claim)(
      answer.certificate, {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                           .interrupted = arguments.ended,
                           .progress = [&bar](double done) { bar.update_state("boxes of poses", done); }});
  report.verdict = check(claim, report.proven);
  report.seconds = time.seconds();
  return report;
}

/// Describes the bound of the claim, or the proven one instead.
std::string bound_in_words(double upper) {
  if (upper == -infinity) return "no pose of the range keeps the limit at all vertices";
  return fmt::format("F of any pose that keeps the limit is at most {}", upper);
}

std::string verdict_in_words(const BestFitAnswer& answer, const BestFitCheckReport& report) {
  const std::string_view verdict = report.proven.interrupted ? "not judged" : to_string(report.verdict);
  std::string text = fmt::format("{:<20} {}\n", verdict, bound_in_words(answer.upper));
  if (!report.proven.interrupted && report.verdict != Verdict::proved)
    text += fmt::format("  proven instead     {}\n", bound_in_words(report.proven.upper));
  return text;
}

std::string centres_in_words(const BestFitAnswer& answer, const CheckArguments& arguments) {
  std::string text;
  for (std::size_t i = 0; i < answer.centres.size(); ++i) {
    const auto& [x, y, z] = answer.centres[i];
    text += fmt::format("  about the point    ({}, {}, {}) of {}\n", x, y, z, quotation(arguments.models[i]));
  }
  return text;
}

std::string range_in_words(const BestFitAnswer& answer, const CheckArguments& arguments) {
  std::string text = fmt::format(
      "the range            moved by up to {} along each axis, turned by a rotation vector of up to {} degrees along "
      "each\n",
      with_units(fmt::format("{}", answer.range.translation), answer.units), answer.range.rotation_degrees);
  text += centres_in_words(answer, arguments);
  text += fmt::format("  from               {}: translation, quaternion\n", option_text(answer.range.start));
  return text + fmt::format("the limit            no vertex deeper in the implant than {}\n",
                            with_units(fmt::format("{}", answer.terms.penetration_limit), answer.units));
}

std::string readable(const BestFitAnswer& answer, const BestFitCheckReport& report, const CheckArguments& arguments) {
  std::string text = verdict_in_words(answer, report);
  text += range_in_words(answer, arguments) + criterion_in_words(answer.terms, answer.units);
  text += "  are these the range, the points and the weights that were meant? That is not proved, but for you to see\n";
  text += "not claimed          that some pose is as good: that says the certificate of a fit\n";
  text += fmt::format("boxes of poses       {}\n", report.proven.boxes);
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  return text + fmt::format("certificate          {}{}\n", quotation(arguments.certificate),
                            mark_of_end(report.proven.interrupted));
}

JsonValue finite_or_null(double number) {
  return std::isfinite(number) ? JsonValue(number) : JsonValue();
}

JsonValue centres_of(const BestFitAnswer& answer) {
  JsonValue::Array centres;
  for (const auto& [x, y, z] : answer.centres) centres.push_back(JsonValue::Array{x, y, z});
  return centres;
}

std::string json(const BestFitAnswer& answer, const BestFitCheckReport& report, const CheckArguments& arguments) {
  const auto& [proven, verdict, seconds] = report;
  const JsonObject object{{"kind", "best_fit"},
                          {"verdict", proven.interrupted ? JsonValue() : JsonValue(to_string(verdict))},
                          {"no_pose_keeps_limit", !proven.interrupted && proven.upper == -infinity},
                          {"claimed", finite_or_null(answer.upper)},
                          {"proven", proven.interrupted ? JsonValue() : finite_or_null(proven.upper)},
                          {"start", answer.range.start},
                          {"translation_range", answer.range.translation},
                          {"rotation_range", answer.range.rotation_degrees},
                          {"centres", centres_of(answer)},
                          {"penetration_limit", answer.terms.penetration_limit},
                          {"target", answer.terms.fitness.target},
                          {"scale", answer.terms.fitness.scale},
                          {"areas", areas_of(answer.terms)},
                          {"boxes", proven.boxes},
                          {"open", proven.open},
                          {"units", answer.units},
                          {"models", arguments.models},
                          {"seconds", seconds},
                          {"interrupted", proven.interrupted},
                          {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_check(const BestFitAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const std::vector<Model> implants = implants_of(answer, arguments);
  const Mesh bone = subject_mesh(arguments.inputs.mesh, answer.mesh, arguments.certificate);
  if (points_of(answer.terms) != bone.vertices.size()) {
    refuse(fmt::format("{}: area_runs: are of {} vertices, and the mesh has {}", arguments.certificate,
                       points_of(answer.terms), bone.vertices.size()));
  }
  watch_for_interruption();
  const BestFitCheckReport report = checked(answer, implants, bone, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.proven.interrupted) return status_of_end();
  return report.verdict == Verdict::proved ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
