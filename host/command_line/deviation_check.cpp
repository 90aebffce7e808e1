/// Proves deviations and areas in contact again.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>
#include <verisq/deviation.hpp>
#include <verisq/files.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/inputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/command_line/values.hpp"
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
  std::vector<Claim> claims;  ///< none for an interrupted check
  std::string units;
  double seconds;

  [[nodiscard]] VerdictCounts counts() const { return counted(claims, &Claim::finding); }
  /// The number of claims that are unbounded from above.
  [[nodiscard]] std::ptrdiff_t unbounded() const {
    return std::ranges::count_if(claims, [](const Claim& claim) { return !std::isfinite(claim.value.hi); });
  }
  [[nodiscard]] bool all_proved() const { return !proven.interrupted && unbounded() == 0 && counts().are_all_proved(); }
};

bool is_cloud(const DeviationAnswer& answer) {
  return answer.certificate.triangles.empty();
}

/// Refuses inputs that are missing, or that do not belong to the answer.
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
  if (is_cloud(answer)) refuse_other_file(given, "cloud", answer.mesh, certificate);
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

/// Adds the claims about the model's surface, if there are any.
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
                                             .interrupted = arguments.ended,
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
  const std::string units = units_behind(report.units);
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
  return text + fmt::format("certificate          {}{}\n", quotation(arguments.certificate),
                            mark_of_end(report.proven.interrupted));
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

ExitStatus run_check(const DeviationAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const std::string& file = arguments.models.front();
  const Model model = moved_by(answer.pose, subject_model(file, answer.model, arguments.certificate), file);
  refuse_other_units(model.units, "model", answer.units, arguments.certificate);
  const Mesh mesh = is_cloud(answer) ? read_cloud(arguments.inputs.points)
                                     : subject_mesh(arguments.inputs.mesh, answer.mesh, arguments.certificate);
  // Clouds are read from the file: it must still be the same.
  if (is_cloud(answer)) refuse_other_file(arguments.inputs.points, "cloud", answer.mesh, arguments.certificate);
  refuse_other_sizes(answer, mesh, arguments);
  watch_for_interruption();
  const DeviationCheckReport report = checked(answer, model, mesh, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.proven.interrupted) return status_of_end();
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

namespace {

/// One number of an area.
struct NumberClaimed {
  std::string of;    ///< "contact", "contact:AREA", as a fit names them
  const char* what;  ///< "area", "within", "percent"
  Enclosure value;
  Finding finding;
};

struct ContactCheckReport {
  ProvenContact proven;
  std::vector<NumberClaimed> claims;  ///< none for an interrupted check
  double seconds;

  [[nodiscard]] VerdictCounts counts() const { return counted(claims, &NumberClaimed::finding); }
  /// The number of claims that are unbounded from above.
  [[nodiscard]] std::ptrdiff_t unbounded() const {
    return std::ranges::count_if(claims, [](const NumberClaimed& claim) { return !std::isfinite(claim.value.hi); });
  }
  [[nodiscard]] bool all_proved() const { return !proven.interrupted && unbounded() == 0 && counts().are_all_proved(); }
};

/// Refuses arguments that are missing, or do not go with an answer of model and mesh. The messages call it
/// `what`.
void refuse_other_arguments(const CheckArguments& arguments, std::string_view what, std::string_view model) {
  const std::string of = fmt::format("{}: is of {}", arguments.certificate, what);
  if (arguments.models.size() != 1) refuse(fmt::format("{}: give one --model, {}", of, model));
  if (arguments.inputs.mesh.empty()) refuse(fmt::format("{}: give the --mesh", of));
  if (!arguments.map.empty() || !arguments.surface_map.empty())
    refuse(fmt::format("{}, and holds its distances itself: not with --map", of));
  if (!arguments.inputs.points.empty() || arguments.inputs.pose || arguments.point_radius != 0.0)
    refuse(fmt::format("{}: not with --points, --pose or --point-radius", of));
}

void refuse_other_sizes(const ContactAnswer& answer, const Model& model, const Mesh& mesh,
                        const std::string& certificate) {
  const auto& [vertices, divided, surface] = answer.certificate;
  const std::size_t triangles = mesh.triangles.size();
  if (vertices.size() != mesh.vertices.size())
    refuse(
        fmt::format("{}: is of {} vertices, and the mesh has {}", certificate, vertices.size(), mesh.vertices.size()));
  if (!divided.empty() && divided.back().triangle >= triangles)
    refuse(fmt::format("{}: names triangle {}, of {}", certificate, divided.back().triangle, triangles));
  if (!answer.regions.empty() && points_of(answer.region_runs) != triangles)
    refuse(fmt::format("{}: region_runs: are of {} triangles, and the mesh has {}", certificate,
                       points_of(answer.region_runs), triangles));
  if (surface && answer.counted.size() != model.primitives.size())
    refuse(fmt::format("{}: has patches of {} primitives, and the model has {}", certificate, answer.counted.size(),
                       model.primitives.size()));
  if (surface && triangles == 0) refuse(fmt::format("{}: is of a mesh, and there are no triangles", certificate));
}

void add_claims(const std::string& of, const ContactClaim& claimed, const AreaWithin& proven,
                std::vector<NumberClaimed>& claims) {
  const auto [area, within, percent] = check(claimed, proven);
  claims.push_back({of, "area", claimed.area, area});
  claims.push_back({of, "within", claimed.within, within});
  claims.push_back({of, "percent", claimed.percent, percent});
}

ContactCheckReport checked(const ContactAnswer& answer, const Model& model, const Mesh& mesh,
                           const CheckArguments& arguments) {
  ProgressBar bar(!arguments.no_progress, "%");
  const Stopwatch time;
  ContactCheckReport report{};
  report.proven = ContactChecker(model)(mesh, terms_of(answer), answer.certificate,
                                        {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                         .interrupted = arguments.ended,
                                         .progress = [&bar](double done) { bar.update_state("samples", done); }});
  report.seconds = time.seconds();
  if (report.proven.interrupted) return report;
  add_claims("contact", answer.claims.of_mesh, report.proven.of_mesh, report.claims);
  for (std::size_t r = 0; r < answer.regions.size(); ++r)
    add_claims("contact:" + answer.regions[r], answer.claims.by_region[r], report.proven.by_region[r], report.claims);
  if (const auto& claimed = answer.claims.of_model)
    add_claims("implant_contact", *claimed, *report.proven.of_model, report.claims);
  return report;
}

/// The names of the primitives whose surface counts as the implant's own.
std::vector<std::string> counted_primitives(const ContactAnswer& answer, const Model& model) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < answer.counted.size(); ++k) {
    if (answer.counted[k]) names.push_back(name_of_primitive(model, k));
  }
  return names;
}

/// The number of triangles of each region.
std::vector<std::uint64_t> triangles_by_region(const ContactAnswer& answer) {
  std::vector<std::uint64_t> triangles(answer.regions.size(), 0);
  for (const auto& [region, count] : answer.region_runs) triangles[region] += count;
  return triangles;
}

std::string value_in_words(const char* what, const Enclosure& value, const std::string& units) {
  const std::string text = exact_text(value);
  if (std::string_view(what) == "percent") return text + " %";
  return text + units_behind(units, 2);
}

std::string what_in_words(const char* what) {
  if (std::string_view(what) == "percent") return "share";
  return std::string_view(what) == "area" ? "whole area" : "area in contact";
}

/// The name that follows the colon is the certificate's.
std::string contact_in_words(const std::string& of) {
  const std::size_t colon = of.find(':');
  return colon == std::string::npos ? of : of.substr(0, colon + 1) + quotation(std::string_view(of).substr(colon + 1));
}

std::string claims_in_words(const ContactAnswer& answer, const ContactCheckReport& report) {
  std::string text = verdicts_in_words("claims", report.counts());
  if (report.unbounded() > 0)
    text += fmt::format("  WITHOUT AN END     {}: of these nothing is claimed from above\n", report.unbounded());
  for (const auto& [of, what, value, finding] : report.claims) {
    text += fmt::format("  {:<8} {}: {}, {}\n", name_of(finding.verdict), value_in_words(what, value, answer.units),
                        what_in_words(what), contact_in_words(of));
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}\n", value_in_words(what, finding.proven, answer.units));
  }
  return text;
}

/// The line that describes the implant's own surface, if that is claimed.
std::string own_surface_in_words(const std::vector<std::string>& primitives) {
  if (primitives.empty()) return "not claimed          how much of the model's own surface is in contact\n";
  return fmt::format(
      "implant_contact      of the surface of {}, as far as it is the model's own: what is as near to the mesh\n",
      quotation(primitives));
}

std::string readable(const ContactAnswer& answer, const Model& model, const ContactCheckReport& report,
                     const CheckArguments& arguments) {
  std::string text = claims_in_words(answer, report);
  text += fmt::format("in contact           what is no farther than {} from the model's surface, inside or outside\n",
                      with_units(fmt::format("{}", answer.distance), answer.units));
  const std::vector<std::uint64_t> triangles = triangles_by_region(answer);
  for (std::size_t r = 0; r < answer.regions.size(); ++r)
    text += fmt::format("area                 {} triangles, which the certificate names {}\n", triangles[r],
                        quotation(answer.regions[r]));
  const std::vector<std::string> primitives = counted_primitives(answer, model);
  text += own_surface_in_words(primitives);
  text += fmt::format("  are these the distance{} that were meant? That is not proved, but for you to see\n",
                      primitives.empty() ? " and the areas" : ", the areas and the primitives");
  text += fmt::format("samples              {}, of which {} say less than they claim\n", report.proven.samples,
                      report.proven.unproved_samples);
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  return text + fmt::format("certificate          {}{}\n", quotation(arguments.certificate),
                            mark_of_end(report.proven.interrupted));
}

std::string json(const ContactAnswer& answer, const Model& model, const ContactCheckReport& report,
                 const CheckArguments& arguments) {
  JsonValue::Array claims;
  for (const auto& [of, what, value, finding] : report.claims) {
    claims.push_back(JsonObject{{"name", of},
                                {"what", what},
                                {"verdict", name_of(finding.verdict)},
                                {"claimed", value},
                                {"proven", finding.proven}});
  }
  JsonValue::Array areas;
  const std::vector<std::uint64_t> triangles = triangles_by_region(answer);
  for (std::size_t r = 0; r < answer.regions.size(); ++r)
    areas.push_back(JsonObject{{"name", answer.regions[r]}, {"triangles", triangles[r]}});
  JsonValue::Array primitives;
  for (const std::string& name : counted_primitives(answer, model)) primitives.push_back(name);
  const JsonObject object{{"kind", "contact"},
                          {"claims", claims},
                          {"without_an_end", report.unbounded()},
                          {"distance", answer.distance},
                          {"areas", areas},
                          {"implant_contact_of", primitives},
                          {"samples", report.proven.samples},
                          {"unproved_samples", report.proven.unproved_samples},
                          {"units", answer.units},
                          {"seconds", report.seconds},
                          {"interrupted", report.proven.interrupted},
                          {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_check(const ContactAnswer& answer, const CheckArguments& arguments) {
  refuse_other_arguments(arguments, "areas in contact", "the fitted one");
  const Model model = subject_model(arguments.models.front(), answer.model, arguments.certificate);
  refuse_other_units(model.units, "model", answer.units, arguments.certificate);
  const Mesh mesh = subject_mesh(arguments.inputs.mesh, answer.mesh, arguments.certificate);
  refuse_other_sizes(answer, model, mesh, arguments.certificate);
  watch_for_interruption();
  const ContactCheckReport report = checked(answer, model, mesh, arguments);
  fmt::print("{}",
             arguments.json ? json(answer, model, report, arguments) : readable(answer, model, report, arguments));
  if (report.proven.interrupted) return status_of_end();
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

ExitStatus run_check(const ContainmentAnswer& answer, const CheckArguments& arguments) {
  refuse_other_arguments(arguments, "a containment", "the contained or containing one");
  const Model model = subject_model(arguments.models.front(), answer.model, arguments.certificate);
  refuse_other_units(model.units, "model", answer.units, arguments.certificate);
  const Mesh mesh = subject_mesh(arguments.inputs.mesh, answer.mesh, arguments.certificate);
  watch_for_interruption();
  ProgressBar bar(!arguments.no_progress, "%");
  const Stopwatch time;
  const auto& [verdict, open] =
      ContainmentChecker(model, mesh)(answer.containment, answer.certificate,
                                      {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                       .interrupted = arguments.ended,
                                       .progress = [&bar](double done) { bar.update_state("containment", done); }});
  const bool within = answer.containment == Containment::within;
  const std::string claim = within ? "every point of the model lies in the mesh's solid"
                                   : "every point of the mesh's solid lies in the model";
  if (arguments.json) {
    const JsonObject object{{"kind", "containment"},
                            {"containment", within ? "within" : "around"},
                            {"verdict", name_of(verdict)},
                            {"open", open},
                            {"units", answer.units},
                            {"seconds", time.seconds()},
                            {"interrupted", arguments.ended()},
                            {"certificate", arguments.certificate}};
    fmt::print("{}\n", object.text());
  } else {
    fmt::print("{:<20} {}\n", name_of(verdict), claim);
    if (!open.empty()) fmt::print("open                 {}\n", on_one_line(open));
    fmt::print("time                 {:.3g} s\ncertificate          {}{}\n", time.seconds(),
               quotation(arguments.certificate), mark_of_end(arguments.ended()));
  }
  if (arguments.ended()) return status_of_end();
  return verdict == Verdict::proved ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
