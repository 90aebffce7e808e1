/// This file implements shared_inputs.hpp.
#include "host/command_line/shared_inputs.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <verisq/distance.hpp>
#include <verisq/version.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/words.hpp"
#include "host/prepare/mesh_geometry.hpp"

namespace verisq::command_line {
namespace {

// An implant is a half to a twentieth of its bone; metres and millimetres differ by a thousand.
constexpr double unlike = 50.0;

}  // namespace

void tell_of_other_size(const Model& model, const std::string& path_of_model, std::span<const Point> vertices,
                        const std::string& path_of_mesh) {
  if (vertices.size() < 2) return;
  const double of_model = bounding_radius(model);
  const double of_mesh = extent_of(vertices).half_diagonal();
  if (of_model <= unlike * of_mesh && of_mesh <= unlike * of_model) return;
  tell(fmt::format("note: the radius is {:.3g} of {} and {:.3g} of {}: are their units the same?", of_model,
                   quotation(path_of_model), of_mesh, quotation(path_of_mesh)));
}

namespace {

double parse_turn(std::string_view option, const std::string& text) {
  const std::optional<double> degrees = finite_number(text);
  if (!degrees || std::abs(*degrees) > 360.0)
    refuse(fmt::format("{}: {} is not a number between -360 and 360", option, text));
  return *degrees;
}

}  // namespace

void declare_inputs(Options& options, InsertionInputs& inputs) {
  require_model(options, "--implant", inputs.implant);
  add_pose(options, inputs.pose);
  options.require("--mesh", inputs.mesh, "FILE",
                  "The bone, or its cavity, whose vertices are meant: .stl .obj .ply .off .vtp .vtk");
  options.add("--poses", inputs.poses, "FILE", "The path: .csv with tx,ty,tz,qw,qx,qy,qz a line");
  options.add("--along", inputs.along, parse_direction, "x,y,z",
              "Instead of --poses: the direction of a straight way in");
  options.add("--length", inputs.length, parse_positive_length, "NUMBER", "Of the straight way, in model units");
  options.add("--turn", inputs.turn, parse_turn, "DEGREES",
              "By which the implant turns on the straight way, right-handed about its direction, through the middle of "
              "the implant's bounding box (default 0)");
  options.add("--tol", inputs.tolerance, parse_positive_length, "NUMBER",
              fmt::format("Largest width of a verified enclosure, in model units, more than 0.\n"
                          "Default: {} times the radius of the implant's bounding sphere",
                          tolerance_along_ways.text));
}

void check_usage(const InsertionInputs& inputs) {
  if (inputs.poses.has_value() == inputs.along.has_value()) refuse("give either --poses or --along");
  if (inputs.along && !inputs.length) refuse("--along: give the --length of the way");
  if (inputs.poses && inputs.length) refuse("--length: only for --along, not for --poses");
  if (inputs.poses && inputs.turn) refuse("--turn: only for --along, not for --poses");
}

void refuse_to_overwrite(const std::string& output, const InsertionInputs& inputs) {
  command_line::refuse_to_overwrite("-o", output, {inputs.implant, inputs.mesh, inputs.poses.value_or("")});
}

WayIn given_way(const InsertionInputs& inputs) {
  return {*inputs.along, *inputs.length, inputs.turn.value_or(0.0)};
}

double tolerance_of(const InsertionInputs& inputs, const Model& implant) {
  return inputs.tolerance ? *inputs.tolerance
                          : default_tolerance(tolerance_along_ways, bounding_radius(implant), "the implant");
}

namespace {

constexpr std::uint64_t most_parts = 1'000'000;

std::string extension_of_part(const std::string& output, const std::optional<std::string>& format) {
  if (output == "-" || output.empty()) refuse("--part: give the file that holds it: -o");
  return lower_case(format ? *format : std::filesystem::path(output).extension().string());
}

std::future<SubjectFile> digest_begun(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) {
    refuse(fmt::format("--part: {}: is no regular file, and parts must tell which it is", file));
  }
  return std::async(std::launch::async, [file] { return digest_of_file(file); });
}

/// "3/8". Throws Error(input) for anything else.
PartOption parse_part(std::string_view option, const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) refuse(fmt::format("{}: {}: give i/n, part i (from 1) of n", option, text));
  const std::uint64_t parts = parse_whole_number(option, text.substr(slash + 1), 1, most_parts);
  return {parse_whole_number(option, text.substr(0, slash), 1, parts), parts};
}

}  // namespace

void add_part(Options& options, std::optional<PartOption>& part) {
  options.add(
      "--part", part, parse_part, "I/N",
      fmt::format(
          "Map part I (from 1) of N alone, whole blocks of {} rows, into a .csv or .npy of its own, points\n"
          "also into a .vtp; beside it OUT.part.json says what it is a part of. `verisq merge` makes the whole\n"
          "of all parts",
          rows_per_block));
}

std::string format_of_part(const std::string& output, const std::optional<std::string>& format) {
  const std::string extension = extension_of_part(output, format);
  if (extension != ".csv" && extension != ".npy") refuse("--part: parts are written to .csv and .npy only");
  return extension;
}

std::string format_of_drawn_part(const std::string& output, const std::optional<std::string>& format) {
  const std::string extension = extension_of_part(output, format);
  return extension == ".vtp" ? extension : format_of_part(output, format);
}

std::string text_of(const PoseUncertainty& bounds) {
  const auto& [t, rotation, c] = bounds;
  return fmt::format("{},{},{} {} {},{},{}", t[0], t[1], t[2], rotation, c[0], c[1], c[2]);
}

PartRecord::PartRecord(MapPart part, const std::vector<std::string>& models, const std::string& input)
    : part_(std::move(part)) {
  for (const std::string& model : models) models_.push_back(digest_begun(model));
  input_ = digest_begun(input);
}

void PartRecord::write(const std::string& output, const MapSummary& summary,
                       const std::optional<ClosestPointSummary>& closest) {
  part_.version = VERISQ_VERSION;
  for (std::future<SubjectFile>& model : models_) part_.models.push_back(model.get());
  part_.input = input_.get();
  part_.map = digest_of_file(output);
  part_.summary = summary;
  part_.closest = closest;
  write_map_part(output, part_);
}

}  // namespace verisq::command_line
