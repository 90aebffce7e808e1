/// Reads an implant, a bone and a path, and writes the smallest distances along it.
#include "host/command_line/insert_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/insertion.hpp>
#include <verisq/map_file.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>
#include <verisq/pose_file.hpp>
#include <verisq/signed_distance.hpp>

#include "host/command_line/insert_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/map_to_file.hpp"
#include "host/command_line/number_list.hpp"
#include "host/command_line/progress_bar.hpp"

namespace verisq::command_line {
namespace {

constexpr double default_relative_tolerance = 1e-3;  // of the radius of the implant's bounding sphere

constexpr const char* closing_words =
    "Each row of the map is [lo, hi], which contains the smallest signed distance from the point to the implant along\n"
    "the whole path, at the poses and between them: where hi is negative, the implant passes through the point, and\n"
    "bone must be removed at least -hi and at most -lo deep. \"Verified\" rows are at most the tolerance wide.\n"
    "With --along the implant moves in a straight line and ends where the implant's file has it. With --poses it "
    "moves\n"
    "from pose to pose, each applied after the poses of its primitives; between two of them the translation is "
    "linear,\n"
    "and the rotation turns at constant speed about a fixed axis by the smaller angle.\n"
    "Ctrl-C keeps the rows of a .csv under OUT.partial: all are valid, and those it ended are wide; a second Ctrl-C\n"
    "stops at once.\n"
    "\n"
    "Exit status: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 bad usage or input, 130\n"
    "interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq insert --implant fitted.json --mesh femur.stl --along 0,0,-1 --length 120 -o removal.vtp\n"
    "  verisq insert --implant fitted.json --mesh femur.stl --poses path.csv --tol 0.05 -o removal.csv --json";

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

Point parse_direction(const std::string& text) {
  const std::vector<double> numbers = parse_numbers("--along", text, "x,y,z");
  const Point direction{numbers[0], numbers[1], numbers[2]};
  if (std::ranges::all_of(direction, [](double x) { return x == 0.0; })) {
    refuse(fmt::format("--along: {} is no direction", text));
  }
  return direction;
}

double parse_positive(std::string_view option, const std::string& text) {
  const double length = parse_length(option, text);
  if (length == 0.0) refuse(fmt::format("{}: {} is not more than 0", option, text));
  return length;
}

/// Everything that the options alone tell, before any file is opened.
void check_usage(const InsertArguments& arguments) {
  if (arguments.poses.has_value() == arguments.along.has_value()) refuse("give either --poses or --along");
  if (arguments.along && !arguments.length) refuse("--along: give the --length of the way");
  if (arguments.poses && arguments.length) refuse("--length: only for --along, not for --poses");
  refuse_to_overwrite(arguments.output, {arguments.implant, arguments.mesh, arguments.poses.value_or("")});
}

std::vector<Pose> read_poses(const std::string& path) {
  PoseFile file(path);
  std::vector<Pose> poses;
  std::vector<Pose> chunk(1024);
  while (const std::size_t count = file.read(chunk)) {
    poses.insert(poses.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return poses;
}

double default_tolerance(const Model& implant) {
  const double tolerance = default_relative_tolerance * bounding_radius(implant);
  // An infinite tolerance would call every enclosure verified.
  if (!std::isfinite(tolerance)) refuse("--tol: give one, because the size of the implant overflows");
  return tolerance;
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
    fmt::print(stderr, "verisq: interrupted; {} is not written\n", output);
  } else {
    fmt::print(stderr, "verisq: interrupted; rows as tight as they were by then are kept in {}\n", partial);
  }
  return partial;
}

ExitStatus status_of(const MapSummary& summary) {
  if (summary.interrupted) return ExitStatus::interrupted;
  return summary.wide > 0 ? ExitStatus::unverified : ExitStatus::verified;
}

}  // namespace

const CLI::App& declare_insert(CLI::App& program, InsertArguments& arguments) {
  CLI::App& insert = *program.add_subcommand("insert", "Enclose how deep an implant cuts into the bone on its way in");
  insert.footer(closing_words);
  insert.add_option("--implant", arguments.implant, "Model of posed superquadrics (verisq-model/1, JSON)")
      ->required()
      ->option_text("FILE REQUIRED");
  insert.add_option("--mesh", arguments.mesh, "The bone, whose vertices are meant: .stl .obj .ply .off")
      ->required()
      ->option_text("FILE REQUIRED");
  insert.add_option("--poses", arguments.poses, "The path: .csv with tx,ty,tz,qw,qx,qy,qz a line")->option_text("FILE");
  insert.add_option("--along", arguments.along, "Instead of --poses: the direction of a straight way in")
      ->option_text("x,y,z");
  insert.add_option("--length", arguments.length, "Of the straight way, in model units")->option_text("NUMBER");
  insert
      .add_option("--tol", arguments.tolerance,
                  "Largest width of a verified enclosure, in model units, more than 0.\n"
                  "Default: 1e-3 times the radius of the implant's bounding sphere")
      ->option_text("NUMBER");
  insert
      .add_option("--device", arguments.device,
                  "auto (default), host (no OpenCL), or an index or part of a name from `verisq devices`")
      ->option_text("DEVICE");
  insert.add_option("-o,--output", arguments.output, "The map, by extension: .csv .vtp .ply .json")
      ->required()
      ->option_text("FILE REQUIRED");
  insert.add_flag("--json", arguments.json, "Print the summary as one JSON object; what is not bounded is null");
  insert.add_flag("--no-progress", arguments.no_progress, "No progress bar, even on a terminal");
  return insert;
}

ExitStatus run_insert(const InsertArguments& arguments) {
  check_usage(arguments);
  std::optional<double> tolerance;
  if (arguments.tolerance) tolerance = parse_positive("--tol", *arguments.tolerance);
  std::vector<Pose> path;
  if (arguments.along) {
    path = straight_path({}, parse_direction(*arguments.along), parse_positive("--length", *arguments.length), 1);
  }
  const Model implant = read_model(arguments.implant);
  const Mesh bone = read_mesh(arguments.mesh);
  if (arguments.poses) path = read_poses(*arguments.poses);
  watch_for_interruption();
  MapWriter writer(arguments.output, &bone);

  const auto start = Clock::now();
  std::optional<ProgressBar> bar;  // begins at the first distances: compiling kernels is no part of the rate
  const double points = static_cast<double>(bone.vertices.size());
  const InsertionOptions options{.tolerance = tolerance ? *tolerance : default_tolerance(implant),
                                 .device = arguments.device,
                                 .interrupted = interrupted,
                                 .progress = [&](double done) {
                                   if (!bar) bar.emplace(!arguments.no_progress, "points");
                                   bar->update(static_cast<std::uint64_t>(done * points), done);
                                 }};
  const Insertion insertion = smallest_distance_along(path, implant, bone.vertices, options);
  bar.reset();  // the line is cleared before anything else is said

  InsertReport report = report_of(insertion);
  report.output = write_map(bone, insertion, std::move(writer), arguments.output);
  report.poses = path.size();
  report.units = implant.units;
  report.tolerance = options.tolerance;
  report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (!insertion.summary.notice.empty()) fmt::print(stderr, "verisq: {}\n", insertion.summary.notice);
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return status_of(insertion.summary);
}

}  // namespace verisq::command_line
