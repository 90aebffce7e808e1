/// This file implements inputs.hpp.
#include "host/command_line/inputs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numbers>
#include <system_error>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>

#include "host/command_line/options.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/input_file.hpp"

namespace verisq::command_line {

void refuse_to_overwrite(std::string_view option, const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code missing;  // a file that does not exist is not overwritten
    if (!input.empty() && std::filesystem::equivalent(input, output, missing)) {
      refuse(fmt::format("{} {}: would overwrite an input", option, output));
    }
  }
}

void refuse_one_file_twice(const std::vector<std::string>& outputs) {
  std::vector<std::filesystem::path> files;
  for (const std::string& output : outputs) {
    if (output.empty()) continue;
    files.push_back(std::filesystem::weakly_canonical(std::filesystem::absolute(through_links(output))));
    if (std::ranges::count(files, files.back()) > 1) refuse(fmt::format("{}: is the name of two outputs", output));
  }
}

namespace {

template <class AnyModel>
AnyModel moved(const AnyModel& model, const Pose& pose, const std::string& file) {
  try {
    return posed(model, pose);
  } catch (const Error& error) {
    refuse(fmt::format("--pose: {}: {}", file, error.what()));
  }
}

}  // namespace

void add_pose(Options& options, std::optional<Pose>& pose) {
  options.add(
      "--pose", pose, parse_pose, "tx,ty,tz,qw,qx,qy,qz",
      "Moves the model first: x -> R x + t after its primitives' own poses, which are then rounded to binary64\n"
      "(default: where its file has it)");
}

Model moved_by(const std::optional<Pose>& pose, const Model& model, const std::string& file) {
  return pose ? moved(model, *pose, file) : model;
}

Model read_model_at(const std::optional<Pose>& pose, const std::string& file) {
  return moved_by(pose, read_model(file), file);
}

UncertainModel read_uncertain_model_at(const std::optional<Pose>& pose, const std::string& file) {
  const UncertainModel model = read_uncertain_model(file);
  return pose ? moved(model, *pose, file) : model;
}

namespace {

std::array<double, 3> parse_translation_error(std::string_view option, const std::string& text) {
  if (text.find(',') == std::string::npos) {
    const double each = parse_length(option, text);
    return {each, each, each};
  }
  const std::vector<double> numbers = parse_numbers(option, text, "x,y,z");
  if (std::ranges::any_of(numbers, [](double x) { return x < 0.0; })) {
    refuse(fmt::format("{}: {} has a negative length", option, text));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

double parse_rotation_error(std::string_view option, const std::string& text) {
  const double degrees = parse_length(option, text);
  if (degrees > 180.0) refuse(fmt::format("{}: {} is more than 180 degrees", option, text));
  return radians_up(degrees);
}

Point parse_centre(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "x,y,z");
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

void add_pose_uncertainty(Options& options, PoseUncertaintyArguments& arguments, const std::string& whose) {
  options.add(
      "--translation-error", arguments.translation, parse_translation_error, "T | X,Y,Z",
      fmt::format("{} place is known to within this along each axis, in model units: each row then contains the "
                  "distances\nat all places that this and --rotation-error allow (default 0)",
                  whose));
  options.add("--rotation-error", arguments.rotation, parse_rotation_error, "DEGREES",
              "It may also be turned, about any axis, by at most so much (default 0)");
  options.add("--rotation-centre", arguments.centre, parse_centre, "X,Y,Z",
              "What such a turn leaves in place, in the coordinates of the model's file (default: its origin)");
}

std::optional<PoseUncertainty> pose_uncertainty(const PoseUncertaintyArguments& arguments) {
  if (arguments.centre && !arguments.rotation) refuse("--rotation-centre: give the --rotation-error about it");
  if (!arguments.translation && !arguments.rotation) return std::nullopt;
  return PoseUncertainty{.translation = arguments.translation.value_or(std::array<double, 3>{}),
                         .rotation = arguments.rotation.value_or(0.0),
                         .centre = arguments.centre.value_or(Point{})};
}

std::optional<PoseUncertainty> pose_uncertainty(const PoseUncertaintyArguments& arguments,
                                                const std::optional<Pose>& pose) {
  std::optional<PoseUncertainty> bounds = pose_uncertainty(arguments);
  if (bounds && pose) bounds->centre = posed(bounds->centre, *pose);
  return bounds;
}

std::string described(const PoseUncertainty& bounds, const std::string& units) {
  const auto& [x, y, z] = bounds.translation;
  const double degrees = bounds.rotation * 180 / std::numbers::pi;  // as typed: what is proven allows a little more
  const auto& c = bounds.centre;
  return fmt::format("its place known to {}, {}, {}{} along the axes and {:.9g} degrees about ({}, {}, {})", x, y, z,
                     units_behind(units), degrees, c[0], c[1], c[2]);
}

void declare_inputs(Options& options, InputArguments& inputs) {
  require_model(options, "--model", inputs.model);
  declare_points(options, inputs);
}

void declare_points(Options& options, InputArguments& inputs) {
  add_pose(options, inputs.pose);
  options.add("--mesh", inputs.mesh, "FILE",
              "Mesh whose vertices or triangles are meant: .stl .obj .ply .off .vtp .vtk");
  options.add("--points", inputs.points, "FILE",
              "Points instead of a mesh: text with x,y,z a line, .npy of shape (N, 3), or - for the\nstandard input");
}

void check_usage(const InputArguments& inputs) {
  if (inputs.mesh.empty() && inputs.points.empty()) refuse("give either --mesh or --points");
  if (!inputs.mesh.empty() && !inputs.points.empty()) refuse("--mesh and --points are both given: leave one out");
}

PointStream::PointStream(const InputArguments& inputs) {
  if (inputs.points.empty()) {
    mesh_ = read_mesh(inputs.mesh);
  } else {
    file_.emplace(inputs.points);
  }
}

std::size_t PointStream::read(std::span<Point> points) {
  const auto count = file_ ? file_->read(points) : copy_vertices(points);
  points_read_ += count;
  return count;
}

std::size_t PointStream::copy_vertices(std::span<Point> points) const {
  const auto count = std::min(points.size(), mesh_.vertices.size() - points_read_);
  std::copy_n(mesh_.vertices.begin() + static_cast<std::ptrdiff_t>(points_read_), count, points.begin());
  return count;
}

void PointStream::go_to(std::uint64_t point) {
  if (file_) file_->go_to(point);
  points_read_ = file_ ? point : std::min<std::uint64_t>(point, mesh_.vertices.size());
}

std::optional<std::uint64_t> PointStream::count() const {
  return file_ ? file_->count() : mesh_.vertices.size();
}

double PointStream::fraction(std::uint64_t done) const {
  if (!file_) return static_cast<double>(done) / static_cast<double>(mesh_.vertices.size());
  return file_fraction(*file_, points_read_, done);
}

TriangleStream::TriangleStream(const InputArguments& inputs) : mesh_(read_mesh(inputs.mesh)) {
  if (mesh_.triangles.empty()) {
    refuse(fmt::format("{}: a point cloud: it has no triangles", inputs.mesh));
  }
}

std::size_t TriangleStream::read(std::span<Triangle> triangles) {
  const std::size_t count = std::min(triangles.size(), mesh_.triangles.size() - triangles_read_);
  for (Triangle& triangle : triangles.first(count)) {
    const auto& [a, b, c] = mesh_.triangles[triangles_read_++];
    triangle = {mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]};
  }
  return count;
}

void TriangleStream::go_to(std::uint64_t triangle) {
  triangles_read_ = std::min<std::uint64_t>(triangle, mesh_.triangles.size());
}

double TriangleStream::fraction(std::uint64_t done) const {
  return static_cast<double>(done) / static_cast<double>(mesh_.triangles.size());
}

}  // namespace verisq::command_line
