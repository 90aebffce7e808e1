/// Proves the smallest distances along paths and ways of insertion again.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/deviation.hpp>
#include <verisq/files.hpp>
#include <verisq/insertion.hpp>
#include <verisq/path.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"
#include "verify/proof/way_checker.hpp"

namespace verisq::command_line {

double length_of(std::span<const Pose> path) {
  double length = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const Point& from = path[k - 1].translation;
    const Point& to = path[k].translation;
    length += std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  }
  return length;
}

namespace {

/// The approximate sum of all its turns: for people.
double degrees_of(std::span<const Pose> path) {
  double degrees = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    degrees += 2.0 * std::acos(cosine_of_half_turn(path[k - 1], path[k])) * 180.0 / std::numbers::pi;
  }
  return degrees;
}

/// Begin, end, number of poses, length and turning: a line each, under "the `way` begins at". `of_what` moves.
/// Precondition: not empty; `units` empty, or after a space.
std::string path_in_words(std::span<const Pose> path, std::string_view way, std::string_view of_what,
                          std::string_view units) {
  const std::string begins = fmt::format("the {} begins at", way);
  std::string text = fmt::format("{:<21}{}: translation, quaternion\n", begins, option_text(path.front()));
  text += fmt::format("  and ends at        {}\n", option_text(path.back()));
  text += fmt::format("  poses              {}, and all between them\n", path.size());
  text += fmt::format("  length             {:.4g}{}, of {} origin\n", length_of(path), units, of_what);
  return text + fmt::format("  turning            {:.4g} degrees in all\n", degrees_of(path));
}

bool are_claims_proved(const JudgedAnswer& judged) {
  return !judged.interrupted && counted(judged.claims, &JudgedClaim::finding).are_all_proved();
}

/// The statement of proved claims about a contact.
std::string_view contact_in_words(const PathClaims& claims) {
  if (claims.smallest.lo > 0.0) return "apart at all times, between the poses too";
  if (!claims.first_contact) return "whether they meet is NOT claimed";
  if (std::isfinite(claims.first_contact->hi)) return "meet: no common point before the first contact";
  if (claims.first_contact->lo == infinity) return "no common point at any time, between the poses too";
  return "apart before the time of the first contact; whether they ever meet is NOT claimed";
}

/// The same in one word, for claims that are all proved: infinite ends of claims are null in JSON.
std::string_view contact_in_a_word(const PathClaims& claims) {
  const auto& contact = claims.first_contact;
  if (claims.smallest.lo > 0.0 || (contact && contact->lo == infinity)) return "never";
  return contact && std::isfinite(contact->hi) ? "meets" : "not_claimed";
}

std::string readable(const PathAnswer& answer, const JudgedAnswer& judged, const CheckArguments& arguments) {
  std::string text = claims_in_words(
      judged,
      [](const JudgedClaim& claim) {
        return fmt::format("{}: {}{}", claim.what, exact_text(claim.claimed), units_behind(claim.unit));
      },
      [](std::uint64_t) { return std::string(); });
  if (!std::isfinite(answer.claims.smallest.hi))
    text += "  WITHOUT AN END     nothing is claimed of the smallest distance from above\n";
  if (are_claims_proved(judged)) text += fmt::format("the models           {}\n", contact_in_words(answer.claims));
  text += fmt::format("of                   {}, which rests\n", quotation(arguments.models[0]));
  text += fmt::format("  and                {}, which moves\n", quotation(arguments.models[1]));
  text += path_in_words(answer.path, "path", "the moving model's", units_behind(answer.units));
  text += "  between the poses  steady: straight, and about one axis by the smaller angle\n";
  text += meant_in_words(arguments.poses, "path");
  return text + fmt::format("parts                {}\n", answer.certificate.parts.size());
}

JsonObject object_of(const PathAnswer& answer, const JudgedAnswer& judged, const CheckArguments& arguments) {
  return {{"kind", "path"},
          {"claims", claims_of(judged,
                               [](const JudgedClaim& claim) {
                                 return JsonObject{{"what", claim.what}};
                               })},
          {"contact", are_claims_proved(judged) ? JsonValue(contact_in_a_word(answer.claims)) : JsonValue()},
          {"path_begin", answer.path.front()},
          {"path_end", answer.path.back()},
          {"poses", answer.path.size()},
          {"path_length", length_of(answer.path)},
          {"path_degrees", degrees_of(answer.path)},
          {"parts", answer.certificate.parts.size()},
          {"units", answer.units},
          {"models", arguments.models}};
}

}  // namespace

ExitStatus run_check(const PathAnswer& answer, const CheckArguments& arguments) {
  const TwoModels models = models_of(answer.models, answer.units, arguments_of_two_models(arguments));
  refuse_other_poses(arguments.poses, answer.path, arguments.certificate);
  return proved_again(
      {.elements = "parts",
       .steps = {},
       .count = answer.certificate.parts.size(),
       .judge = [&](const CheckOptions& options) { return judge(answer, models[0], models[1], options); },
       .words = [&](const JudgedAnswer& judged) { return readable(answer, judged, arguments); },
       .members = [&](const JudgedAnswer& judged) { return object_of(answer, judged, arguments); }},
      arguments);
}

namespace {

constexpr std::size_t rows_at_a_time = 1024;  // between which progress is shown

/// The claim about the removed bone, and its finding.
struct RemovalReport {
  Enclosure claimed;
  Finding finding;
  ProvenRemovedVolume proven;
  std::vector<std::size_t> rims;
  double seconds;

  [[nodiscard]] bool is_proved() const {
    return finding.verdict == Verdict::proved && !proven.interrupted && std::isfinite(claimed.width());
  }
};

/// The claim about all points of all triangles, and its finding.
struct SurfaceReport {
  Enclosure claimed;
  Finding finding;
  bool interrupted;
  double seconds;

  [[nodiscard]] bool is_proved() const {
    return finding.verdict == Verdict::proved && !interrupted && std::isfinite(claimed.width());
  }
};

struct InsertionCheckReport {
  CheckReport rows;
  std::vector<Enclosure> proven_of_vertices = {};
  std::optional<SurfaceReport> surface = {};
  std::optional<RemovalReport> removed = {};
  // By the proven enclosures, whatever is claimed.
  std::uint64_t proven_cut = 0;
  std::uint64_t proven_untouched = 0;

  [[nodiscard]] std::uint64_t undecided() const { return rows.rows() - proven_cut - proven_untouched; }
  [[nodiscard]] bool interrupted() const {
    return rows.interrupted || (surface && surface->interrupted) || (removed && removed->proven.interrupted);
  }
  [[nodiscard]] double seconds() const {
    return rows.seconds + (surface ? surface->seconds : 0.0) + (removed ? removed->seconds : 0.0);
  }
  [[nodiscard]] bool all_proved() const {
    const bool is_of_nothing = rows.rows() == 0 && !surface && !removed;
    return !is_of_nothing && rows.all_proved() && (!surface || surface->is_proved()) &&
           (!removed || removed->is_proved());
  }
  /// True if it covers all vertices, and the answer belongs to the inputs.
  [[nodiscard]] bool tells_counts() const { return rows.rows() > 0 && rows.refuted == 0 && !rows.interrupted; }
  [[nodiscard]] bool tells_smallest() const { return tells_counts() && std::isfinite(rows.smallest.width()); }
};

/// Refuses inputs that are missing, or that do not belong to the answer.
void refuse_other_subjects(const InsertionAnswer& answer, const CheckArguments& arguments) {
  const std::string& certificate = arguments.certificate;
  if (arguments.models.size() != 1)
    refuse(fmt::format("{}: is of a way in: give one --model, the implant", certificate));
  if (arguments.inputs.mesh.empty()) refuse(fmt::format("{}: is of a way in: give the --mesh, the bone", certificate));
  if (!arguments.map.empty() || !arguments.surface_map.empty())
    refuse(fmt::format("{}: is of a way in, and holds its distances itself: not with --map", certificate));
  if (!arguments.inputs.points.empty() || arguments.point_radius != 0.0)
    refuse(fmt::format("{}: is of a way in: not with --points or --point-radius", certificate));
  if (arguments.inputs.pose)
    refuse(fmt::format("{}: is of a way in, and says itself how the model was moved: not with --pose", certificate));
  refuse_other_poses(arguments.poses, answer.path, certificate);
  const bool has_within = answer.removed && answer.removed->within;
  if (has_within && arguments.within.empty())
    refuse(fmt::format("{}: is of bone within a surface: give it by --within", certificate));
  if (!has_within && !arguments.within.empty())
    refuse(fmt::format("{}: is not of bone within a surface: not with --within", certificate));
}

void count(const CheckedRow& row, InsertionCheckReport& report) {
  count(row, report.rows);
  const Enclosure& proven = row.finding.proven;
  report.proven_of_vertices.push_back(proven);
  report.proven_cut += proven.hi < 0.0 ? 1 : 0;
  report.proven_untouched += proven.lo >= 0.0 ? 1 : 0;
}

InsertionCheckReport checked(const InsertionAnswer& answer, const Model& implant, std::span<const Point> bone,
                             const CheckArguments& arguments) {
  const InsertionChecker checker(implant, answer.path);
  InsertionCheckReport report{};
  ProgressBar bar(!arguments.no_progress, "points");
  const Stopwatch time;
  for (std::size_t first = 0; first < bone.size() && !arguments.ended(); first += rows_at_a_time) {
    std::vector<std::optional<Finding>> findings(std::min(rows_at_a_time, bone.size() - first));
    in_parallel(findings.size(), [&](std::size_t i) {
      const auto& [claimed, certificate] = answer.rows[first + i];
      if (arguments.ended()) return;
      const Finding finding = checker(bone[first + i], claimed, certificate, arguments.ended);
      if (finding.verdict != Verdict::unproved || !arguments.ended()) findings[i] = finding;
    });
    for (std::size_t i = 0; i < findings.size(); ++i)
      if (findings[i]) count({first + i, bone[first + i], answer.rows[first + i].distance, *findings[i]}, report);
    const auto done = static_cast<double>(report.rows.rows());
    bar.update(report.rows.rows(), done / static_cast<double>(bone.size()));
  }
  report.rows.elements = MapElements::vertices;
  report.rows.units = implant.units;
  report.rows.seconds = time.seconds();
  report.rows.interrupted = report.rows.rows() < bone.size();
  return report;
}

/// Checks the surface, when all vertices are done, by the proven enclosure of each, whatever is claimed.
SurfaceReport checked_surface(const InsertionAnswer& answer, const Model& implant, const Mesh& bone,
                              std::span<const Enclosure> of_vertices, const CheckArguments& arguments) {
  const WaySurfaceChecker checker(implant, answer.path, bone);
  ProgressBar bar(!arguments.no_progress, "triangles");
  const Stopwatch time;
  const auto& [claimed, certificate] = *answer.surface;
  const Finding finding = checker(of_vertices, claimed, certificate,
                                  {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                   .interrupted = arguments.ended,
                                   .progress = [&bar](double done) { bar.update_state("whole surface", done); }});
  return {claimed, finding, arguments.ended(), time.seconds()};
}

BoneRegion region_of(const RemovalAnswer& removed, const Mesh& mesh, const CheckArguments& arguments) {
  BoneRegion region{.surfaces = {{mesh, removed.bone}}, .resection = removed.resection};
  if (removed.within) {
    region.surfaces.push_back(
        {subject_mesh(arguments.within, *removed.within, arguments.certificate), BoneSide::inside});
  }
  return region;
}

/// Reports errors of the meshes with their names.
RemovedVolumeChecker removal_checker(const InsertionAnswer& answer, const Model& implant, const Mesh& mesh,
                                     const CheckArguments& arguments) {
  const BoneRegion region = region_of(*answer.removed, mesh, arguments);
  try {
    return {implant, answer.path, region};
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    const std::string within = arguments.within.empty() ? "" : ", " + arguments.within;
    refuse(fmt::format("{}{}: {}", arguments.inputs.mesh, within, error.what()));
  }
}

RemovalReport checked_removal(const InsertionAnswer& answer, const Model& implant, const Mesh& mesh,
                              const CheckArguments& arguments) {
  const RemovalAnswer& removed = *answer.removed;
  const RemovedVolumeChecker checker = removal_checker(answer, implant, mesh, arguments);
  ProgressBar bar(!arguments.no_progress, "cubes");
  const Stopwatch time;
  const ProvenRemovedVolume proven =
      checker(removed.certificate, {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                    .interrupted = arguments.ended,
                                    .progress = [&bar](double done) { bar.update_state("removed volume", done); }});
  return {removed.volume, check(removed.volume, proven.volume), proven, checker.rims(), time.seconds()};
}

/// Describes the depth to which the surface is cut: bone that lies behind it is another question.
std::string depth_in_words(const SurfaceReport& report, const std::string& units) {
  if (report.claimed.lo >= 0.0) return ": it is cut nowhere";
  return fmt::format(": it is cut nowhere deeper than {}{}", -report.claimed.lo, units);
}

std::string surface_in_words(const SurfaceReport& report, const std::string& units) {
  const auto& [claimed, finding, is_interrupted, seconds] = report;
  if (is_interrupted) return "whole surface        interrupted: nothing is said\n";
  const bool tells = finding.verdict == Verdict::proved && std::isfinite(claimed.lo);
  std::string text = fmt::format(
      "whole surface        between the vertices, too: smallest distance {}{} along the whole way, {}{}\n",
      exact_text(claimed), units, to_string(finding.verdict), tells ? depth_in_words(report, units) : std::string());
  if (!std::isfinite(claimed.width())) text += "  WITHOUT AN END     nothing is claimed on one side at least\n";
  if (finding.verdict != Verdict::proved)
    text += fmt::format("  proven of it       {}{}\n", exact_text(finding.proven), units);
  return text + fmt::format("  time               {:.3g} s\n", seconds);
}

JsonObject object_of(const SurfaceReport& report) {
  return {{"verdict", to_string(report.finding.verdict)},
          {"claimed", report.claimed},
          {"proven", report.finding.proven},
          {"without_an_end", !std::isfinite(report.claimed.width())},
          {"seconds", report.seconds}};
}

std::string bone_in_words(const RemovalAnswer& removed) {
  std::string words = removed.bone == BoneSide::inside ? "inside the mesh" : "outside of the mesh";
  if (removed.resection) {
    const auto& [point, normal] = *removed.resection;
    words += fmt::format(", before the plane through ({}) with the normal ({})", fmt::join(point, ", "),
                         fmt::join(normal, ", "));
  }
  if (removed.within) words += fmt::format(", within {}", quotation(removed.within->name));
  return words;
}

std::string removal_in_words(const RemovalAnswer& removed, const RemovalReport& report, const std::string& cubed) {
  const auto& [claimed, finding, proven, rims, seconds] = report;
  if (proven.interrupted) return "removed bone         interrupted: nothing is said\n";
  std::string text =
      fmt::format("removed bone         {}{}, {}\n", exact_text(claimed), cubed, to_string(finding.verdict));
  if (!std::isfinite(claimed.width())) text += "  WITHOUT AN END     nothing is claimed on one side at least\n";
  if (finding.verdict != Verdict::proved)
    text += fmt::format("  proven of it       {}{}\n", exact_text(finding.proven), cubed);
  else if (claimed.hi == 0.0)
    text += "  no bone lies in the implant's way: are both in the same coordinates?\n";
  text += fmt::format("  bone is            {}\n", bone_in_words(removed));
  text += fmt::format("  closed over        {} rims\n", fmt::join(rims, " and "));
  return text + fmt::format("  cubes              {}, {:.3g} s\n", proven.cubes, seconds);
}

JsonObject object_of(const RemovalAnswer& removed, const RemovalReport& report) {
  JsonObject object{{"verdict", to_string(report.finding.verdict)},
                    {"claimed", report.claimed},
                    {"proven", report.finding.proven},
                    {"bone", removed.bone == BoneSide::inside ? "inside" : "outside"},
                    {"within", removed.within ? JsonValue(removed.within->name) : JsonValue()},
                    {"without_an_end", !std::isfinite(report.claimed.width())},
                    {"rims", report.rims},
                    {"cubes", report.proven.cubes},
                    {"seconds", report.seconds}};
  const auto& plane = removed.resection;
  object.set("resection",
             plane ? JsonValue(JsonObject{{"point", plane->point}, {"normal", plane->normal}}) : JsonValue());
  return object;
}

std::string rows_in_words(const InsertionCheckReport& report, const std::string& units) {
  const CheckReport& rows = report.rows;
  std::string text = verdicts_in_words(rows);
  if (rows.proved > 0) text += fmt::format("largest width proved {}{}\n", upper_digits(rows.largest_width, 3), units);
  if (report.tells_smallest()) {
    text += fmt::format("smallest distance    {}{} of these points along the whole way, proved\n",
                        exact_text(rows.smallest), units);
  }
  if (report.tells_counts()) {
    text += fmt::format("  proven cut         {}, where bone must be removed\n", report.proven_cut);
    text += fmt::format("  proven untouched   {}\n", report.proven_untouched);
    text += fmt::format("  undecided          {}\n", report.undecided());
  }
  return text;
}

const char* what_is_not_claimed(const InsertionAnswer& answer) {
  if (answer.surface) return answer.removed ? nullptr : "how much bone is removed";
  if (!answer.removed) return "what lies between the vertices, how much bone is removed";
  return answer.rows.empty() ? "distances, of the vertices and of the whole surface"
                             : "the distances of what lies between the vertices";
}

std::string readable(const InsertionAnswer& answer, const InsertionCheckReport& report,
                     const CheckArguments& arguments) {
  const CheckReport& rows = report.rows;
  const std::string units = units_behind(rows.units);
  std::string text = answer.rows.empty() ? std::string() : rows_in_words(report, units);
  if (report.surface) text += surface_in_words(*report.surface, units);
  if (report.removed) text += removal_in_words(*answer.removed, *report.removed, units_behind(rows.units, 3));
  if (answer.pose) text += fmt::format("model moved by       {}: translation, quaternion\n", option_text(*answer.pose));
  text += path_in_words(answer.path, "way", "the implant's", units);
  text += meant_in_words(arguments.poses, "way");
  if (const char* const open = what_is_not_claimed(answer)) text += fmt::format("not claimed          {}\n", open);
  text += fmt::format("time                 {:.3g} s\n", report.seconds());
  text +=
      fmt::format("certificate          {}{}\n", quotation(arguments.certificate), mark_of_end(report.interrupted()));
  return rows.first ? text + readable(*rows.first, rows.elements) : text;
}

std::string json(const InsertionAnswer& answer, const InsertionCheckReport& report, const CheckArguments& arguments) {
  const CheckReport& rows = report.rows;
  const bool tells = report.tells_smallest();
  const bool counts = report.tells_counts();
  const JsonObject object{
      {"kind", "insertion"},
      {"points", rows.rows()},
      {"proved", rows.proved},
      {"refuted", rows.refuted},
      {"unproved", rows.unproved},
      {"largest_width_proved", rows.largest_width},
      {"smallest_distance_proved", tells ? JsonValue(rows.smallest) : JsonValue()},
      {"without_an_end", report.rows.unbounded},
      {"proven_cut", counts ? JsonValue(report.proven_cut) : JsonValue()},
      {"proven_untouched", counts ? JsonValue(report.proven_untouched) : JsonValue()},
      {"undecided", counts ? JsonValue(report.undecided()) : JsonValue()},
      {"whole_surface",
       report.surface && !report.surface->interrupted ? JsonValue(object_of(*report.surface)) : JsonValue()},
      {"removed_volume", report.removed && !report.removed->proven.interrupted
                             ? JsonValue(object_of(*answer.removed, *report.removed))
                             : JsonValue()},
      {"pose", answer.pose ? JsonValue(*answer.pose) : JsonValue()},
      {"path_begin", answer.path.front()},
      {"path_end", answer.path.back()},
      {"poses", answer.path.size()},
      {"path_length", length_of(answer.path)},
      {"path_degrees", degrees_of(answer.path)},
      {"first", rows.first ? JsonValue(object_of(*rows.first, rows.elements)) : JsonValue()},
      {"units", rows.units},
      {"seconds", report.seconds()},
      {"interrupted", report.interrupted()},
      {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_check(const InsertionAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const std::string& file = arguments.models.front();
  const Model implant = moved_by(answer.pose, subject_model(file, answer.model, arguments.certificate), file);
  refuse_other_units(implant.units, "model", answer.units, arguments.certificate);
  const Mesh bone = subject_mesh(arguments.inputs.mesh, answer.mesh, arguments.certificate);
  const bool has_rows = !answer.rows.empty();
  if (has_rows && bone.vertices.size() != answer.rows.size()) {
    refuse(fmt::format("{}: {} rows for the {} vertices of {}", arguments.certificate, answer.rows.size(),
                       bone.vertices.size(), arguments.inputs.mesh));
  }
  watch_for_interruption();
  InsertionCheckReport report = checked(answer, implant, has_rows ? bone.vertices : std::vector<Point>(), arguments);
  if (answer.surface && bone.triangles.empty())
    refuse(fmt::format("{}: is of a whole surface: {} has no triangles", arguments.certificate, arguments.inputs.mesh));
  if (answer.surface && !report.rows.interrupted)
    report.surface = checked_surface(answer, implant, bone, report.proven_of_vertices, arguments);
  if (answer.removed) report.removed = checked_removal(answer, implant, bone, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.interrupted()) return status_of_end();
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
