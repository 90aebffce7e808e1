/// All processors check, of rows one thread counts.
#include "host/command_line/insertion_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/deviation_certificate.hpp>
#include <verisq/insertion_certificate.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/removed_volume_certificate.hpp>
#include <verisq/way_surface_certificate.hpp>

#include "host/command_line/certificate_check.hpp"
#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/path_extent.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

constexpr std::size_t rows_at_a_time = 1024;  // between which progress is shown

/// What is claimed of the bone that is taken away, and what became of it.
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

/// What is claimed of all points of all triangles, and what became of it.
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
  // By what is proven, whatever is claimed.
  std::uint64_t proven_cut = 0;
  std::uint64_t proven_untouched = 0;
  std::uint64_t unbounded = 0;  ///< rows that claim nothing of an end

  [[nodiscard]] std::uint64_t undecided() const { return rows.rows() - proven_cut - proven_untouched; }
  [[nodiscard]] bool interrupted() const {
    return rows.interrupted || (surface && surface->interrupted) || (removed && removed->proven.interrupted);
  }
  [[nodiscard]] double seconds() const {
    return rows.seconds + (surface ? surface->seconds : 0.0) + (removed ? removed->seconds : 0.0);
  }
  [[nodiscard]] bool all_proved() const {
    return rows.all_proved() && unbounded == 0 && (!surface || surface->is_proved()) &&
           (!removed || removed->is_proved());
  }
  /// Of all vertices, and of no answer that is another one's.
  [[nodiscard]] bool tells_counts() const { return rows.rows() > 0 && rows.refuted == 0 && !rows.interrupted; }
  [[nodiscard]] bool tells_smallest() const { return tells_counts() && std::isfinite(rows.smallest.width()); }
};

/// What is missing, or is not what the answer is about.
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
  refuse_other_file(arguments.models.front(), "model", answer.model, certificate);
  refuse_other_file(arguments.inputs.mesh, "mesh", answer.mesh, certificate);
  refuse_other_poses(arguments.poses, answer.path, certificate);
  const bool has_within = answer.removed && answer.removed->within;
  if (has_within && arguments.within.empty())
    refuse(fmt::format("{}: is of bone within a surface: give it by --within", certificate));
  if (!has_within && !arguments.within.empty())
    refuse(fmt::format("{}: is not of bone within a surface: not with --within", certificate));
  if (has_within) refuse_other_file(arguments.within, "mesh", *answer.removed->within, certificate);
}

void count(const CheckedRow& row, InsertionCheckReport& report) {
  count(row, report.rows);
  const Enclosure& proven = row.finding.proven;
  report.proven_of_vertices.push_back(proven);
  report.proven_cut += proven.hi < 0.0 ? 1 : 0;
  report.proven_untouched += proven.lo >= 0.0 ? 1 : 0;
  report.unbounded += std::isfinite(row.claimed.lo) && std::isfinite(row.claimed.hi) ? 0 : 1;
}

InsertionCheckReport checked(const InsertionAnswer& answer, const Model& implant, std::span<const Point> bone,
                             const CheckArguments& arguments) {
  const InsertionChecker checker(implant, answer.path);
  InsertionCheckReport report{};
  ProgressBar bar(!arguments.no_progress, "points");
  const Stopwatch time;
  for (std::size_t first = 0; first < bone.size() && !interrupted(); first += rows_at_a_time) {
    std::vector<std::optional<Finding>> findings(std::min(rows_at_a_time, bone.size() - first));
    in_parallel(findings.size(), [&](std::size_t i) {
      const auto& [claimed, certificate] = answer.rows[first + i];
      if (!interrupted()) findings[i] = checker(bone[first + i], claimed, certificate);
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

/// Of vertices of which all are done, by what is proven of each, whatever is claimed.
SurfaceReport checked_surface(const InsertionAnswer& answer, const Model& implant, const Mesh& bone,
                              std::span<const Enclosure> of_vertices, const CheckArguments& arguments) {
  const WaySurfaceChecker checker(implant, answer.path, bone);
  ProgressBar bar(!arguments.no_progress, "triangles");
  const Stopwatch time;
  const auto& [claimed, certificate] = *answer.surface;
  const Finding finding = checker(of_vertices, claimed, certificate,
                                  {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                   .interrupted = interrupted,
                                   .progress = [&bar](double done) { bar.update_state("whole surface", done); }});
  return {claimed, finding, interrupted(), time.seconds()};
}

BoneRegion region_of(const RemovalAnswer& removed, const Mesh& mesh, const CheckArguments& arguments) {
  BoneRegion region{.surfaces = {{mesh, removed.bone}}, .resection = removed.resection};
  if (removed.within) region.surfaces.push_back({read_mesh(arguments.within), BoneSide::inside});
  return region;
}

/// What is wrong with them is told with the names of the meshes.
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
                                    .interrupted = interrupted,
                                    .progress = [&bar](double done) { bar.update_state("removed volume", done); }});
  return {removed.volume, check(removed.volume, proven.volume), proven, checker.rims(), time.seconds()};
}

/// How deep the surface is cut: bone that lies behind it is another question.
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
      exact_text(claimed), units, name_of(finding.verdict), tells ? depth_in_words(report, units) : std::string());
  if (!std::isfinite(claimed.width())) text += "  WITHOUT AN END     nothing is claimed on one side at least\n";
  if (finding.verdict != Verdict::proved)
    text += fmt::format("  proven of it       {}{}\n", exact_text(finding.proven), units);
  return text + fmt::format("  time               {:.3g} s\n", seconds);
}

JsonObject object_of(const SurfaceReport& report) {
  return {{"verdict", name_of(report.finding.verdict)},
          {"claimed", report.claimed},
          {"proven", report.finding.proven},
          {"without_an_end", !std::isfinite(report.claimed.width())},
          {"seconds", report.seconds}};
}

std::string bone_in_words(const RemovalAnswer& removed) {
  std::string words = removed.bone == BoneSide::inside ? "inside the mesh" : "outside of the mesh";
  if (removed.within) words += fmt::format(", within {}", removed.within->name);
  if (removed.resection) {
    const auto& [point, normal] = *removed.resection;
    words += fmt::format(", before the plane through ({}) with the normal ({})", fmt::join(point, ", "),
                         fmt::join(normal, ", "));
  }
  return words;
}

std::string removal_in_words(const RemovalAnswer& removed, const RemovalReport& report, const std::string& units) {
  const auto& [claimed, finding, proven, rims, seconds] = report;
  const std::string cubed = units.empty() ? units : units + "^3";
  if (proven.interrupted) return "removed bone         interrupted: nothing is said\n";
  std::string text =
      fmt::format("removed bone         {}{}, {}\n", exact_text(claimed), cubed, name_of(finding.verdict));
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
  JsonObject object{{"verdict", name_of(report.finding.verdict)},
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
  if (report.unbounded > 0)
    text +=
        fmt::format("  WITHOUT AN END     {}: of these nothing is claimed on one side at least\n", report.unbounded);
  if (rows.proved > 0) text += fmt::format("largest width proved {:.3g}{}\n", rows.largest_width, units);
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
  const std::string units = rows.units.empty() ? std::string() : " " + rows.units;
  std::string text = answer.rows.empty() ? std::string() : rows_in_words(report, units);
  if (report.surface) text += surface_in_words(*report.surface, units);
  if (report.removed) text += removal_in_words(*answer.removed, *report.removed, units);
  if (answer.pose) text += fmt::format("model moved by       {}: translation, quaternion\n", option_text(*answer.pose));
  text += path_in_words(answer.path, "way", "the implant's", units);
  text += meant_in_words(arguments.poses, "way");
  if (const char* const open = what_is_not_claimed(answer)) text += fmt::format("not claimed          {}\n", open);
  text += fmt::format("time                 {:.3g} s\n", report.seconds());
  text +=
      fmt::format("certificate          {}{}\n", arguments.certificate, report.interrupted() ? " (interrupted)" : "");
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
      {"without_an_end", report.unbounded},
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

ExitStatus run_insertion_check(const InsertionAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const Model implant = read_model_at(answer.pose, arguments.models.front());
  refuse_other_units(implant.units, "model", answer.units, arguments.certificate);
  const Mesh bone = read_mesh(arguments.inputs.mesh);
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
  if (report.interrupted()) return ExitStatus::interrupted;
  return report.all_proved() ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
