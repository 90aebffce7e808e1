/// All processors check the samples; then each claim is compared with what these prove.
#include "host/command_line/contact_check.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>
#include <verisq/contact_certificate.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>

#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/stated_terms.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
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
  std::vector<NumberClaimed> claims;  ///< none of an interrupted check
  double seconds;

  [[nodiscard]] VerdictCounts counts() const { return counted(claims, &NumberClaimed::finding); }
  /// That claim nothing from above.
  [[nodiscard]] std::ptrdiff_t unbounded() const {
    return std::ranges::count_if(claims, [](const NumberClaimed& claim) { return !std::isfinite(claim.value.hi); });
  }
  [[nodiscard]] bool all_proved() const { return !proven.interrupted && unbounded() == 0 && counts().are_all_proved(); }
};

/// What is missing, or is not what the answer is about.
void refuse_other_subjects(const ContactAnswer& answer, const CheckArguments& arguments) {
  const std::string& certificate = arguments.certificate;
  if (arguments.models.size() != 1)
    refuse(fmt::format("{}: is of areas in contact: give one --model, the fitted one", certificate));
  if (arguments.inputs.mesh.empty()) refuse(fmt::format("{}: is of areas in contact: give the --mesh", certificate));
  if (!arguments.map.empty() || !arguments.surface_map.empty())
    refuse(fmt::format("{}: is of areas in contact, and holds its distances itself: not with --map", certificate));
  if (!arguments.inputs.points.empty() || arguments.inputs.pose || arguments.point_radius != 0.0)
    refuse(fmt::format("{}: is of areas in contact: not with --points, --pose or --point-radius", certificate));
  refuse_other_file(arguments.models.front(), "model", answer.model, certificate);
  refuse_other_file(arguments.inputs.mesh, "mesh", answer.mesh, certificate);
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
                                         .interrupted = interrupted,
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

/// Whose surface the implant's own is, by name.
std::vector<std::string> counted_primitives(const ContactAnswer& answer, const Model& model) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < answer.counted.size(); ++k) {
    if (answer.counted[k]) names.push_back(name_of_primitive(model, k));
  }
  return names;
}

/// How many triangles each has.
std::vector<std::uint64_t> triangles_by_region(const ContactAnswer& answer) {
  std::vector<std::uint64_t> triangles(answer.regions.size(), 0);
  for (const auto& [region, count] : answer.region_runs) triangles[region] += count;
  return triangles;
}

std::string value_in_words(const char* what, const Enclosure& value, const std::string& units) {
  const std::string text = exact_text(value);
  if (std::string_view(what) == "percent") return text + " %";
  return units.empty() ? text : fmt::format("{} {}^2", text, units);
}

std::string what_in_words(const char* what) {
  if (std::string_view(what) == "percent") return "share";
  return std::string_view(what) == "area" ? "whole area" : "area in contact";
}

std::string claims_in_words(const ContactAnswer& answer, const ContactCheckReport& report) {
  std::string text = verdicts_in_words("claims", report.counts());
  if (report.unbounded() > 0)
    text += fmt::format("  WITHOUT AN END     {}: of these nothing is claimed from above\n", report.unbounded());
  for (const auto& [of, what, value, finding] : report.claims) {
    text += fmt::format("  {:<8} {}, {}: {}\n", name_of(finding.verdict), of, what_in_words(what),
                        value_in_words(what, value, answer.units));
    if (finding.verdict != Verdict::proved)
      text += fmt::format("           proven of it: {}\n", value_in_words(what, finding.proven, answer.units));
  }
  return text;
}

/// The line of what counts as the implant's own surface, if that is claimed.
std::string own_surface_in_words(const std::vector<std::string>& primitives) {
  if (primitives.empty()) return "not claimed          how much of the model's own surface is in contact\n";
  return fmt::format(
      "implant_contact      of the surface of {}, as far as it is the model's own: what is as near to the mesh\n",
      fmt::join(primitives, ", "));
}

std::string readable(const ContactAnswer& answer, const Model& model, const ContactCheckReport& report,
                     const CheckArguments& arguments) {
  std::string text = claims_in_words(answer, report);
  text += fmt::format("in contact           what is no farther than {} from the model's surface, inside or outside\n",
                      with_units(fmt::format("{}", answer.distance), answer.units));
  const std::vector<std::uint64_t> triangles = triangles_by_region(answer);
  for (std::size_t r = 0; r < answer.regions.size(); ++r)
    text += fmt::format("area {:<15} {} triangles, which the certificate names\n", answer.regions[r], triangles[r]);
  const std::vector<std::string> primitives = counted_primitives(answer, model);
  text += own_surface_in_words(primitives);
  text += fmt::format("  are these the distance{} that were meant? That is not proved, but for you to see\n",
                      primitives.empty() ? " and the areas" : ", the areas and the primitives");
  text += fmt::format("samples              {}, of which {} say less than they claim\n", report.proven.samples,
                      report.proven.unproved_samples);
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  return text + fmt::format("certificate          {}{}\n", arguments.certificate,
                            report.proven.interrupted ? " (interrupted)" : "");
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

ExitStatus run_contact_check(const ContactAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const Model model = read_model(arguments.models.front());
  refuse_other_units(model.units, "model", answer.units, arguments.certificate);
  const Mesh mesh = read_mesh(arguments.inputs.mesh);
  refuse_other_sizes(answer, model, mesh, arguments.certificate);
  watch_for_interruption();
  const ContactCheckReport report = checked(answer, model, mesh, arguments);
  fmt::print("{}",
             arguments.json ? json(answer, model, report, arguments) : readable(answer, model, report, arguments));
  if (report.proven.interrupted) return ExitStatus::interrupted;
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
