/// The options and the two sources of points.
#include "host/command_line/point_stream.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <verisq/error.hpp>
#include <verisq/mesh_file.hpp>

#include "host/command_line/file_fraction.hpp"

namespace verisq::command_line {

void declare_inputs(CLI::App& command, InputArguments& inputs) {
  command.add_option("--model", inputs.model, "Model of posed superquadrics (verisq-model/1, JSON)")
      ->required()
      ->option_text("FILE REQUIRED");
  command.add_option("--mesh", inputs.mesh, "Mesh whose vertices or triangles are meant: .stl .obj .ply .off")
      ->option_text("FILE");
  command.add_option("--points", inputs.points, "Points instead of a mesh: .csv with x,y,z a line")
      ->option_text("FILE");
}

void check_usage(const InputArguments& inputs) {
  if (inputs.mesh.empty() == inputs.points.empty()) {
    throw Error(ErrorKind::input, "give either --mesh or --points");
  }
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

double PointStream::fraction(std::uint64_t done) const {
  if (!file_) return static_cast<double>(done) / static_cast<double>(mesh_.vertices.size());
  return file_fraction(*file_, points_read_, done);
}

}  // namespace verisq::command_line
