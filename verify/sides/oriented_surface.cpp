/// Edges are counted, with the way they are run through; the volume's sign is that of an interval.
#include "verify/sides/oriented_surface.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "verify/analysis/largest_coordinate.hpp"
#include "verify/numbers/interval.hpp"
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

/// Throws where the rims of the mesh are no closed walks.
Closing closing_of(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "has no triangles, so that it has no sides");
  for (const auto& [edge, runs] : runs_through(mesh)) {
    if (runs.forward > 1 || runs.backward > 1) {
      throw Error(ErrorKind::input,
                  "has no sides: edges of more than two triangles, or triangles that are not turned alike");
    }
  }
  return closing_over_rims(mesh);
}

/// Every edge is run through as often one way as the other, so that there is a winding number off the surface.
void require_closed(Mesh mesh, const Closing& closing) {
  mesh.triangles.insert(mesh.triangles.end(), closing.mesh.triangles.begin(), closing.mesh.triangles.end());
  for (const auto& [edge, runs] : runs_through(mesh)) {
    if (runs.forward != runs.backward) throw Error(ErrorKind::failure, "a surface is not closed over its rims");
  }
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

/// Products of three differences stay far from overflow.
constexpr double largest_size = 1e100;

/// Of six times the volume, the sum of the tetrahedra between the triangles and a corner.
std::optional<int> orientation_of(const std::vector<Triangle>& triangles) {
  for (const Triangle& triangle : triangles) {
    if (largest_coordinate(triangle) > largest_size) return std::nullopt;
  }
  const Point& apex = triangles[0][0];
  const auto from_apex = [&](const Point& x) {
    return std::array{Interval(x[0]) - Interval(apex[0]), Interval(x[1]) - Interval(apex[1]),
                      Interval(x[2]) - Interval(apex[2])};
  };
  Interval volume(0);
  for (const Triangle& triangle : triangles) {
    const auto a = from_apex(triangle[0]);
    const auto b = from_apex(triangle[1]);
    const auto c = from_apex(triangle[2]);
    volume +=
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  if (volume.lower() > 0.0) return 1;
  if (volume.upper() < 0.0) return -1;
  return std::nullopt;
}

}  // namespace

OrientedSurface::OrientedSurface(const Mesh& mesh)
    : closing_(closing_of(mesh)),
      components_(components_of(mesh)),
      closed_(closed_triangles(mesh, closing_)),
      orientation_(orientation_of(closed_.triangles())) {
  require_closed(mesh, closing_);
}

std::optional<OrientedSurface::Side> OrientedSurface::side_of(const Point& point) const {
  const std::optional<int> winding = closed_.winding_number(point);
  if (!winding) return std::nullopt;
  if (*winding == 0) return Side::outside;
  if (!orientation_) return std::nullopt;
  return *winding * *orientation_ > 0 ? Side::inside : Side::neither;
}

}  // namespace verisq::verify
