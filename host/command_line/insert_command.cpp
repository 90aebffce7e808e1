/// `verisq insert`: how deep an implant cuts into the bone on its way in, for each vertex of a mesh, and how much bone
/// it takes away.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/clearance.hpp>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>
#include <verisq/insertion.hpp>
#include <verisq/map_file.hpp>
#include <verisq/mesh.hpp>
#include <verisq/report.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/shared_inputs.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/points.hpp"

namespace verisq::command_line {

// The output of `verisq insert` about the whole bone: for people, or as one JSON object.

struct InsertReport {
  MapSummary summary = {};
  std::uint64_t proven_cut = 0;        ///< points with hi < 0: the implant passes through them
  std::uint64_t proven_untouched = 0;  ///< points with lo >= 0: no point of its inside ever reaches them
  std::uint64_t undecided = 0;
  Enclosure deepest_penetration{0.0, 0.0};  ///< of all points; [0, 0] where all are untouched
  std::size_t poses = 0;
  std::string output = {};  ///< the file that holds the map; empty when none was kept
  std::string units = {};   ///< of the implant; empty when not given
  double tolerance = 0.0;
  double seconds = 0.0;                       ///< wall time of all
  std::optional<MeshClearance> surface = {};  ///< of whole triangles along the path, where asked for
  double surface_seconds = 0.0;
  std::optional<RemovedVolume> removed = {};        ///< where asked for
  double volume_tolerance = 0.0;                    ///< of the volume's lower end
  double least_volume_tolerance = 0.0;              ///< in cubic units: so wide it may be, however small the volume is
  double volume_seconds = 0.0;                      ///< wall time of the volume
  std::optional<WayIn> way = {};                    ///< of paths that are not given pose by pose
  std::optional<LeastRemoval> search = {};          ///< of that way among others, where asked for
  std::string certificate = {};                     ///< the certificates' file; empty when not written
  bool certified_points = false;                    ///< they are of the rows
  std::uint64_t looser_certificates = 0;            ///< rows that are wider than without them
  std::optional<Enclosure> certified_surface = {};  ///< what they prove of the whole surface
  std::optional<Enclosure> certified_volume = {};   ///< what they prove of the removed volume
  std::string page = {};                            ///< the report's file; empty when not written
  std::string picture = {};
  double degrees_off = 0.0;  ///< its direction of the one that was given, about

  /// Whatever of it.
  [[nodiscard]] bool interrupted() const;
};

/// Counts the rows; the caller fills in the rest of the report.
void count(const Insertion& insertion, InsertReport& report);

[[nodiscard]] std::string readable(const InsertReport& report);

/// The lines of the report for readers of the page.
[[nodiscard]] std::vector<ReportLine> report_lines(const InsertReport& report);

/// One line. JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] std::string json(const InsertReport& report);

/// As typed; `run_insert` checks what depends on several options.
struct InsertArguments {
  InsertionInputs inputs;
  std::optional<double> search_cone;       ///< degrees: the best of the ways whose direction is so much off
  std::optional<double> search_turn;       ///< degrees: and whose turn differs so much
  MapElements on = MapElements::vertices;  ///< triangles: of the whole surface, too
  bool cavity = false;                     ///< the mesh is that of a cavity
  bool bone = false;                       ///< the mesh is the bone's outer surface
  std::optional<std::string> within;
  std::optional<Plane> resection;
  std::optional<double> volume_tolerance;  ///< relative
  std::string device = "auto";
  std::string output;
  std::string certificate_file;  ///< empty: none
  ReportFiles report;
  std::optional<double> time_limit;  ///< in seconds
  bool json = false;
  bool no_progress = false;
};

void declare_insert(Options& options, InsertArguments& arguments);

/// Throws Error(input) for errors that the user can correct, before the first distance is computed.
ExitStatus run_insert(const InsertArguments& arguments);

namespace {

Enclosure penetration(const Enclosure& distance) {
  return {std::max(0.0, -distance.hi), std::max(0.0, -distance.lo)};
}

std::string readable_surface(const InsertReport& report) {
  if (!report.surface) return {};
  const MeshClearance& surface = *report.surface;
  const auto units = units_behind(report.units);
  return fmt::format("whole surface        deepest penetration {}{}\n",
                     outward_digits(penetration(surface.smallest_distance)), units) +
         fmt::format("  proven cut         {} triangles\n", surface.proven_too_deep) +
         fmt::format("  proven untouched   {} triangles\n", surface.proven_within) +
         fmt::format("  undecided          {} triangles\n", surface.undecided) +
         fmt::format("  samples            {}, {:.3g} s\n", surface.samples, report.surface_seconds);
}

std::string readable_volume(const InsertReport& report) {
  if (!report.removed) return {};
  const RemovedVolume& removed = *report.removed;
  const auto units = units_behind(report.units, 3);
  const auto rims = std::accumulate(removed.rims.begin(), removed.rims.end(), std::size_t{0});
  return fmt::format("removed bone         {}{}{}\n", outward_digits(removed.volume), units,
                     removed.within_tolerance ? "" : ", wider than asked for") +
         (removed.volume.hi > 0.0 ? "" : "  no bone lies in the implant's way: are both in the same coordinates?\n") +
         fmt::format("  width asked for    {:.3g} of its lower end{}\n", report.volume_tolerance,
                     report.least_volume_tolerance > 0.0
                         ? fmt::format(", or {:.3g}{}", report.least_volume_tolerance, units)
                         : std::string()) +
         fmt::format("  closed over        {} {}\n", rims, rims == 1 ? "rim" : "rims") +
         fmt::format("  cubes              {}, {:.3g} s\n", removed.cubes, report.volume_seconds);
}

std::string numbers(const Point& v) {
  return fmt::format("{:.17g}, {:.17g}, {:.17g}", v[0], v[1], v[2]);
}

std::string readable_way(const InsertReport& report) {
  if (!report.way) return {};
  auto text = fmt::format("way in               along ({}), turning by {:.17g} degrees\n",
                          numbers(report.way->direction), report.way->turn_degrees);
  if (!report.search) return text;
  const auto units = units_behind(report.units, 3);
  text += fmt::format("  off the given one  {:.4g} degrees\n", report.degrees_off);
  text += fmt::format("  the given one      takes away {}{}\n", outward_digits(report.search->of_middle), units);
  text += fmt::format("  best of            {} ways tried, {} of them proven worse\n", report.search->tried,
                      report.search->worse);
  return text;
}

std::optional<JsonObject> json_of_way(const InsertReport& report) {
  if (!report.way) return std::nullopt;
  return JsonObject{
      {"direction", report.way->direction}, {"length", report.way->length}, {"turn_degrees", report.way->turn_degrees}};
}

std::optional<JsonObject> json_of_search(const InsertReport& report) {
  if (!report.search) return std::nullopt;
  return JsonObject{{"removed_volume_of_given", report.search->of_middle},
                    {"degrees_off_given", report.degrees_off},
                    {"tried", report.search->tried},
                    {"proven_worse", report.search->worse}};
}

std::string subjects_of_certificate(const InsertReport& report) {
  if (!report.certified_points) return "the removed bone alone";
  std::string subjects = report.certified_surface ? "the distances of the points, and of the whole surface"
                                                  : "the distances of the points";
  if (report.certified_volume) return subjects + ", and of the removed bone";
  return report.certified_surface ? subjects : subjects + " alone";
}

bool is_surface_certified_less(const InsertReport& report) {
  return report.certified_surface && report.certified_surface->width() > report.surface->smallest_distance.width();
}

bool is_volume_certified_less(const InsertReport& report) {
  return report.certified_volume && report.certified_volume->width() > report.removed->volume.width();
}

}  // namespace

void count(const Insertion& insertion, InsertReport& report) {
  report.summary = insertion.summary;
  for (const MapResult& row : insertion.rows) {
    if (row.distance.hi < 0.0)
      ++report.proven_cut;
    else if (row.distance.lo >= 0.0)
      ++report.proven_untouched;
    else
      ++report.undecided;
  }
  report.deepest_penetration = penetration({report.summary.minimum_lo, report.summary.minimum_hi});
}

bool InsertReport::interrupted() const {
  return summary.interrupted || (surface && surface->interrupted) || (removed && removed->interrupted) ||
         (search && search->interrupted);
}

std::string readable(const InsertReport& report) {
  const auto& summary = report.summary;
  const auto units = units_behind(report.units);
  const auto& [lo, hi] = report.deepest_penetration;
  auto text = fmt::format("points               {}\n", summary.points);
  text += fmt::format("  proven cut         {}\n", report.proven_cut);
  text += fmt::format("  proven untouched   {}\n", report.proven_untouched);
  text += fmt::format("  undecided          {}\n", report.undecided);
  text += fmt::format("deepest penetration  [{}, {}]{}\n", lo, hi, units);
  text += fmt::format("smallest distance    [{}, {}]{}\n", summary.minimum_lo, summary.minimum_hi, units);
  text += readable_surface(report);
  text += readable_volume(report);
  text += readable_way(report);
  text += fmt::format("poses of the path    {}, and all between them\n", report.poses);
  text += fmt::format("device               {}\n", quotation(summary.device));
  text += fmt::format("tolerance            {:.3g}{}\n", report.tolerance, units);
  text += fmt::format("  device-verified    {}\n", summary.device_verified);
  text += fmt::format("  host-verified      {}\n", summary.host_verified);
  text += fmt::format("  wide               {}\n", summary.wide);
  text += fmt::format("largest width        {}{}\n", upper_digits(summary.largest_width), units);
  text += fmt::format("time                 {:.3g} s (device {:.3g} s, host proofs {:.3g} s)\n", report.seconds,
                      summary.device_seconds, summary.host_seconds);
  text += fmt::format("map                  {}\n", report.output.empty() ? "not kept" : quotation(report.output));
  if (!report.certificate.empty()) {
    text +=
        fmt::format("certificate          {}, of {}\n", quotation(report.certificate), subjects_of_certificate(report));
    if (report.looser_certificates > 0)
      text +=
          fmt::format("  wider rows         of {} points than without the certificate\n", report.looser_certificates);
    if (is_surface_certified_less(report))
      text += fmt::format("  proves less        of the whole surface: smallest distance {}\n",
                          outward_digits(*report.certified_surface));
    if (is_volume_certified_less(report))
      text += fmt::format("  proves less        of the removed bone: {}\n", outward_digits(*report.certified_volume));
  }
  if (!report.page.empty()) text += fmt::format("report               {}\n", quotation(report.page));
  if (!report.picture.empty()) text += fmt::format("picture              {}\n", quotation(report.picture));
  return text;
}

std::vector<ReportLine> report_lines(const InsertReport& report) {
  const auto units = units_behind(report.units);
  std::vector<ReportLine> lines;
  if (report.removed)
    lines.push_back({"removed bone", outward_digits(report.removed->volume) + units_behind(report.units, 3)});
  const Enclosure& deepest = report.surface ? report.surface->smallest_distance
                                            : Enclosure{report.summary.minimum_lo, report.summary.minimum_hi};
  lines.push_back({report.surface ? "deepest penetration, whole surface" : "deepest penetration, vertices",
                   outward_digits(penetration(deepest)) + units});
  if (report.way) {
    lines.push_back({"way in", fmt::format("along ({:.6g}), {:.6g}{} long, turning by {:.4g} degrees",
                                           fmt::join(report.way->direction, ", "), report.way->length, units,
                                           report.way->turn_degrees)});
  }
  if (report.search) {
    lines.push_back({"  best of", fmt::format("{} ways tried, {} of them proven worse", report.search->tried,
                                              report.search->worse)});
    lines.push_back(
        {"  the given one takes away", outward_digits(report.search->of_middle) + units_behind(report.units, 3)});
  }
  lines.push_back({"vertices proven cut", fmt::format("{}", report.proven_cut)});
  lines.push_back({"vertices proven untouched", fmt::format("{}", report.proven_untouched)});
  lines.push_back({"undecided", fmt::format("{}", report.undecided)});
  lines.push_back({"wide", fmt::format("{}", report.summary.wide)});
  lines.push_back({"tolerance", fmt::format("{}", report.tolerance) + units});
  lines.push_back({"device", quotation(report.summary.device)});
  return lines;
}

std::string json(const InsertReport& report) {
  const auto& summary = report.summary;
  std::optional<JsonObject> surface;
  if (report.surface) {
    surface = JsonObject{{"deepest_penetration", penetration(report.surface->smallest_distance)},
                         {"smallest_distance", report.surface->smallest_distance},
                         {"proven_cut", report.surface->proven_too_deep},
                         {"proven_untouched", report.surface->proven_within},
                         {"undecided", report.surface->undecided},
                         {"samples", report.surface->samples},
                         {"seconds", report.surface_seconds}};
  }
  std::optional<Enclosure> volume;
  std::optional<JsonObject> work;
  if (report.removed) {
    volume = report.removed->volume;
    work = JsonObject{{"within_tolerance", report.removed->within_tolerance},
                      {"relative_tolerance", report.volume_tolerance},
                      {"tolerance", report.least_volume_tolerance},
                      {"rims", report.removed->rims},
                      {"cubes", report.removed->cubes},
                      {"seconds", report.volume_seconds}};
  }
  JsonObject object{
      {"points", summary.points},
      {"proven_cut", report.proven_cut},
      {"proven_untouched", report.proven_untouched},
      {"undecided", report.undecided},
      {"deepest_penetration", report.deepest_penetration},
      {"smallest_distance", Enclosure{summary.minimum_lo, summary.minimum_hi}},
      {"whole_surface", surface},
      {"removed_volume", volume},
      {"removed_volume_proof", work},
      {"way", json_of_way(report)},
      {"way_search", json_of_search(report)},
      {"poses", report.poses},
      {"device_verified", summary.device_verified},
      {"host_verified", summary.host_verified},
      {"wide", summary.wide},
      {"device", summary.device},
      {"notice", summary.notice},
      {"units", report.units},
      {"tolerance", report.tolerance},
      {"largest_width", summary.largest_width},
      {"device_seconds", summary.device_seconds},
      {"host_seconds", summary.host_seconds},
      {"seconds", report.seconds},
      {"interrupted", report.interrupted()},
      {"output", report.output},
  };
  if (!report.certificate.empty()) {
    object.set("certificate", report.certificate);
    object.set("looser_certificates", report.looser_certificates);
    object.set("certified_surface", report.certified_surface ? JsonValue(*report.certified_surface) : JsonValue());
    object.set("certified_volume", report.certified_volume ? JsonValue(*report.certified_volume) : JsonValue());
  }
  if (!report.page.empty()) object.set("report", report.page);
  if (!report.picture.empty()) object.set("png", report.picture);
  return object.text() + "\n";
}

namespace {

constexpr const char* closing_words =
    "Each row of the map is [lo, hi], which contains the smallest signed distance from the point to the implant along\n"
    "the whole path, at the poses and between them: where hi is negative, the implant passes through the point, and\n"
    "bone must be removed at least -hi and at most -lo deep. \"Verified\" rows are at most the tolerance wide.\n"
    "With --along the implant moves in a straight line and ends where the implant's file, or --pose, has it. With\n"
    "--poses it moves from pose to pose, each applied after the poses of its primitives; between two of them the\n"
    "translation is linear, and the rotation turns at constant speed about a fixed axis by the smaller angle.\n"
    "With --search-cone or --search-turn the path is the one that takes least bone away of some 50 ways, spread over\n"
    "all directions and turns within those angles, then ever closer about the best one. What it takes away is proven,\n"
    "not that there is no better one. --along and --turn with what is printed give the same path again.\n"
    "With --on triangles the deepest penetration of all that lies between the vertices is enclosed, too; with\n"
    "--certificate-file that gets a certificate as well.\n"
    "With --cavity or --bone it is told how much bone is taken away, too: the volume of all that lies in the implant\n"
    "at some time of the path and is bone, which is outside of the cavity and inside the surface --within, or inside\n"
    "the --bone; and never beyond the --resection. An open mesh is closed over its rims, by fans about their means.\n"
    "The implant has to be a union of convex primitives. Without --cavity or --bone nothing says where bone is.\n"
    "Ctrl-C keeps the rows of a .csv under OUT.partial: all are valid, and those it ended are wide; a second Ctrl-C\n"
    "stops at once.\n"
    "\n"
    "Exit status: 0 every enclosure is at most its tolerance wide, 3 one is wider, 2 bad usage or input, 130\n"
    "interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq insert --implant fitted.json --mesh femur.stl --along 0,0,-1 --length 120 -o removal.vtp\n"
    "  verisq insert --implant fitted.json --mesh femur.stl --poses path.csv --tol 0.05 -o removal.csv --json\n"
    "  verisq insert --implant fitted.json --mesh femur.stl --along 0,0,-1 --length 120 -o removal.vtp \\\n"
    "    --on triangles --certificate-file removal.json\n"
    "  verisq insert --implant fitted.json --mesh canal.stl --cavity --within femur.stl \\\n"
    "    --along 0,0,-1 --length 100 -o removal.vtp --certificate-file removal.json\n"
    "  verisq insert --implant fitted.json --mesh canal.stl --cavity --within femur.stl \\\n"
    "    --along 0,0,-1 --length 100 --search-cone 15 --search-turn 20 -o removal.vtp";

/// Refuses options that contradict each other, or that leave open where bone ends.
void check_bone_options(const InsertArguments& arguments) {
  if (arguments.cavity && arguments.bone) refuse("give only one of --cavity and --bone");
  if (arguments.within && !arguments.cavity) refuse("--within: only with --cavity");
  if (arguments.volume_tolerance && !arguments.cavity && !arguments.bone)
    refuse("--volume-tol: nothing says where bone is: give --cavity or --bone");
}

bool is_searched(const InsertArguments& arguments) {
  return arguments.search_cone || arguments.search_turn;
}

/// Checks everything that the options alone determine, before any file is opened.
void check_usage(const InsertArguments& arguments) {
  command_line::check_usage(arguments.inputs);
  if (arguments.inputs.poses && is_searched(arguments))
    refuse("--search-cone, --search-turn: only for --along, not for --poses");
  if (is_searched(arguments) && !arguments.cavity && !arguments.bone)
    refuse("--search-cone, --search-turn: nothing says where bone is: give --cavity or --bone");
  check_bone_options(arguments);
  const std::vector<std::string> inputs{arguments.inputs.implant, arguments.inputs.mesh,
                                        arguments.inputs.poses.value_or(""), arguments.within.value_or("")};
  refuse_to_overwrite("-o", arguments.output, inputs);
  command_line::check_usage(arguments.report, inputs, {arguments.output, arguments.certificate_file});
  if (!arguments.certificate_file.empty() && arguments.resection && !arguments.cavity && !arguments.bone)
    refuse("--certificate-file: not with --resection, which leaves a part of the mesh out: cut it first");
  check_certificate_file(arguments.certificate_file, inputs);
}

/// Throws Error(input) for what is asked of removed bone, where the implant has a mesh.
void refuse_volumes_of_meshes(const InsertArguments& arguments, const Model& implant) {
  if (!has_mesh(implant) || (!arguments.cavity && !arguments.bone)) return;
  refuse(
      fmt::format("{}: {} has a mesh, whose removed bone is not enclosed: leave it out, or recover a model of the mesh",
                  arguments.cavity ? "--cavity" : "--bone", arguments.inputs.implant));
}

/// Throws Error(input) where the implant's rows have no certificates.
void require_certificates(const InsertArguments& arguments, const Model& implant) {
  if (arguments.certificate_file.empty() || is_union_of_convex(implant)) return;
  refuse(
      fmt::format("--certificate-file: {}: ways in of meshes, of bent models, or of csg other than the union of all "
                  "primitives, have no certificates",
                  arguments.inputs.implant));
}

/// An answer without claims.
InsertionAnswer answer_about(const InsertArguments& arguments, std::span<const Pose> path, const Model& implant) {
  return {.model = subject_file(arguments.inputs.implant),
          .mesh = subject_file(arguments.inputs.mesh),
          .units = implant.units,
          .pose = arguments.inputs.pose,
          .path = {path.begin(), path.end()},
          .rows = {}};
}

/// Certifies every row: from here on the rows of `insertion` are those that certificates prove, as they are in Python
/// and C++. Returns nothing where it was interrupted.
std::optional<InsertionAnswer> certify(const InsertArguments& arguments, std::span<const Pose> path,
                                       const Model& implant, const Mesh& bone, InsertionOptions options,
                                       Insertion& insertion, InsertReport& report) {
  ProgressBar bar(!arguments.no_progress, "certificates");
  options.progress = [&](double done) {
    bar.update(static_cast<std::uint64_t>(done * static_cast<double>(bone.vertices.size())), done);
  };
  CertifiedInsertion certified = certified_insertion(path, implant, bone.vertices, insertion, options);
  if (certified.summary.interrupted) {
    insertion.summary.interrupted = true;
    return std::nullopt;
  }
  InsertionAnswer answer = answer_about(arguments, path, implant);
  for (std::size_t n = 0; n < insertion.rows.size(); ++n) {
    const MapResult& proven = certified.rows[n];
    if (proven.status == Status::wide && proven.distance.width() > insertion.rows[n].distance.width())
      ++report.looser_certificates;
    answer.rows.push_back({proven.distance, std::move(certified.certificates[n])});
  }
  insertion.rows = std::move(certified.rows);
  insertion.summary = recounted(insertion.summary, insertion.rows);
  return answer;
}

/// With a resection the rows are not certified: they are not the rows of the mesh.
std::optional<InsertionAnswer> certify_points(const InsertArguments& arguments, std::span<const Pose> path,
                                              const Model& implant, const Mesh& bone, const InsertionOptions& options,
                                              Insertion& insertion, InsertReport& report) {
  if (arguments.resection) return answer_about(arguments, path, implant);
  return certify(arguments, path, implant, bone, options, insertion, report);
}

/// Writes the certificate of an answer that was not interrupted.
void write_certificate(const std::string& file, std::optional<InsertionAnswer> answer, InsertReport& report) {
  if (!answer || (answer->rows.empty() && !answer->removed)) {
    tell(fmt::format("{}; {} is not written", reason_of_end(), file));
    return;
  }
  report.certified_points = !answer->rows.empty();
  write_answer(file, *std::move(answer));
  report.certificate = file;
}

/// Returns the name of the file that holds the map; empty when an interrupted search left none.
std::string write_map(const Mesh& bone, const Insertion& insertion, MapWriter writer, const std::string& output) {
  writer.append(bone.vertices, insertion.rows);
  if (!insertion.summary.interrupted) {
    writer.finish();
    return output;
  }
  const auto partial = writer.keep_partial().string();
  if (partial.empty()) {
    tell(fmt::format("{}; {} is not written", reason_of_end(), output));
  } else {
    tell(fmt::format("{}; rows as tight as they were by then are kept in {}", reason_of_end(), partial));
  }
  return partial;
}

std::optional<BoneRegion> bone_region(const InsertArguments& arguments, const NamedMesh& mesh) {
  if (arguments.bone) return bone_inside(mesh, arguments.resection);
  if (!arguments.cavity) return std::nullopt;
  std::optional<NamedMesh> outer;
  if (arguments.within) outer = NamedMesh{*arguments.within, read_mesh(*arguments.within)};
  return bone_around(mesh, std::move(outer), arguments.resection);
}

double volume_tolerance_of(const InsertArguments& arguments) {
  return arguments.volume_tolerance.value_or(usual_volume_tolerance);
}

/// The tolerance in cubic model units.
double least_volume_tolerance_of(const InsertArguments& arguments, const Model& implant) {
  return arguments.volume_tolerance ? 0.0 : negligible_volume(implant);
}

LeastRemoval searched_way(const InsertArguments& arguments, const Model& implant, const BoneRegion& bone,
                          const Deadline& limit) {
  ProgressBar bar(!arguments.no_progress, "ways");
  return least_removal({.middle = given_way(arguments.inputs),
                        .cone_degrees = arguments.search_cone.value_or(0.0),
                        .turn_degrees = arguments.search_turn.value_or(0.0)},
                       turning_centre(implant), implant, bone,
                       {.volume = {.relative_tolerance = volume_tolerance_of(arguments),
                                   .tolerance = least_volume_tolerance_of(arguments, implant),
                                   .interrupted = limit.stop()},
                        .progress = [&](const LeastRemovalProgress& progress) {
                          bar.update_state("least removed volume " + outward_digits(progress.least, 4),
                                           static_cast<double>(progress.tried) / static_cast<double>(progress.ways));
                        }});
}

/// The angle in radians, about: for people.
double angle_between(const Point& direction, const Point& other) {
  const Point a = verify::near_one(direction);
  const Point b = verify::near_one(other);
  const double along = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const double across = std::hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  return std::atan2(across, along);
}

/// Searches the family for the way that takes the least bone away, and the volume of that.
void search_way(const InsertArguments& arguments, const Model& implant, const BoneRegion& bone, const Deadline& limit,
                InsertReport& report) {
  const Stopwatch time;
  report.search = searched_way(arguments, implant, bone, limit);
  report.way = report.search->way;
  report.degrees_off = angle_between(*arguments.inputs.along, report.way->direction) * 180.0 / std::numbers::pi;
  report.removed = report.search->removed;
  report.volume_tolerance = volume_tolerance_of(arguments);
  report.least_volume_tolerance = least_volume_tolerance_of(arguments, implant);
  report.volume_seconds = time.seconds();
}

RemovedVolume removed_volume_of(const InsertArguments& arguments, std::span<const Pose> path, const Model& implant,
                                const BoneRegion& bone, const Deadline& limit) {
  const double relative = volume_tolerance_of(arguments);
  std::optional<ProgressBar> bar;
  bar.emplace(!arguments.no_progress, "cubes");
  return removed_volume(path, implant, bone,
                        {.relative_tolerance = relative,
                         .tolerance = least_volume_tolerance_of(arguments, implant),
                         .interrupted = limit.stop(),
                         .progress = [&](const Enclosure& volume) {
                           const double width = volume.width();
                           const double done = width > 0.0 ? std::min(1.0, relative * volume.lo / width) : 1.0;
                           bar->update_state("removed volume " + outward_digits(volume, 4), done);
                         }});
}

/// The volume becomes the certificate's, unless that is wider than requested, and than the found one. Nothing if
/// interrupted.
std::optional<RemovalAnswer> certify_removal(const InsertArguments& arguments, std::span<const Pose> path,
                                             const Model& implant, const BoneRegion& bone, const Deadline& limit,
                                             InsertReport& report) {
  RemovedVolume& found = *report.removed;
  ProgressBar bar(!arguments.no_progress, "cubes");
  CertifiedRemovedVolume certified = certified_removed_volume(
      path, implant, bone, found,
      {.in_parallel = in_parallel<std::function<void(std::size_t)>>,
       .interrupted = limit.stop(),
       .progress = [&bar](double done) { bar.update_state("certificate of the removed volume", done); }});
  if (certified.interrupted) return std::nullopt;
  const double allowed = std::max(report.least_volume_tolerance, report.volume_tolerance * certified.volume.lo);
  const bool within_tolerance = certified.volume.width() <= allowed;
  if (within_tolerance || certified.volume.width() <= found.volume.width()) {
    found.volume = certified.volume;
    found.within_tolerance = within_tolerance;
  }
  report.certified_volume = certified.volume;
  RemovalAnswer answer{.bone = arguments.bone ? BoneSide::inside : BoneSide::outside,
                       .within = {},
                       .resection = bone.resection,
                       .volume = certified.volume,
                       .certificate = std::move(certified.certificate)};
  if (arguments.within) answer.within = subject_file(*arguments.within);
  return answer;
}

MeshClearance surface_along(std::span<const Pose> path, const Model& implant, const Mesh& bone,
                            const InsertionOptions& options) {
  return mesh_clearance_along(
      path, implant, bone,
      {.tolerance = options.tolerance, .device = options.device, .interrupted = options.interrupted});
}

/// Vertices by the enclosures that their certificates prove. The surface's enclosure becomes its certificate's, unless
/// that is wider than requested, and than the found one. Nothing if interrupted.
std::optional<WaySurfaceAnswer> certify_surface(const InsertArguments& arguments, std::span<const Pose> path,
                                                const Model& implant, const Mesh& bone, const InsertionAnswer& answer,
                                                InsertionOptions options, InsertReport& report) {
  ProgressBar bar(!arguments.no_progress, "triangles");
  options.progress = [&bar](double done) { bar.update_state("certificate of the whole surface", done); };
  std::vector<Enclosure> of_vertices;
  for (const InsertionAnswer::Row& row : answer.rows) of_vertices.push_back(row.distance);
  MeshClearance& found = *report.surface;
  CertifiedWaySurface certified = certified_way_surface(path, implant, bone, of_vertices, found, options);
  if (certified.interrupted) return std::nullopt;
  const Enclosure& proven = certified.smallest_distance;
  report.certified_surface = proven;
  if (verified(proven, options.tolerance) || proven.width() <= found.smallest_distance.width())
    found.smallest_distance = proven;
  return WaySurfaceAnswer{proven, std::move(certified.certificate)};
}

/// Encloses the surface, and certifies it if the rows are certified.
void enclose_surface(const InsertArguments& arguments, std::span<const Pose> path, const Model& implant,
                     const Mesh& bone, std::optional<InsertionAnswer>& certified, const InsertionOptions& options,
                     InsertReport& report) {
  const Stopwatch time;
  report.surface = surface_along(path, implant, bone, options);
  if (certified && !certified->rows.empty() && !report.surface->interrupted)
    certified->surface = certify_surface(arguments, path, implant, bone, *certified, options, report);
  report.surface_seconds = time.seconds();
}

struct Inserted {
  const Mesh& bone;
  const Model& implant;
  std::span<const Pose> path;
  const Insertion& insertion;
};

void write_report(const InsertArguments& arguments, const Inserted& inserted, const InsertReport& report) {
  const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
  write(arguments.report,
        {.title = fmt::format("{}: way in of {}", name(arguments.inputs.mesh), name(arguments.inputs.implant)),
         .bone = inserted.bone,
         .rows = inserted.insertion.rows,
         .implant = inserted.implant,
         .units = inserted.implant.units,
         .summary = report_lines(report),
         .area_names = {},
         .area_of = {},
         .path = inserted.path});
}

/// True unless the rows, the whole surface's penetration, and the volume are as narrow as requested.
bool is_wide(const InsertReport& report) {
  return report.summary.wide > 0 ||
         (report.surface && !verified(report.surface->smallest_distance, report.tolerance)) ||
         (report.removed && !report.removed->within_tolerance);
}

ExitStatus status_of(const InsertReport& report) {
  if (report.interrupted()) return status_of_end();
  return is_wide(report) ? ExitStatus::unverified : ExitStatus::verified;
}

double parse_degrees(std::string_view option, const std::string& text, double most) {
  const double degrees = parse_length(option, text);
  if (degrees > most) refuse(fmt::format("{}: {} is above {}", option, text, most));
  return degrees;
}

double parse_cone(std::string_view option, const std::string& text) {
  return parse_degrees(option, text, 80.0);
}

double parse_search_turn(std::string_view option, const std::string& text) {
  return parse_degrees(option, text, 180.0);
}

}  // namespace

void declare_insert(Options& options, InsertArguments& arguments) {
  options.explain(closing_words);
  declare_inputs(options, arguments.inputs);
  options.add("--search-cone", arguments.search_cone, parse_cone, "DEGREES",
              "Of the ways whose direction is off --along by at most so much (80 at most), takes the one that removes "
              "least bone of those tried; with --cavity or --bone");
  options.add("--search-turn", arguments.search_turn, parse_search_turn, "DEGREES",
              "The same for turns that differ from --turn by at most so much (180 at most)");
  options.add("--on", arguments.on,
              choice<MapElements>({{"vertices", MapElements::vertices}, {"triangles", MapElements::triangles}}), "WHAT",
              "What the deepest penetration is told of: vertices (default); or triangles, the whole surface, too");
  options.add_flag("--cavity", arguments.cavity,
                   "The mesh is the surface of a cavity: tells the volume of bone around it that is taken away");
  options.add_flag("--bone", arguments.bone, "The mesh bounds bone: tells the volume of it that is taken away");
  options.add("--within", arguments.within, "FILE", "With --cavity: the bone's outer surface, a mesh");
  options.add("--resection", arguments.resection, parse_plane, "x,y,z,nx,ny,nz",
              "Plane in which the bone is cut, by a point and a normal: what lies beyond it, where the normal points, "
              "is left out");
  options.add("--volume-tol", arguments.volume_tolerance, parse_length, "NUMBER",
              "Largest width of the volume's enclosure, divided by its lower end.\n"
              "Default: 0.02, or 1e-7 of the cube about the implant's bounding sphere");
  add_device(options, arguments.device);
  options.require("-o,--output", arguments.output, "FILE", map_explanation);
  options.add(
      "--certificate-file", arguments.certificate_file, "FILE",
      "The rows with what proves each again, the deepest penetration of --on triangles and the volume of --cavity or "
      "--bone with what proves these, for `verisq check --certificate`: .json. The map gets what these prove. With "
      "--resection of the volume alone");
  declare_report_files(options, arguments.report);
  add_time_limit(options, arguments.time_limit, "the rows of a .csv are kept under OUT.partial, all of them valid");
  add_json_of_enclosures(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

namespace {

/// Refuses options that need triangles, for a bone that has none.
void refuse_triangles(const InsertArguments& arguments) {
  if (arguments.report.any())
    refuse(fmt::format("{}: {}: has no triangles to draw", arguments.report.html.empty() ? "--png" : "--report",
                       arguments.inputs.mesh));
  if (arguments.on == MapElements::triangles)
    refuse(fmt::format("--on triangles: {}: has none", arguments.inputs.mesh));
}

void enclose_removed_volume(const InsertArguments& arguments, std::span<const Pose> path, const Model& implant,
                            const BoneRegion& region, const Deadline& limit, InsertReport& report) {
  const Stopwatch volume_time;
  report.removed = removed_volume_of(arguments, path, implant, region, limit);
  report.volume_tolerance = volume_tolerance_of(arguments);
  report.least_volume_tolerance = least_volume_tolerance_of(arguments, implant);
  report.volume_seconds = volume_time.seconds();
}

}  // namespace

ExitStatus run_insert(const InsertArguments& arguments) {
  check_usage(arguments);
  const Model implant = read_model_at(arguments.inputs.pose, arguments.inputs.implant);
  require_certificates(arguments, implant);
  refuse_volumes_of_meshes(arguments, implant);
  const NamedMesh whole_bone{arguments.inputs.mesh, read_mesh(arguments.inputs.mesh)};
  tell_of_other_size(implant, arguments.inputs.implant, whole_bone.mesh.vertices, whole_bone.name);
  const std::optional<BoneRegion> region = bone_region(arguments, whole_bone);
  const Mesh bone = arguments.resection ? before_resection(whole_bone, *arguments.resection) : whole_bone.mesh;
  const bool on_triangles = arguments.on == MapElements::triangles;
  if (bone.triangles.empty()) refuse_triangles(arguments);
  std::vector<Pose> path;
  if (arguments.inputs.poses) path = path_of(arguments.inputs, implant);
  watch_for_interruption();
  Deadline limit(arguments.time_limit, interrupted);
  limit.start();
  MapWriter writer(arguments.output, &bone);

  const Stopwatch time;
  InsertReport report;
  if (arguments.inputs.along) report.way = given_way(arguments.inputs);
  if (is_searched(arguments)) search_way(arguments, implant, *region, limit, report);
  if (report.way) path = path_of(*report.way, turning_centre(implant));
  std::optional<ProgressBar> bar;  // begins at the first distances: compiling kernels is no part of the rate
  const auto points = static_cast<double>(bone.vertices.size());
  const InsertionOptions options{.tolerance = tolerance_of(arguments.inputs, implant),
                                 .device = arguments.device,
                                 .interrupted = limit.stop(),
                                 .progress = [&](double done) {
                                   if (!bar) bar.emplace(!arguments.no_progress, "points");
                                   bar->update(static_cast<std::uint64_t>(done * points), done);
                                 }};
  Insertion insertion = smallest_distance_along(path, implant, bone.vertices, options);
  bar.reset();  // the line is cleared before anything else is said
  std::optional<InsertionAnswer> certified;
  if (!arguments.certificate_file.empty() && !insertion.summary.interrupted)
    certified = certify_points(arguments, path, implant, bone, options, insertion, report);

  count(insertion, report);
  if (on_triangles && !insertion.summary.interrupted)
    enclose_surface(arguments, path, implant, bone, certified, options, report);
  if (region && !report.removed && !report.interrupted())
    enclose_removed_volume(arguments, path, implant, *region, limit, report);
  if (certified && report.removed)
    certified->removed = certify_removal(arguments, path, implant, *region, limit, report);
  report.output = write_map(bone, insertion, std::move(writer), arguments.output);
  if (!arguments.certificate_file.empty()) write_certificate(arguments.certificate_file, std::move(certified), report);
  report.poses = path.size();
  report.units = implant.units;
  report.tolerance = options.tolerance;
  report.seconds = time.seconds();
  tell_notice(insertion.summary.notice);
  if (arguments.report.any() && !insertion.summary.interrupted) {
    write_report(arguments, {.bone = bone, .implant = implant, .path = path, .insertion = insertion}, report);
    report.page = arguments.report.html;
    report.picture = arguments.report.png;
  }
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return status_of(report);
}

Command insert_command() {
  return command("insert", "Enclose how deep an implant cuts into the bone on its way in", declare_insert, run_insert);
}

}  // namespace verisq::command_line
