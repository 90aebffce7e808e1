/// Reads two models and a path, and follows it.
#include "host/command_line/path_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/certified_path.hpp>
#include <verisq/model_file.hpp>
#include <verisq/path_distance.hpp>
#include <verisq/pose_file.hpp>
#include <verisq/signed_distance.hpp>

#include "host/command_line/certificate_output.hpp"
#include "host/command_line/common_units.hpp"
#include "host/command_line/default_tolerance.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/path_summary.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "Time k is that of the path's pose k, from 0 on. Between two poses the translation is linear in time and the\n"
    "rotation turns about a fixed axis at constant speed, by the smaller angle (half a turn, which has two ways,\n"
    "is refused): the answer holds at all times of this motion. [lo, hi] contains the smallest distance of all times,\n"
    "0 if the models meet; then the first contact lies in the printed interval of time.\n"
    "\n"
    "Exit status: 0 the way is proven free: apart at all times, by --clearance at least where it is given; 3 it is\n"
    "not: the models meet, come too near, or it is open; 2 bad usage or input, 130 interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq path cup.json stem.json --poses reduction.csv\n"
    "  verisq path table.json gripper.json --poses trajectory.csv --clearance 2 --json\n"
    "  verisq path table.json gripper.json --poses trajectory.csv --certificate-file free.json";

struct Travellers {
  const Model& a;
  const Model& b;
  std::span<const Pose> path;
};

/// Of what was found; once interrupted it says so instead, and writes none.
void certify(const Travellers& of, PathDistanceOptions options, const PathArguments& arguments, PathReport& report) {
  const std::string& file = arguments.certificate_file;
  CertifiedPath certified = [&] {
    ProgressBar bar(!arguments.no_progress, "parts");
    options.progress = [&](const Enclosure& smallest, std::uint64_t parts) {
      bar.update_state(fmt::format("certificate: {} parts, smallest distance at least {:.4g}", parts, smallest.lo),
                       0.0);
    };
    return certified_path(of.path, of.a, of.b, report.found, options);
  }();
  if (certified.interrupted || report.found.interrupted) {
    report.found.interrupted = true;
    return tell(fmt::format("interrupted; {} is not written", file));
  }
  write_answer(file, {.models = {subject_file(arguments.model_a), subject_file(arguments.model_b)},
                      .units = report.units,
                      .path = {of.path.begin(), of.path.end()},
                      .claims = certified.claims,
                      .certificate = std::move(certified.certificate)});
  report.certificate = file;
  report.certified = certified.claims;
}

}  // namespace

void declare_path(Options& options, PathArguments& arguments) {
  options.explain(closing_words);
  options.require("A", arguments.model_a, "A.json", "Model file (verisq-model/1): it rests");
  options.require("B", arguments.model_b, "B.json", "Model file: it moves");
  options.require("--poses", arguments.poses, "FILE", "The path of B: .csv with tx,ty,tz,qw,qx,qy,qz a line");
  options.add("--clearance", arguments.clearance, parse_positive_length, "C",
              "The distance that is to be kept at all times, in model units (default: any)");
  options.add("--tol", arguments.tolerance, parse_length, "T",
              fmt::format("Largest width of the smallest distance, in model units (default: {} of the larger bounding "
                          "radius, {} with bends or set operations, whose ways take more moments)",
                          tolerance_of_distances.text, tolerance_of_searched_paths.text));
  options.add("--time-tol", arguments.time_tolerance, parse_positive_length, "T",
              "Largest width of the first contact's time (default: 1e-6 of the time between two poses)");
  options.add("--certificate-file", arguments.certificate_file, "FILE",
              "Write the answer with what proves it again, for `verisq check --certificate`: .json");
  options.add_flag("--json", arguments.json, "Print one JSON object");
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_path(const PathArguments& arguments) {
  check_certificate_file(arguments.certificate_file, {arguments.model_a, arguments.model_b, arguments.poses});
  const Model a = read_model(arguments.model_a);
  const Model b = read_model(arguments.model_b);
  const std::string units = common_units(a, b, arguments.model_a, arguments.model_b);
  const std::vector<Pose> path = read_poses(arguments.poses);
  const double radius = std::max(bounding_radius(a), bounding_radius(b));
  const bool convex = is_union_of_convex(a) && is_union_of_convex(b);
  const RelativeTolerance& usual = convex ? tolerance_of_distances : tolerance_of_searched_paths;
  PathDistanceOptions options{.tolerance = arguments.tolerance ? *arguments.tolerance
                                                               : default_tolerance(usual, radius, "the models")};
  if (arguments.time_tolerance) options.time_tolerance = *arguments.time_tolerance;
  watch_for_interruption();
  options.interrupted = interrupted;
  PathReport report{{}, path.size(), units, options.tolerance, arguments.clearance.value_or(0.0)};
  {
    ProgressBar bar(!arguments.no_progress, "moments");
    options.progress = [&](const Enclosure& smallest, std::uint64_t) {
      bar.update_state(
          fmt::format("smallest distance within [{:.4g}, {:.4g}]", std::max(0.0, smallest.lo), smallest.hi), 0.0);
    };
    report.found = distance_along(path, a, b, options);
  }
  if (!arguments.certificate_file.empty()) certify({a, b, path}, options, arguments, report);
  if (!report.found.reached && !report.found.interrupted)
    tell("rounding errors, or models that touch, end the search here; what is printed is valid, and wide");
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (report.found.interrupted) return ExitStatus::interrupted;
  return is_free(report) ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
