/// Proves deviations and areas in contact again.
#include <fmt/core.h>
#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/deviation.hpp>
#include <verisq/files.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

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

std::string direction_of(const std::string& of, const DeviationAnswer& answer) {
  if (of == "both") return "both ways (Hausdorff)";
  return of == "model" ? fmt::format("model to {}", is_cloud(answer) ? "points" : "mesh") : of + " to model";
}

std::string not_claimed(const DeviationAnswer& answer) {
  return fmt::format("{}how far the model's surface lies from the {}",
                     answer.from_model ? "mean and percentiles of " : "", is_cloud(answer) ? "points" : "mesh");
}

std::string readable(const DeviationAnswer& answer, const JudgedAnswer& judged) {
  const std::string units = units_behind(answer.units);
  std::string text = claims_in_words(
      judged,
      [&](const JudgedClaim& claim) {
        return fmt::format("{}, {}: {}{}", direction_of(claim.of, answer), claim.what, exact_text(claim.claimed),
                           units);
      },
      unbounded_above_in_words, [&](const JudgedClaim&) { return units; });
  text += fmt::format("samples              {}, of which {} say less than they claim\n", judged.parts,
                      judged.unproved_parts);
  if (answer.pose) text += fmt::format("model moved by       {}: translation, quaternion\n", option_text(*answer.pose));
  if (!answer.statistics_from_model) text += fmt::format("not claimed          {}\n", not_claimed(answer));
  return text;
}

JsonObject object_of(const DeviationAnswer& answer, const JudgedAnswer& judged) {
  const JsonValue claims = claims_of(judged, [](const JudgedClaim& claim) {
    return JsonObject{{"of", claim.of}, {"what", claim.what}};
  });
  return {{"kind", "deviation"},
          {"claims", claims},
          {"without_an_end", judged.unbounded()},
          {"samples", judged.parts},
          {"unproved_samples", judged.unproved_parts},
          {"pose", answer.pose},
          {"units", answer.units}};
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
  return proved_again(
      {.elements = "points",
       .steps = "samples",
       .judge = [&](const CheckOptions& options) { return judge(answer, arguments.certificate, model, mesh, options); },
       .words = [&](const JudgedAnswer& judged) { return readable(answer, judged); },
       .members = [&](const JudgedAnswer& judged) { return object_of(answer, judged); }},
      arguments);
}

namespace {

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

std::string units_of(const JudgedClaim& claim, const std::string& units) {
  return claim.what == "percent" ? " %" : units_behind(units, 2);
}

std::string what_in_words(std::string_view what) {
  if (what == "percent") return "share";
  return what == "area" ? "whole area" : "area in contact";
}

/// The name that follows the colon is the certificate's.
std::string contact_in_words(const std::string& of) {
  const std::size_t colon = of.find(':');
  return colon == std::string::npos ? of : of.substr(0, colon + 1) + quotation(std::string_view(of).substr(colon + 1));
}

std::string contact_claims_in_words(const ContactAnswer& answer, const JudgedAnswer& judged) {
  const auto units = [&](const JudgedClaim& claim) { return units_of(claim, answer.units); };
  return claims_in_words(
      judged,
      [&](const JudgedClaim& claim) {
        return fmt::format("{}{}: {}, {}", exact_text(claim.claimed), units(claim), what_in_words(claim.what),
                           contact_in_words(claim.of));
      },
      unbounded_above_in_words, units);
}

/// The line that describes the implant's own surface, if that is claimed.
std::string own_surface_in_words(const std::vector<std::string>& primitives) {
  if (primitives.empty()) return "not claimed          how much of the model's own surface is in contact\n";
  return fmt::format(
      "implant_contact      of the surface of {}, as far as it is the model's own: what is as near to the mesh\n",
      quotation(primitives));
}

std::string readable(const ContactAnswer& answer, const Model& model, const JudgedAnswer& judged) {
  std::string text = contact_claims_in_words(answer, judged);
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
  return text + fmt::format("samples              {}, of which {} say less than they claim\n", judged.parts,
                            judged.unproved_parts);
}

JsonObject object_of(const ContactAnswer& answer, const Model& model, const JudgedAnswer& judged) {
  const JsonValue claims = claims_of(judged, [](const JudgedClaim& claim) {
    return JsonObject{{"name", claim.of}, {"what", claim.what}};
  });
  JsonValue::Array areas;
  const std::vector<std::uint64_t> triangles = triangles_by_region(answer);
  for (std::size_t r = 0; r < answer.regions.size(); ++r)
    areas.push_back(JsonObject{{"name", answer.regions[r]}, {"triangles", triangles[r]}});
  return {{"kind", "contact"},
          {"claims", claims},
          {"without_an_end", judged.unbounded()},
          {"distance", answer.distance},
          {"areas", areas},
          {"implant_contact_of", counted_primitives(answer, model)},
          {"samples", judged.parts},
          {"unproved_samples", judged.unproved_parts},
          {"units", answer.units}};
}

}  // namespace

ExitStatus run_check(const ContactAnswer& answer, const CheckArguments& arguments) {
  refuse_other_arguments(arguments, "areas in contact", "the fitted one");
  const Model model = subject_model(arguments.models.front(), answer.model, arguments.certificate);
  refuse_other_units(model.units, "model", answer.units, arguments.certificate);
  const Mesh mesh = subject_mesh(arguments.inputs.mesh, answer.mesh, arguments.certificate);
  return proved_again(
      {.elements = "%",
       .steps = "samples",
       .judge = [&](const CheckOptions& options) { return judge(answer, arguments.certificate, model, mesh, options); },
       .words = [&](const JudgedAnswer& judged) { return readable(answer, model, judged); },
       .members = [&](const JudgedAnswer& judged) { return object_of(answer, model, judged); }},
      arguments);
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
                            {"verdict", to_string(verdict)},
                            {"open", open},
                            {"units", answer.units},
                            {"seconds", time.seconds()},
                            {"interrupted", arguments.ended()},
                            {"certificate", arguments.certificate}};
    fmt::print("{}\n", object.text());
  } else {
    fmt::print("{:<20} {}\n", to_string(verdict), claim);
    if (!open.empty()) fmt::print("open                 {}\n", on_one_line(open));
    fmt::print("time                 {:.3g} s\ncertificate          {}{}\n", time.seconds(),
               quotation(arguments.certificate), mark_of_end(arguments.ended()));
  }
  if (arguments.ended()) return status_of_end();
  return verdict == Verdict::proved ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
