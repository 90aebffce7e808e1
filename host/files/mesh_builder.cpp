/// Index, polygon and area checks shared by all mesh formats.
#include "host/files/mesh_builder.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "host/files/triangle_area.hpp"

namespace verisq {
namespace {

std::string text(const Point& p) {
  return fmt::format("({}, {}, {})", p[0], p[1], p[2]);
}

}  // namespace

void MeshBuilder::reserve(std::size_t vertices, std::size_t triangles) {
  mesh_.vertices.reserve(vertices);
  mesh_.triangles.reserve(triangles);
}

std::uint32_t MeshBuilder::add_vertex(const Point& vertex) {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  if (mesh_.vertices.size() == most) file_.fail(fmt::format("more than {} vertices are not supported", most));
  mesh_.vertices.push_back(vertex);
  return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
}

std::uint32_t MeshBuilder::checked_index(std::int64_t index) const {
  const std::size_t count = mesh_.vertices.size();
  if (index < 0 || static_cast<std::uint64_t>(index) >= count) {
    file_.fail(fmt::format("vertex index {}: out of range, the file has {} vertices, counted from 0", index, count));
  }
  return static_cast<std::uint32_t>(index);
}

void MeshBuilder::check_corner_count(std::int64_t count) const {
  if (count < 3) file_.fail(fmt::format("number of corners = {}: a face needs at least 3", count));
}

void MeshBuilder::add_polygon(std::span<const std::uint32_t> corners) {
  check_corner_count(static_cast<std::int64_t>(corners.size()));
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const std::array<std::uint32_t, 3> triangle{corners[0], corners[k - 1], corners[k]};
    const Point& a = mesh_.vertices[triangle[0]];
    const Point& b = mesh_.vertices[triangle[1]];
    const Point& c = mesh_.vertices[triangle[2]];
    if (has_zero_area(a, b, c)) {
      file_.fail(fmt::format("triangle {} has zero area: corners {}, {}, {}", mesh_.triangles.size() + 1, text(a),
                             text(b), text(c)));
    }
    mesh_.triangles.push_back(triangle);
  }
}

Mesh MeshBuilder::finish() && {
  if (mesh_.vertices.empty()) file_.fail_whole("no vertices");
  return std::move(mesh_);
}

}  // namespace verisq
