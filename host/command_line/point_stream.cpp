/// The options and the two sources of points.
#include "host/command_line/point_stream.hpp"

#include <algorithm>
#include <verisq/mesh_file.hpp>

#include "host/command_line/file_fraction.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

void declare_inputs(Options& options, InputArguments& inputs) {
  require_model(options, "--model", inputs.model);
  declare_points(options, inputs);
}

void declare_points(Options& options, InputArguments& inputs) {
  add_pose(options, inputs.pose);
  options.add("--mesh", inputs.mesh, "FILE", "Mesh whose vertices or triangles are meant: .stl .obj .ply .off");
  options.add("--points", inputs.points, "FILE",
              "Points instead of a mesh: text with x,y,z a line, .npy of shape (N, 3), or - for the\nstandard input");
}

void check_usage(const InputArguments& inputs) {
  if (inputs.mesh.empty() == inputs.points.empty()) refuse("give either --mesh or --points");
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

}  // namespace verisq::command_line
