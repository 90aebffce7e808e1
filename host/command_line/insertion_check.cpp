/// All processors check, one thread counts.
#include "host/command_line/insertion_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/insertion_certificate.hpp>
#include <verisq/mesh_file.hpp>

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

struct InsertionCheckReport {
  CheckReport rows;
  // By what is proven, whatever is claimed.
  std::uint64_t proven_cut = 0;
  std::uint64_t proven_untouched = 0;
  std::uint64_t unbounded = 0;  ///< rows that claim nothing of an end

  [[nodiscard]] std::uint64_t undecided() const { return rows.rows() - proven_cut - proven_untouched; }
  /// Of all vertices, and of no answer that is another one's.
  [[nodiscard]] bool tells_counts() const { return rows.refuted == 0 && !rows.interrupted; }
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
}

void count(const CheckedRow& row, InsertionCheckReport& report) {
  count(row, report.rows);
  const Enclosure& proven = row.finding.proven;
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

std::string readable(const InsertionAnswer& answer, const InsertionCheckReport& report,
                     const CheckArguments& arguments) {
  const CheckReport& rows = report.rows;
  const std::string units = rows.units.empty() ? std::string() : " " + rows.units;
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
  if (answer.pose) text += fmt::format("model moved by       {}: translation, quaternion\n", option_text(*answer.pose));
  text += path_in_words(answer.path, "way", "the implant's", units);
  text += meant_in_words(arguments.poses, "way");
  text += "not claimed          what lies between the vertices, how much bone is removed\n";
  text += fmt::format("time                 {:.3g} s\n", rows.seconds);
  text += fmt::format("certificate          {}{}\n", arguments.certificate, rows.interrupted ? " (interrupted)" : "");
  return rows.first ? text + readable(*rows.first, rows.elements) : text;
}

std::string json(const InsertionAnswer& answer, const InsertionCheckReport& report, const CheckArguments& arguments) {
  const CheckReport& rows = report.rows;
  const bool tells = report.tells_smallest();
  const bool counts = report.tells_counts();
  const JsonObject object{{"kind", "insertion"},
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
                          {"pose", answer.pose ? JsonValue(*answer.pose) : JsonValue()},
                          {"path_begin", answer.path.front()},
                          {"path_end", answer.path.back()},
                          {"poses", answer.path.size()},
                          {"path_length", length_of(answer.path)},
                          {"path_degrees", degrees_of(answer.path)},
                          {"first", rows.first ? JsonValue(object_of(*rows.first, rows.elements)) : JsonValue()},
                          {"units", rows.units},
                          {"seconds", rows.seconds},
                          {"interrupted", rows.interrupted},
                          {"certificate", arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_insertion_check(const InsertionAnswer& answer, const CheckArguments& arguments) {
  refuse_other_subjects(answer, arguments);
  const Model implant = read_model_at(answer.pose, arguments.models.front());
  refuse_other_units(implant.units, "model", answer.units, arguments.certificate);
  const Mesh bone = read_mesh(arguments.inputs.mesh);
  if (bone.vertices.size() != answer.rows.size()) {
    refuse(fmt::format("{}: {} rows for the {} vertices of {}", arguments.certificate, answer.rows.size(),
                       bone.vertices.size(), arguments.inputs.mesh));
  }
  watch_for_interruption();
  const InsertionCheckReport report = checked(answer, implant, bone.vertices, arguments);
  fmt::print("{}", arguments.json ? json(answer, report, arguments) : readable(answer, report, arguments));
  if (report.rows.interrupted) return ExitStatus::interrupted;
  return report.rows.all_proved() && report.unbounded == 0 ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
