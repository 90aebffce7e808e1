/// Reads two models and a pose, or many, and encloses their distance.
#include "host/command_line/distance_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/closest_points.hpp>
#include <verisq/map.hpp>
#include <verisq/model_distance.hpp>
#include <verisq/model_file.hpp>
#include <verisq/signed_distance.hpp>

#include "host/command_line/certificate_output.hpp"
#include "host/command_line/certified_poses.hpp"
#include "host/command_line/common_units.hpp"
#include "host/command_line/default_tolerance.hpp"
#include "host/command_line/distance_search.hpp"
#include "host/command_line/distance_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/map_to_file.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/peeked_stream.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/pose_stream.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/time_limit.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

constexpr double limit_of_certificates = 1e-12;  // of max(largest |translation|, radii), as for --poses

constexpr const char* closing_words =
    "The distance is [lo, hi], which contains the exact distance of A and of B moved by the pose: 0 where they meet.\n"
    "The closest points lie in the printed boxes, in the frame of A. \"undecided\": the models touch, or nearly, so\n"
    "that neither a gap nor a common point is proven.\n"
    "Where a model gives intervals [lo, hi] for semi-axes, exponents or translations, the enclosure contains the\n"
    "distances of all that they allow, without closest points: give a --tol above that uncertainty.\n"
    "Bent models, and csg other than the union of all primitives, are searched by branch and bound until the "
    "enclosure\n"
    "is at most the tolerance wide: without closest points, of many poses on the processors alone. Ctrl-C and the\n"
    "--time-limit end the search of one pose with the best enclosure so far, which is valid.\n"
    "With --poses, OUT has a row index,lo,hi,status for each pose, and with --closest-points the boxes, too: infinite\n"
    "where the models are not proven to be apart. Ctrl-C keeps the finished rows of a .csv or .npy under OUT.partial;\n"
    "a second Ctrl-C stops at once.\n"
    "\n"
    "Exit status: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 bad usage or input, 130\n"
    "interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq distance stem.json cup.json\n"
    "  verisq distance stem.json cup.json --pose 0,0,12.5,1,0,0,0 --json\n"
    "  verisq distance bent_stem.json cup.json --tol 1e-3 --time-limit 10\n"
    "  verisq distance stem.json cup.json --certificate-file proof.json\n"
    "  verisq distance stem.json cup.json --poses candidates.csv -o distances.csv\n"
    "  verisq distance stem.json cup.json --poses candidates.csv -o distances.csv --certificate-file proofs.json";

/// Precondition: --poses and --certificate-file.
void refuse_what_certified_poses_lack(const DistanceArguments& arguments) {
  if (arguments.device.value_or("host") != "host") {
    refuse(fmt::format("--certificate-file: the host's distances alone have certificates, not those of --device {}",
                       *arguments.device));
  }
  if (arguments.part) refuse("--certificate-file: not with --part");
  if (pose_uncertainty(arguments.pose_uncertainty)) {
    refuse("--certificate-file: of exact places only, not with --translation-error or --rotation-error");
  }
  refuse_one_file_twice({*arguments.output, *arguments.certificate_file});
  if (std::filesystem::exists(*arguments.poses) && !std::filesystem::is_regular_file(*arguments.poses)) {
    refuse(fmt::format("--certificate-file: {}: is read twice: give a regular file", *arguments.poses));
  }
}

/// Everything that the options alone tell, before any file is opened.
void check_usage(const DistanceArguments& arguments) {
  if (arguments.certificate_file) {
    std::vector<std::string> inputs{arguments.model_a, arguments.model_b};
    if (arguments.poses) inputs.push_back(*arguments.poses);
    check_certificate_file(*arguments.certificate_file, inputs);
  }
  if (!arguments.poses) {
    if (arguments.output) refuse("-o: only for many poses: give their --poses");
    if (arguments.device) refuse("--device: only for many poses: give their --poses");
    if (pose_uncertainty(arguments.pose_uncertainty)) {
      refuse("--translation-error, --rotation-error: only for --poses");
    }
    if (arguments.part) refuse("--part: only for many poses: give their --poses");
    if (arguments.closest_points) refuse("--closest-points: of one pose they are printed: only for --poses");
    return;
  }
  if (arguments.time_limit) refuse("--time-limit: only for one pose, not for --poses");
  if (!arguments.output) refuse("--poses: give the file for their distances: -o");
  if (arguments.pose) refuse("give either --pose or --poses");
  if (arguments.certificate) refuse("--certificate: those of many poses fill a --certificate-file");
  if (arguments.certificate_file) refuse_what_certified_poses_lack(arguments);
  if (arguments.closest_points && pose_uncertainty(arguments.pose_uncertainty)) {
    refuse("--closest-points: of exact places only, not with --translation-error or --rotation-error");
  }
  refuse_to_overwrite("-o", *arguments.output, {arguments.model_a, arguments.model_b, *arguments.poses});
  if (arguments.part) (void)format_of_part(*arguments.output, std::nullopt);
}

void refuse_what_uncertain_models_lack(const DistanceArguments& arguments) {
  const auto refuse_option = [&arguments](std::string_view option) {
    refuse(fmt::format("{}: not for models with intervals: {} or {} is one", option, arguments.model_a,
                       arguments.model_b));
  };
  if (arguments.poses) refuse_option("--poses");
  if (arguments.certificate) refuse_option("--certificate");
  if (arguments.certificate_file) refuse_option("--certificate-file");
}

/// The models as large as they may be: exact ones themselves.
struct LargestModels {
  Model a;
  Model b;
};

void refuse_what_searches_lack(const LargestModels& models, const DistanceArguments& arguments) {
  const std::string& path = is_union_of_convex(models.a) ? arguments.model_b : arguments.model_a;
  const auto refuse_option = [&path](std::string_view option) {
    refuse(fmt::format("{}: {}: not supported for bends, nor for csg other than the union of all primitives", option,
                       path));
  };
  if (arguments.closest_points) refuse_option("--closest-points");
}

double tolerance_of(const DistanceArguments& arguments, const LargestModels& models) {
  const double radius = std::max(bounding_radius(models.a), bounding_radius(models.b));
  return arguments.tolerance ? *arguments.tolerance : default_tolerance(tolerance_of_distances, radius, "the models");
}

/// The search knows exact numbers alone: of intervals it would answer for one member.
[[noreturn]] void refuse_uncertain_searches(const UncertainModel& a, const LargestModels& models,
                                            const DistanceArguments& arguments) {
  refuse(
      fmt::format("{}: intervals are only for pairs of models that are both unions of primitives without bends, "
                  "which {} is not",
                  is_exact(a) ? arguments.model_b : arguments.model_a,
                  is_union_of_convex(models.a) ? arguments.model_b : arguments.model_a));
}

/// Ctrl-C or the time limit.
using Stop = std::function<bool()>;

/// Uncertain models have neither closest points nor a certificate.
DistanceReport distance_of(const UncertainModel& a, const UncertainModel& b, const Pose& pose, const Stop& stop) {
  const PairDistance pair(a, b);
  const ModelDistance found = pair(pose, stop);
  DistanceReport report{found.distance, found.proximity};
  report.complete = found.complete;
  report.uncertain = !is_exact(a) || !is_exact(b);
  report.common = found.certificate.common;
  report.closest = pair.closest_points(found, pose, stop);
  report.certificate = found.certificate;
  return report;
}

/// Rounding errors are in proportion to this length.
double size_of(const LargestModels& models, const Pose& pose) {
  double size = std::max(bounding_radius(models.a), bounding_radius(models.b));
  for (const double t : pose.translation) size = std::max(size, std::abs(t));
  return size;
}

/// By certificates of convex primitives. Says what ended before its time.
DistanceReport certified_distance(const UncertainModel& a, const UncertainModel& b, const LargestModels& models,
                                  const Pose& pose, double tolerance, const std::optional<double>& seconds) {
  watch_for_interruption();
  TimeLimit limit(seconds);
  limit.start();
  const Stop stop = [&] { return interrupted() || limit.passed(); };
  DistanceReport report = distance_of(a, b, pose, stop);
  // Of uncertain models the width is that of their numbers, whatever the method does.
  const bool at_limit = report.uncertain || verified(report.distance, limit_of_certificates * size_of(models, pose));
  report.tightest = tolerance == 0.0 && report.complete && at_limit;
  const bool lacks_points = !report.uncertain && report.proximity == Proximity::separated && !report.closest;
  if ((!report.complete || lacks_points) && stop()) {
    tell(fmt::format("{}; {}", interrupted() ? "interrupted" : "the time limit is reached",
                     report.complete ? "the closest points are not enclosed" : "the enclosure is valid, and wide"));
    report.interrupted = interrupted();
  }
  return report;
}

std::optional<PartRecord> part_record(PoseStream& stream, const MapOptions& options,
                                      const DistanceArguments& arguments) {
  if (!arguments.part) return std::nullopt;
  MapPart part{.part = arguments.part->part, .parts = arguments.part->parts};
  part.rows_in_all = count_elements(stream);
  part.rows = rows_of_part(part.part, part.parts, part.rows_in_all);
  part.elements = MapElements::poses;
  part.settings = {{"command", "distance"},
                   {"format", format_of_part(*arguments.output, std::nullopt)},
                   {"tolerance", fmt::format("{}", options.tolerance)},
                   {"closest_points", arguments.closest_points ? "yes" : "no"}};
  if (options.pose_uncertainty) part.settings.push_back({"place", text_of(*options.pose_uncertainty)});
  return PartRecord(std::move(part), {arguments.model_a, arguments.model_b}, *arguments.poses);
}

/// `status`: of the map, whose rows they prove.
ExitStatus write_certificates(const LargestModels& models, const std::string& units, double tolerance,
                              ExitStatus status, const DistanceArguments& arguments) {
  PoseAnswers answers{{subject_file(arguments.model_a), subject_file(arguments.model_b)}, units, {}};
  answers.answers = certified_distances(models.a, models.b, *arguments.poses, tolerance, !arguments.no_progress);
  if (interrupted()) {
    tell("interrupted: the distances are written, without certificates");
    return ExitStatus::interrupted;
  }
  write_answer(*arguments.certificate_file, answers);
  return status;
}

ExitStatus map_poses(const LargestModels& models, const std::string& units, double tolerance,
                     const DistanceArguments& arguments) {
  PoseStream stream(*arguments.poses);
  MapOptions options{.tolerance = tolerance,
                     .device = arguments.device.value_or(arguments.certificate_file ? "host" : "auto"),
                     .pose_uncertainty = pose_uncertainty(arguments.pose_uncertainty),
                     .interrupted = interrupted};
  std::optional<PartRecord> part = part_record(stream, options, arguments);
  PartStream elements_of_part(stream, part);
  PeekedStream peeked(elements_of_part);
  options.device = part ? part->device_for(options.device) : device_for(peeked, options.device);
  MapRequest request{.elements = MapElements::poses,
                     .contents = arguments.closest_points ? MapContents::closest_points : MapContents::enclosures,
                     .output = *arguments.output,
                     .first_row = part ? part->rows().first : 0,
                     .units = units,
                     .place = options.pose_uncertainty ? described(*options.pose_uncertainty, units) : "",
                     .tolerance = tolerance,
                     .show_progress = !arguments.no_progress,
                     .json = arguments.json};
  std::optional<PairDistance> pair;
  if (arguments.closest_points) {
    pair.emplace(models.a, models.b);
    request.closest_pairs = [&](std::span<const Pose> poses) {
      std::vector<ClosestPoints> rows(poses.size());
      closest_points(*pair, poses, rows, interrupted);
      return rows;
    };
  }
  if (part) {
    request.finished = [&](const MapSummary& summary, const std::optional<ClosestPointSummary>& closest) {
      part->write(*arguments.output, summary, closest);
    };
  }
  const ExitStatus status = map_to_file(
      peeked, nullptr, [&] { return PoseMapper(models.a, models.b, options); }, request);
  if (arguments.certificate_file && !interrupted())
    return write_certificates(models, units, tolerance, status, arguments);
  return status;
}

}  // namespace

void declare_distance(Options& options, DistanceArguments& arguments) {
  options.explain(closing_words);
  options.require("A", arguments.model_a, "A.json", "Model file (verisq-model/1)");
  options.require("B", arguments.model_b, "B.json", "Model file");
  options.add("--pose", arguments.pose, parse_pose, "tx,ty,tz,qw,qx,qy,qz",
              "Moves B: translation and quaternion of any length");
  options.add("--poses", arguments.poses, "FILE", "Many poses instead: .csv with tx,ty,tz,qw,qx,qy,qz a line");
  options.add("-o,--output", arguments.output, "FILE", "The distances for --poses, by extension: .csv .npy .json");
  add_part(options, arguments.part);
  options.add_flag("--closest-points", arguments.closest_points,
                   "For --poses: boxes that contain the closest points of both models, in the frame of A, and whether\n"
                   "they are unique (.csv, .npy); some milliseconds a pose");
  options.add("--device", arguments.device, "DEVICE", fmt::format("For --poses: {}", device_of_map_explanation));
  add_pose_uncertainty(options, arguments.pose_uncertainty, "For --poses: B's");
  options.add("--tol", arguments.tolerance, parse_length, "T",
              fmt::format("Width up to which the enclosure is called verified, in model units; 0 asks for the tightest "
                          "(default: {} of the larger bounding radius)",
                          tolerance_of_distances.text));
  options.add("--time-limit", arguments.time_limit, parse_time_limit, "SECONDS",
              "Ends the work with the best enclosure so far (default: none)");
  options.add_flag("--json", arguments.json,
                   "Print one JSON object: the answer; for --poses, the summary. What is not bounded is null");
  options.add_flag("--certificate", arguments.certificate, "Print what proves the enclosure again");
  options.add(
      "--certificate-file", arguments.certificate_file, "FILE",
      "Write the answer with what proves it, for `verisq check --certificate`: .json; for --poses those of all,\n"
      "by the host, up to 64 MiB (some 100,000 poses of two primitives)");
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_distance(const DistanceArguments& arguments) {
  check_usage(arguments);
  const Pose pose = arguments.pose.value_or(Pose{});
  const UncertainModel a = read_uncertain_model(arguments.model_a);
  const UncertainModel b = read_uncertain_model(arguments.model_b);
  const std::string units = common_units(a, b, arguments.model_a, arguments.model_b);
  const bool exact = is_exact(a) && is_exact(b);
  if (!exact) refuse_what_uncertain_models_lack(arguments);
  const LargestModels models{bracket(a).largest, bracket(b).largest};
  const bool searched = !is_union_of_convex(models.a) || !is_union_of_convex(models.b);
  if (searched && !exact) refuse_uncertain_searches(a, models, arguments);
  if (searched) refuse_what_searches_lack(models, arguments);
  const double tolerance = tolerance_of(arguments, models);
  if (arguments.poses) return map_poses(models, units, tolerance, arguments);

  DistanceReport report =
      searched ? searched_distance(models.a, models.b, pose,
                                   {.tolerance = tolerance,
                                    .seconds = arguments.time_limit,
                                    .show_progress = !arguments.no_progress,
                                    .with_certificate = arguments.certificate || arguments.certificate_file})
               : certified_distance(a, b, models, pose, tolerance, arguments.time_limit);
  report.units = units;
  report.tolerance = tolerance;
  if (arguments.certificate_file) {
    write_answer(*arguments.certificate_file, {{subject_file(arguments.model_a), subject_file(arguments.model_b)},
                                               units,
                                               pose,
                                               report.certified.value_or(report.distance),
                                               report.certificate.value()});
  }
  if (!arguments.certificate) report.certificate.reset();
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (report.interrupted) return ExitStatus::interrupted;
  return is_verified(report) ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
