/// Corners inside come first, in an order that keeps the tetrahedron positive: then one table says all.
#include "host/tessellation/tetrahedra_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "host/threads/parallel.hpp"

namespace verisq::tessellation {
namespace {

/// Of an edge: vertices nearer to its end would make triangles of no area once coordinates are rounded.
constexpr double closest_to_end = 1e-3;
constexpr std::size_t vertices_a_chunk = 1024;

}  // namespace

void SurfaceMarcher::classify() {
  const std::size_t known = inside_.size();
  const std::size_t count = grid_.vertices().size();
  inside_.resize(count);
  const std::size_t chunks = (count - known + vertices_a_chunk - 1) / vertices_a_chunk;
  in_parallel(chunks, [&](std::size_t chunk) {
    const std::size_t first = known + chunk * vertices_a_chunk;
    const std::size_t last = std::min(count, first + vertices_a_chunk);
    for (std::size_t v = first; v < last; ++v) inside_[v] = solid_.contains(grid_.vertices()[v]) ? 1 : 0;
  });
}

TetrahedraSurface SurfaceMarcher::surface() {
  classify();
  indices_.clear();
  TetrahedraSurface result;
  for (std::uint32_t k = 0; k < grid_.tetrahedra().size(); ++k) {
    if (grid_.is_leaf(k)) add_triangles(k, result);
  }
  return result;
}

void SurfaceMarcher::add_triangles(std::uint32_t k, TetrahedraSurface& surface) {
  std::array<std::uint32_t, 4> corners = grid_.tetrahedra()[k].corners;
  const auto is_outside = [&](std::uint32_t corner) { return inside_[corner] == 0; };
  const auto outside = std::ranges::count_if(corners, is_outside);
  if (outside == 0 || outside == 4) return;
  std::stable_partition(corners.begin(), corners.end(), [&](std::uint32_t corner) { return !is_outside(corner); });
  const auto& v = grid_.vertices();
  const Eigen::Vector3d& apex = v[corners[0]];
  const double volume = (v[corners[1]] - apex).cross(v[corners[2]] - apex).dot(v[corners[3]] - apex);
  if (volume < 0.0) outside == 1 ? std::swap(corners[0], corners[1]) : std::swap(corners[2], corners[3]);
  const auto [a, b, c, d] = corners;
  const auto on = [&](std::uint32_t p, std::uint32_t q) { return vertex_on(p, q, surface); };
  const auto add = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    surface.triangles.push_back({p, q, r});
    surface.tetrahedra.push_back(k);
  };
  if (outside == 3) return add(on(a, b), on(a, c), on(a, d));
  if (outside == 1) return add(on(a, d), on(b, d), on(c, d));
  const std::array<std::uint32_t, 4> quad{on(a, c), on(a, d), on(b, d), on(b, c)};
  const auto length = [&](std::size_t i, std::size_t j) {
    return (surface.vertices[quad[i]] - surface.vertices[quad[j]]).norm();
  };
  const std::size_t first = length(0, 2) < length(1, 3) ? 0 : 1;
  add(quad[first], quad[first + 1], quad[first + 2]);
  add(quad[first], quad[first + 2], quad[(first + 3) % 4]);
}

std::uint32_t SurfaceMarcher::vertex_on(std::uint32_t a, std::uint32_t b, TetrahedraSurface& surface) {
  const std::uint64_t key = edge_key(a, b);
  const auto [place, added] = indices_.try_emplace(key, static_cast<std::uint32_t>(surface.vertices.size()));
  if (!added) return place->second;
  auto known = crossings_.find(key);
  if (known == crossings_.end()) known = crossings_.emplace(key, crossing(a, b)).first;
  surface.vertices.push_back(known->second.point);
  surface.primitives.push_back(known->second.primitive);
  return place->second;
}

SurfaceMarcher::Crossing SurfaceMarcher::crossing(std::uint32_t inside, std::uint32_t outside) const {
  const Eigen::Vector3d& from = grid_.vertices()[inside];
  const Eigen::Vector3d& to = grid_.vertices()[outside];
  const double t = std::clamp(solid_.crossing(from, to), closest_to_end, 1.0 - closest_to_end);
  const Eigen::Vector3d point = from + t * (to - from);
  return {point, solid_.level(point).primitive};
}

}  // namespace verisq::tessellation
