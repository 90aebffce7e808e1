/// Looks up the corners of each triangle.
#include "host/command_line/triangle_stream.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <verisq/mesh_file.hpp>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

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
