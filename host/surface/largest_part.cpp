/// Vertices of a triangle belong together.
#include "host/surface/largest_part.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "verify/containment/connected_parts.hpp"

namespace verisq::surface {
namespace {

double area(const Point& a, const Point& b, const Point& c) {
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const Point v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2.0;
}

}  // namespace

LargestPart largest_part(const Mesh& mesh) {
  LargestPart result;
  if (mesh.triangles.empty()) return result;
  const std::vector<std::uint32_t> part = verify::connected_parts(mesh);
  std::unordered_map<std::uint32_t, double> areas;
  for (const auto& [a, b, c] : mesh.triangles)
    areas[part[a]] += area(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  // Of equal ones the first vertex decides, not the order of the table.
  const auto largest = std::ranges::max_element(areas, [](const auto& one, const auto& other) {
    return one.second < other.second || (one.second == other.second && one.first > other.first);
  });
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> index(mesh.vertices.size(), none);
  for (auto triangle : mesh.triangles) {
    if (part[triangle[0]] != largest->first) continue;
    for (std::uint32_t& vertex : triangle) {
      if (index[vertex] == none) {
        index[vertex] = static_cast<std::uint32_t>(result.mesh.vertices.size());
        result.mesh.vertices.push_back(mesh.vertices[vertex]);
      }
      vertex = index[vertex];
    }
    result.mesh.triangles.push_back(triangle);
  }
  result.parts_left_out = areas.size() - 1;
  return result;
}

}  // namespace verisq::surface
