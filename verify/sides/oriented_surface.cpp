/// Edges are counted, with the way they are run through.
#include "verify/sides/oriented_surface.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "verify/containment/orientation.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  ///< the lower index first

/// Of one edge.
struct Runs {
  int forward = 0;   ///< from the lower index to the higher one
  int backward = 0;  ///<
};

std::map<Edge, Runs> runs_through(const Mesh& mesh) {
  std::map<Edge, Runs> edges;
  for (const auto& corners : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = corners[i];
      const std::uint32_t to = corners[(i + 1) % 3];
      if (from == to) throw Error(ErrorKind::input, "has no sides: a triangle uses a vertex twice");
      Runs& runs = edges[std::minmax(from, to)];
      ++(from < to ? runs.forward : runs.backward);
    }
  }
  return edges;
}

/// Those of the mesh are closed walks only then.
Closing closing_of(const Mesh& mesh) {
  require_sides(mesh);
  return closing_over_rims(mesh);
}

/// Of the triangles, by the edges that they share.
std::size_t components_of(const Mesh& mesh) {
  std::vector<std::size_t> root(mesh.triangles.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t n) {
    while (root[n] != n) n = root[n] = root[root[n]];
    return n;
  };
  std::map<Edge, std::size_t> first_of;
  std::size_t components = root.size();
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& corners = mesh.triangles[n];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [place, is_new] = first_of.emplace(std::minmax(corners[i], corners[(i + 1) % 3]), n);
      const std::size_t one = find(n);
      const std::size_t other = find(place->second);
      if (is_new || one == other) continue;
      root[one] = other;
      --components;
    }
  }
  return components;
}

}  // namespace

void require_sides(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "has no triangles, so that it has no sides");
  for (const auto& [edge, runs] : runs_through(mesh)) {
    if (runs.forward > 1 || runs.backward > 1) {
      throw Error(ErrorKind::input,
                  "has no sides: edges of more than two triangles, or triangles that are not turned alike");
    }
  }
}

OrientedSurface::OrientedSurface(const Mesh& mesh)
    : closing_(closing_of(mesh)),
      components_(components_of(mesh)),
      closed_(closed_triangles(mesh, closing_)),
      orientation_(orientation_of(closed_.triangles())) {
  if (!is_closed(closed_.triangles())) throw Error(ErrorKind::failure, "a surface is not closed over its rims");
}

std::optional<OrientedSurface::Side> OrientedSurface::side_of(const Point& point) const {
  const std::optional<int> winding = closed_.winding_number(point);
  if (!winding) return std::nullopt;
  if (*winding == 0) return Side::outside;
  if (!orientation_) return std::nullopt;
  return *winding * *orientation_ > 0 ? Side::inside : Side::neither;
}

}  // namespace verisq::verify
