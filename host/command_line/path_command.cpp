/// `verisq path`: encloses the smallest distance of two models while one of them moves, and when they first meet.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>
#include <verisq/path.hpp>

#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/shared_inputs.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

// The output of `verisq path`: for people, or as one JSON object.

struct PathReport {
  PathDistance found;
  std::size_t poses;
  std::string units;  ///< of both models; empty when not given
  double tolerance;
  double clearance;                                    ///< the requested clearance; 0: any
  std::string certificate = {};                        ///< its file; empty without
  std::optional<PathClaims> certified = std::nullopt;  ///< the claims that it proves, which may be weaker than the
                                                       ///< found ones
};

/// Returns whether the moving model is proven to stay apart from the other, by the clearance; by a certificate, too, if
/// there is one.
[[nodiscard]] bool is_free(const PathReport& report);

struct PathArguments {
  std::string model_a;
  std::string model_b;
  std::string poses;
  std::optional<double> tolerance;
  std::optional<double> time_tolerance;
  std::optional<double> clearance;
  std::string certificate_file;
  std::optional<double> time_limit;  ///< in seconds
  bool json = false;
  bool no_progress = false;
};

std::string_view word(PathProximity proximity) {
  switch (proximity) {
    case PathProximity::apart: return "apart";
    case PathProximity::meeting: return "meeting";
    case PathProximity::undecided: return "undecided";
  }
  return "";
}

std::string explanation(const PathReport& report) {
  switch (report.found.proximity) {
    case PathProximity::apart: return "proven: no common point at any time, between the poses neither";
    case PathProximity::meeting: return "proven: a common point at some time";
    case PathProximity::undecided: break;
  }
  const std::string open = "neither a gap all the way nor a common point is proven";
  return report.found.interrupted ? fmt::format("{}: {}", reason_of_end(), open) : open;
}

/// The verdict on a requested clearance.
std::string_view verdict_on_clearance(const PathReport& report) {
  if (is_free(report)) return "proven at all times";
  return report.found.smallest.hi < report.clearance ? "proven NOT to be kept" : "open";
}

bool is_free(const PathReport& report) {
  if (report.certified && !(report.certified->smallest.lo > 0.0 && report.certified->smallest.lo >= report.clearance))
    return false;
  return report.found.proximity == PathProximity::apart && report.found.smallest.lo >= report.clearance;
}

std::string readable(const PathReport& report) {
  const PathDistance& found = report.found;
  const std::string units = units_behind(report.units);
  std::string text = fmt::format("path               {} pose{}, times 0 to {}; looked at {} moments\n", report.poses,
                                 report.poses == 1 ? "" : "s", report.poses - 1, found.moments);
  text += fmt::format("smallest distance  [{:.17g}, {:.17g}]{} of all times; at most the upper end at time {:.17g}\n",
                      found.smallest.lo, found.smallest.hi, units, found.smallest_at);
  text += fmt::format("width              {:.3g}{}, tolerance {:.3g}{}\n", found.smallest.width(), units,
                      report.tolerance, units);
  text += fmt::format("proximity          {} ({})\n", word(found.proximity), explanation(report));
  if (found.meet_at) {
    text += fmt::format("first contact      in [{:.17g}, {:.17g}]: no common point before, one at the later time\n",
                        found.apart_before, *found.meet_at);
  }
  if (report.clearance > 0.0)
    text += fmt::format("clearance          {:.17g}{}: {}\n", report.clearance, units, verdict_on_clearance(report));
  text += fmt::format("the way            {}\n", is_free(report) ? "proven free" : "NOT proven free");
  if (report.certified) {
    text += fmt::format("certificate        [{:.17g}, {:.17g}]{} of all times: {}\n", report.certified->smallest.lo,
                        report.certified->smallest.hi, units, quotation(report.certificate));
    if (const auto& contact = report.certified->first_contact)
      text += fmt::format("  first contact    in [{:.17g}, {:.17g}]\n", contact->lo, contact->hi);
  }
  return text;
}

std::string json(const PathReport& report) {
  const PathDistance& found = report.found;
  const std::optional<PathClaims>& certified = report.certified;
  const std::optional<Enclosure> contact = certified ? certified->first_contact : std::nullopt;
  return JsonObject{{"lo", found.smallest.lo},
                    {"hi", found.smallest.hi},
                    {"smallest_at", found.smallest_at},
                    {"proximity", word(found.proximity)},
                    {"apart_before", found.apart_before},
                    {"meet_at", found.meet_at},
                    {"free", is_free(report)},
                    {"clearance", report.clearance},
                    {"status", found.reached ? "verified" : "wide"},
                    {"interrupted", found.interrupted},
                    {"poses", report.poses},
                    {"moments", found.moments},
                    {"units", report.units},
                    {"tolerance", report.tolerance},
                    {"certified", certified ? JsonValue(certified->smallest) : JsonValue()},
                    {"certified_contact", contact ? JsonValue(*contact) : JsonValue()},
                    {"certificate", certified ? JsonValue(report.certificate) : JsonValue()}}
             .indented_text() +
         "\n";
}

constexpr const char* closing_words =
    R"(Time k is that of the path's pose k, from 0 on. Between two poses the translation is linear in time and the
rotation turns about a fixed axis at constant speed, by the smaller angle (half a turn, which has two ways,
is refused): the answer holds at all times of this motion. [lo, hi] contains the smallest distance of all times,
0 if the models meet; then the first contact lies in the printed interval of time.

Exit status: 0 the way is proven free: apart at all times, by --clearance at least where it is given; 3 it is
not: the models meet, come too near, or it is open, as by --time-limit; 2 bad usage or input, 130 interrupted by
Ctrl-C.

Examples:
  verisq path cup.json stem.json --poses reduction.csv
  verisq path table.json gripper.json --poses trajectory.csv --clearance 2 --json
  verisq path table.json gripper.json --poses trajectory.csv --certificate-file free.json)";

struct Travellers {
  const Model& a;
  const Model& b;
  std::span<const Pose> path;
};

/// Certifies the found answer; once interrupted it reports that instead, and writes no file.
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
    return tell(fmt::format("{}; {} is not written", reason_of_end(), file));
  }
  write_answer(file, PathAnswer{.models = {subject_file(arguments.model_a), subject_file(arguments.model_b)},
                                .units = report.units,
                                .path = {of.path.begin(), of.path.end()},
                                .claims = certified.claims,
                                .certificate = std::move(certified.certificate)});
  report.certificate = file;
  report.certified = certified.claims;
}

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
  add_time_limit(options, arguments.time_limit, "what is proven by then is printed, and no certificate is written");
  options.add_flag("--json", arguments.json, "Print one JSON object");
  add_no_progress(options, arguments.no_progress);
}

/// `verified` only when the way is proven to be free. Throws Error(input) for errors that the user can correct.
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
  Deadline limit(arguments.time_limit, interrupted);
  limit.start();
  options.interrupted = limit.stop();
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
  if (report.found.interrupted) return status_of_end();
  return is_free(report) ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace

Command path_command() {
  return command("path", "Enclose the smallest distance of two models while one moves, and when they meet",
                 declare_path, run_path);
}

}  // namespace verisq::command_line
