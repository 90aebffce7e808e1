/// `verisq distance`: encloses the distance of two models and their closest points, or the distances for many poses.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>
#include <verisq/map.hpp>
#include <verisq/model.hpp>
#include <verisq/penetration.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/shared_inputs.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {

// The output of `verisq distance` for one pose: for people, or as one JSON object.

struct DistanceReport {
  Enclosure distance;
  Proximity proximity;
  bool uncertain = false;    ///< a model has intervals: the enclosure holds for all members; no points, no certificate
  bool searched = false;     ///< by branch and bound: no closest points
  bool interrupted = false;  ///< Ctrl-C came before the tolerance was reached
  bool complete = true;      ///< for certificates: no interruption or time limit came before all pairs were processed
  std::optional<Point> common = std::nullopt;
  std::optional<std::array<Point, 2>> near_points = std::nullopt;  ///< for a search; each point in its model's own
                                                                   ///< frame
  std::optional<ClosestPoints> closest = std::nullopt;
  std::optional<PairCertificate> certificate = std::nullopt;  ///< set if it was requested
  std::optional<Enclosure> certified = std::nullopt;  ///< for a search: the enclosure that the certificate proves,
                                                      ///< which may be wider than the found one
  /// Exact models that are not proven to be apart have one; with its certificate.
  std::optional<CertifiedPenetration> penetration = std::nullopt;
  std::string units = {};  ///< of both models; empty when not given
  double tolerance = 0.0;
  bool tightest = false;  ///< for a tolerance of 0: the enclosure is as tight as the method gives
};

/// Returns whether the requested --tol was reached, for a certificate, too.
[[nodiscard]] inline bool is_verified(const DistanceReport& report) {
  if (report.certified && !verified(*report.certified, report.tolerance)) return false;
  return report.tightest || verified(report.distance, report.tolerance);
}

[[nodiscard]] std::string readable(const DistanceReport& report);

/// JSON has no infinity: an unbounded upper end is null.
[[nodiscard]] std::string json(const DistanceReport& report);

// The distance of models that are bent or built by set operations, with progress, Ctrl-C and a time limit.

struct DistanceSearch {
  double tolerance;
  std::optional<double> seconds;  ///< the limit; nothing: none
  bool show_progress;
  bool with_certificate;  ///< a certificate is requested, too
};

/// Like ModelSearch; an early end is reported on the standard error.
[[nodiscard]] DistanceReport searched_distance(const Model& a, const Model& b, const Pose& pose,
                                               const DistanceSearch& search);

// The answers of `distance --poses` with their proofs: the certificate file of many poses.

/// Encloses the distances at all poses of the file on all processors, like maps on the host. Works until Ctrl-C; later
/// answers are wide. `tolerance` is for searched distances. Throws like PoseFile.
[[nodiscard]] std::vector<PosedAnswer> certified_distances(const Model& a, const Model& b, const std::string& poses,
                                                           double tolerance, bool show_progress);

/// As typed; `run_distance` checks what depends on several options.
struct DistanceArguments {
  std::string model_a;
  std::string model_b;
  std::optional<Pose> pose;
  std::optional<std::string> poses;   ///< a file, instead of one pose
  std::optional<std::string> output;  ///< for the distances of `poses`
  std::optional<PartOption> part;     ///< for the distances of `poses`
  std::optional<std::string> device;  ///< for `poses`; "auto" when not given
  std::optional<double> tolerance;
  std::optional<double> time_limit;           ///< in seconds
  PoseUncertaintyArguments pose_uncertainty;  ///< for `poses`
  bool closest_points = false;                ///< for `poses`
  bool json = false;
  bool certificate = false;
  std::optional<std::string> certificate_file;
  bool no_progress = false;
};

void declare_distance(Options& options, DistanceArguments& arguments);

/// `verified` when every enclosure is at most the tolerance wide. Throws Error(input) for errors that the user can
/// correct, before the first distance is computed (a file of poses is a stream: its later lines are checked as they
/// come).
ExitStatus run_distance(const DistanceArguments& arguments);

namespace {

std::string_view word(Proximity proximity) {
  switch (proximity) {
    case Proximity::separated: return "separated";
    case Proximity::overlapping: return "overlapping";
    case Proximity::undecided: return "undecided";
  }
  return "";
}

std::string explanation(const DistanceReport& report) {
  switch (report.proximity) {
    case Proximity::separated: return "proven: no common point";
    case Proximity::overlapping:
      return report.common ? "proven: a common point"
                           : "proven: a common point, which closed solids at distance 0 have";
    case Proximity::undecided: break;
  }
  const std::string open = "neither a gap nor a common point is proven";
  return std::isfinite(report.distance.hi) ? open + ", at most " + upper_digits(report.distance.hi, 3) + " apart"
                                           : open;
}

std::string explanation_of_depth(const DistanceReport& report, std::string_view units) {
  const Enclosure& depth = report.penetration->depth;
  const std::string most = upper_digits(depth.hi, 3) + std::string(units);
  if (depth.lo > 0.0) return fmt::format("proven: they overlap; moving B by {}, the right way, ends that", most);
  const bool meet = report.proximity == Proximity::overlapping;
  if (depth.hi == 0.0) return meet ? "proven: they touch, and do not overlap" : "proven: they do not overlap";
  if (!std::isfinite(depth.hi)) return "nothing is proven of it";
  return fmt::format("proven: they {} overlap by at most {}", meet ? "touch, or" : "do not overlap, or", most);
}

std::string_view explanation_of_uncertain(Proximity proximity) {
  switch (proximity) {
    case Proximity::separated: return "proven: no common point, whatever the uncertain numbers are";
    case Proximity::overlapping: return "proven: a common point, whatever the uncertain numbers are";
    case Proximity::undecided: return "neither is proven of all that the uncertain numbers allow";
  }
  return "";
}

std::string text_of(const Enclosure& e) {
  return fmt::format("[{:.17g}, {:.17g}]", e.lo, e.hi);
}

std::string text_of(const Point& x) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g})", x[0], x[1], x[2]);
}

std::string box_text(std::string_view name, const std::array<Enclosure, 3>& box) {
  return fmt::format("{:<19}x {}\n{:<19}y {}\n{:<19}z {}\n", name, text_of(box[0]), "", text_of(box[1]), "",
                     text_of(box[2]));
}

std::string readable(const PairCertificate& certificate) {
  std::string text;
  for (const auto& [a, b, vector, on_a, on_b] : certificate.separations) {
    text += fmt::format("certificate        primitives {} and {}: vector {}, point of A {}, point of B {}\n", a, b,
                        text_of(vector), text_of(on_a), text_of(on_b));
  }
  for (const auto& [a, b, cuts, planes] : certificate.divisions) {
    text += fmt::format("certificate        primitives {} and {}: {} plane{} between sections\n", a, b, planes.size(),
                        planes.size() == 1 ? "" : "s");
  }
  return text;
}

/// Each side as an array of its ends.
JsonValue json_of(const std::array<Enclosure, 3>& box) {
  JsonValue::Array sides;
  for (const Enclosure& side : box) sides.push_back(std::array{side.lo, side.hi});
  return sides;
}

JsonValue json_of(const PairCertificate& certificate) {
  JsonValue::Array separations;
  for (const auto& [a, b, vector, on_a, on_b] : certificate.separations) {
    separations.push_back(
        JsonObject{{"primitive_a", a}, {"primitive_b", b}, {"vector", vector}, {"on_a", on_a}, {"on_b", on_b}});
  }
  for (const auto& [a, b, cuts, planes] : certificate.divisions) {
    separations.push_back(JsonObject{{"primitive_a", a}, {"primitive_b", b}, {"planes", planes.size()}});
  }
  return separations;
}

/// Without near points if there is a common point, which is more informative.
std::optional<std::array<Point, 2>> shown_near_points(const DistanceReport& report) {
  return report.common ? std::nullopt : report.near_points;
}

std::string_view status_word(const DistanceReport& report) {
  if (report.tightest) return "tightest";
  return is_verified(report) ? "verified" : "wide";
}

}  // namespace

std::string readable(const DistanceReport& report) {
  const auto units = units_behind(report.units);
  auto text = fmt::format("distance           {}{}\n", text_of(report.distance), units);
  text += fmt::format("width              {:.3g}{}, tolerance {:.3g}{}{}\n", report.distance.width(), units,
                      report.tolerance, units, report.tightest ? ": the tightest" : "");
  text += fmt::format("proximity          {} ({})\n", word(report.proximity),
                      report.uncertain ? explanation_of_uncertain(report.proximity) : explanation(report));
  if (report.common) text += fmt::format("common point       {}\n", text_of(*report.common));
  if (report.penetration) {
    text += fmt::format("penetration depth  {}{} ({})\n", text_of(report.penetration->depth), units,
                        explanation_of_depth(report, units));
  }
  if (report.closest) {
    text += box_text("closest point of A", report.closest->on_a) + box_text("closest point of B", report.closest->on_b);
    text += fmt::format("uniqueness         {}\n",
                        report.closest->unique ? "proven: exactly one pair of closest points, in these boxes"
                                               : "not proven: these boxes contain every pair of closest points");
  }
  if (const auto near = shown_near_points(report)) {
    const auto& [on_a, on_b] = *near;
    text += fmt::format("near point of A    {}\nnear point of B    {} in its own frame; {:.17g}{} apart at most\n",
                        text_of(on_a), text_of(on_b), report.distance.hi, units);
  }
  if (report.uncertain) text += "closest points     not enclosed, because the models are uncertain\n";
  if (report.searched)
    text += "closest points     not enclosed, because a model is bent, a mesh, or built by set operations\n";
  if (report.certified) text += fmt::format("certified          {}{}\n", text_of(*report.certified), units);
  return report.certificate ? text + readable(*report.certificate) : text;
}

std::string json(const DistanceReport& report) {
  JsonObject object{{"lo", report.distance.lo},
                    {"hi", report.distance.hi},
                    {"status", status_word(report)},
                    {"proximity", word(report.proximity)},
                    {"uncertain", report.uncertain},
                    {"searched", report.searched},
                    {"interrupted", report.interrupted},
                    {"closest_points", JsonValue()},
                    {"unique", report.closest && report.closest->unique},
                    {"near_points", JsonValue()},
                    {"witness", report.common},
                    {"penetration_depth", JsonValue()},
                    {"units", report.units},
                    {"tolerance", report.tolerance}};
  if (report.closest) {
    object.set("closest_points",
               JsonObject{{"on_a", json_of(report.closest->on_a)}, {"on_b", json_of(report.closest->on_b)}});
  }
  if (const auto near = shown_near_points(report)) {
    object.set("near_points", JsonObject{{"on_a", (*near)[0]}, {"on_b", (*near)[1]}});
  }
  if (report.penetration) object.set("penetration_depth", report.penetration->depth);
  if (report.certified) object.set("certified", *report.certified);
  if (report.certificate) object.set("certificate", json_of(*report.certificate));
  return object.indented_text() + "\n";
}

namespace {

/// A progress from 0 at the first width to 1 at the tolerance, in the logarithm of the width: the width falls by about
/// the same factor from level to level.
class WidthFraction {
 public:
  explicit WidthFraction(double tolerance) : tolerance_(tolerance) {}

  [[nodiscard]] double operator()(double width) {
    if (!std::isfinite(width)) return 0.0;
    if (!(first_ > 0.0)) first_ = width;
    return std::log(first_ / width) / std::log(first_ / tolerance_);
  }

 private:
  double tolerance_;
  double first_ = 0.0;
};

void tell_what_is_not_certified(const DistanceReport& report) {
  const Enclosure& proven = *report.certified;
  if (verified(proven, report.tolerance) || proven.width() <= report.distance.width()) return;
  tell(fmt::format(
      "the certificate proves less than was found, [{}, {}]: {}", proven.lo, proven.hi,
      interrupted() ? "interrupted"
                    : "planes between sections of primitives, balls and covers about these, and points do not decide"));
}

/// Ctrl-C or the time limit.
using Stop = std::function<bool()>;

/// Encloses how deep models reach into each other, unless they are proven to be apart.
void add_penetration(const Model& a, const Model& b, const Pose& pose, double tolerance, const Stop& stop,
                     DistanceReport& report) {
  if (report.distance.lo > 0.0) return;
  report.penetration =
      PenetrationDepth(a, b)(pose, {.tolerance = tolerance, .common = report.common, .interrupted = stop});
}

}  // namespace

DistanceReport searched_distance(const Model& a, const Model& b, const Pose& pose, const DistanceSearch& search) {
  watch_for_interruption();
  Deadline limit(search.seconds, command_line::interrupted);
  limit.start();
  const ModelSearch models(a, b);
  SearchOptions options{.tolerance = search.tolerance, .interrupted = limit.stop()};
  SearchedDistance found{};
  {
    ProgressBar bar(search.show_progress, "cubes");
    WidthFraction fraction(search.tolerance);
    options.progress = [&](const Enclosure& e, std::uint64_t cubes) { bar.update(cubes, fraction(e.width())); };
    found = models(pose, options);
  }
  if (!verified(found.distance, search.tolerance) && !(search.tolerance == 0.0 && found.reached)) {
    const char* const reason = interrupted()    ? "interrupted"
                               : limit.passed() ? "the time limit is reached"
                                                : "the search has reached rounding errors or its budget of cubes";
    tell(fmt::format("{}; the enclosure is valid, and wide", reason));
  }
  DistanceReport report{found.distance, found.proximity};
  report.tolerance = search.tolerance;
  report.searched = true;
  report.interrupted = interrupted() && !found.reached;
  report.tightest = search.tolerance == 0.0 && found.reached;
  report.near_points = found.near_points;
  report.common = found.common;
  add_penetration(a, b, pose, search.tolerance, limit.stop(), report);
  if (search.with_certificate) {
    options.interrupted = [] { return interrupted(); };  // what was found in time deserves its certificate
    auto [proven, certificate] = models.certified(pose, found, options);
    report.certified = proven;
    report.certificate = std::move(certificate);
    tell_what_is_not_certified(report);
  }
  return report;
}

std::vector<PosedAnswer> certified_distances(const Model& a, const Model& b, const std::string& poses, double tolerance,
                                             bool show_progress) {
  constexpr std::size_t chunk_size = 4096;
  const CertifiedDistances distances(a, b, tolerance);
  PoseStream stream(poses);
  ProgressBar bar(show_progress, "certificates");
  std::vector<PosedAnswer> answers;
  std::vector<Pose> chunk(chunk_size);
  while (const std::size_t count = stream.read(chunk)) {
    const std::size_t first = answers.size();
    answers.resize(first + count);
    in_parallel(count, [&](std::size_t i) {
      auto [distance, certificate] = distances(chunk[i], interrupted);
      answers[first + i] = {chunk[i], distance, std::move(certificate)};
    });
    bar.update(answers.size(), stream.fraction(answers.size()));
    if (interrupted()) break;
  }
  return answers;
}

namespace {

constexpr double limit_of_certificates = 1e-12;  // of max(largest |translation|, radii), as for --poses

constexpr const char* closing_words =
    "The distance is [lo, hi], which contains the exact distance of A and of B moved by the pose: 0 where they meet.\n"
    "The closest points lie in the printed boxes, in the frame of A. \"undecided\": neither a gap nor a common point "
    "is\n"
    "proven, as a rule because the models touch, or nearly. Where exact models are not proven to be apart, the\n"
    "penetration depth is the length of the shortest translation of B after which they do not overlap.\n"
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
  if (arguments.time_limit) refuse("--certificate-file: not with --time-limit, for many poses");
  if (pose_uncertainty(arguments.pose_uncertainty)) {
    refuse("--certificate-file: of exact places only, not with --translation-error or --rotation-error");
  }
  refuse_one_file_twice({*arguments.output, *arguments.certificate_file});
  if (std::filesystem::exists(*arguments.poses) && !std::filesystem::is_regular_file(*arguments.poses)) {
    refuse(fmt::format("--certificate-file: {}: is read twice: give a regular file", *arguments.poses));
  }
}

/// Checks everything that the options alone determine, before any file is opened.
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
  if (!arguments.output) refuse("--poses: give the file for their distances: -o");
  if (arguments.pose) refuse("give either --pose or --poses");
  if (arguments.certificate) refuse("--certificate: those of many poses fill a --certificate-file");
  if (arguments.certificate_file) refuse_what_certified_poses_lack(arguments);
  if (arguments.part && arguments.time_limit)
    refuse("--part: not with --time-limit, by which rows depend on the clock");
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

/// By certificates of convex primitives. Reports an early end.
DistanceReport certified_distance(const UncertainModel& a, const UncertainModel& b, const LargestModels& models,
                                  const Pose& pose, double tolerance, const std::optional<double>& seconds) {
  watch_for_interruption();
  Deadline limit(seconds, interrupted);
  limit.start();
  const Stop stop = limit.stop();
  DistanceReport report = distance_of(a, b, pose, stop);
  // For uncertain models the width is that of their numbers, whatever the method does.
  if (!report.uncertain) add_penetration(models.a, models.b, pose, tolerance, stop, report);
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
  if (options.pose_uncertainty) part.settings.push_back({"place", command_line::text_of(*options.pose_uncertainty)});
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
  write_answer(*arguments.certificate_file, std::move(answers));
  return status;
}

ExitStatus map_poses(const LargestModels& models, const std::string& units, double tolerance,
                     const DistanceArguments& arguments) {
  PoseStream stream(*arguments.poses);
  Deadline limit(arguments.time_limit, interrupted);
  MapOptions options{.tolerance = tolerance,
                     .device = arguments.device.value_or(arguments.certificate_file ? "host" : "auto"),
                     .pose_uncertainty = pose_uncertainty(arguments.pose_uncertainty),
                     .interrupted = interrupted,
                     .out_of_time = limit.out_of_time()};
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
      closest_points(*pair, poses, rows, limit.stop());
      return rows;
    };
  }
  if (part) {
    request.finished = [&](const MapSummary& summary, const std::optional<ClosestPointSummary>& closest) {
      part->write(*arguments.output, summary, closest);
    };
  }
  const auto make_mapper = [&] {
    PoseMapper mapper(models.a, models.b, options);
    limit.start();
    return mapper;
  };
  const ExitStatus status = map_to_file(peeked, nullptr, make_mapper, request);
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
  options.add(
      "--time-limit", arguments.time_limit, parse_time_limit, "SECONDS",
      "Ends the work with the best enclosure so far; of --poses this long after the preparation, and rows left open\n"
      "are valid, and wide (default: none)");
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
    write_answer(*arguments.certificate_file,
                 PairAnswer{{subject_file(arguments.model_a), subject_file(arguments.model_b)},
                            units,
                            pose,
                            report.certified.value_or(report.distance),
                            report.certificate.value(),
                            report.penetration});
  }
  if (!arguments.certificate) report.certificate.reset();
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (report.interrupted) return ExitStatus::interrupted;
  return is_verified(report) ? ExitStatus::verified : ExitStatus::unverified;
}

Command distance_command() {
  return command("distance", "Enclose the distance of two models, and closest points", declare_distance, run_distance);
}

}  // namespace verisq::command_line
