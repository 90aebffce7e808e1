/// All processors bound the boxes of poses.
#include "host/command_line/best_fit_check.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>
#include <verisq/best_fit_certificate.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>

#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/stated_terms.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

struct BestFitCheckReport {
  ProvenBestFit proven;
  Verdict verdict;
  double seconds;
};

/// What is missing, or is not what the answer is about.
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
  for (std::size_t i = 0; i < answer.models.size(); ++i)
    refuse_other_file(arguments.models[i], "model", answer.models[i], certificate);
  refuse_other_file(arguments.inputs.mesh, "mesh", answer.mesh, certificate);
}

std::vector<Model> implants_of(const BestFitAnswer& answer, const CheckArguments& arguments) {
  std::vector<Model> implants;
  for (const std::string& file : arguments.models) {
    implants.push_back(read_model(file));
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
                           .interrupted = interrupted,
                           .progress = [&bar](double done) { bar.update_state("boxes of poses", done); }});
  report.verdict = check(claim, report.proven);
  report.seconds = time.seconds();
  return report;
}

/// Of the claim, or of what is proven instead.
std::string bound_in_words(double upper) {
  if (upper == -infinity) return "no pose of the range keeps the limit at all vertices";
  return fmt::format("F of any pose that keeps the limit is at most {}", upper);
}

std::string verdict_in_words(const BestFitAnswer& answer, const BestFitCheckReport& report) {
  const char* const verdict = report.proven.interrupted ? "not judged" : name_of(report.verdict);
  std::string text = fmt::format("{:<20} {}\n", verdict, bound_in_words(answer.upper));
  if (!report.proven.interrupted && report.verdict != Verdict::proved)
    text += fmt::format("  proven instead     {}\n", bound_in_words(report.proven.upper));
  return text;
}

std::string centres_in_words(const BestFitAnswer& answer, const CheckArguments& arguments) {
  std::string text;
  for (std::size_t i = 0; i < answer.centres.size(); ++i) {
    const auto& [x, y, z] = answer.centres[i];
    text += fmt::format("  about the point    ({}, {}, {}) of {}\n", x, y, z, arguments.models[i]);
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
  return text + fmt::format("certificate          {}{}\n", arguments.certificate,
                            report.proven.interrupted ? " (interrupted)" : "");
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
                          {"verdict", proven.interrupted ? JsonValue() : JsonValue(name_of(verdict))},
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

ExitStatus run_best_fit_check(const BestFitAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const std::vector<Model> implants = implants_of(answer, arguments);
  const Mesh bone = read_mesh(arguments.inputs.mesh);
  if (points_of(answer.terms) != bone.vertices.size()) {
    refuse(fmt::format("{}: area_runs: are of {} vertices, and the mesh has {}", arguments.certificate,
                       points_of(answer.terms), bone.vertices.size()));
  }
  watch_for_interruption();
  const BestFitCheckReport report = checked(answer, implants, bone, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.proven.interrupted) return ExitStatus::interrupted;
  return report.verdict == Verdict::proved ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
