/// Greedily: who can tell the most others comes first.
#include "host/deviation/told_vertices.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <numeric>

#include "verify/deviation/triangle_piece.hpp"

namespace verisq {
namespace {

/// More than what roundings make of it.
constexpr double share_of_roundings = 1e-9;

/// What has to be known of a vertex's distance for all of its triangles.
struct NeededDistance {
  double farther = 0.0;      ///< it is enough to know that it is more
  double nearer = infinity;  ///< or less
  double shortest_side = infinity;
  bool exactly = false;  ///< none of both is enough
};

double length_between(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// As `verify::distances_on` bounds a piece by its corners alone.
NeededDistance need_of(const Triangle& corners, const std::array<Enclosure, 3>& distances, double distance) {
  const verify::PieceShape shape = verify::shape_of(corners, verify::displacement(corners));
  NeededDistance need{.farther = std::hypot(distance, shape.radius) * (1.0 + share_of_roundings),
                      .nearer = (distance - shape.longest / std::sqrt(3.0)) * (1.0 - share_of_roundings)};
  const bool far = std::ranges::all_of(distances, [&](const Enclosure& d) { return d.lo > need.farther; });
  const bool near = std::ranges::all_of(distances, [&](const Enclosure& d) { return d.hi < need.nearer; });
  need.exactly = !far && !near;
  for (std::size_t i = 0; i < 3; ++i)
    need.shortest_side = std::min(need.shortest_side, length_between(corners[i], corners[(i + 1) % 3]));
  return need;
}

std::vector<NeededDistance> needs_of(const Mesh& mesh, std::span<const Enclosure> distances, double distance) {
  std::vector<NeededDistance> needs(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    const auto& [a, b, c] = triangle;
    const NeededDistance need = need_of({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                        {distances[a], distances[b], distances[c]}, distance);
    for (const std::uint32_t corner : triangle) {
      NeededDistance& of = needs[corner];
      of = {std::max(of.farther, need.farther), std::min(of.nearer, need.nearer),
            std::min(of.shortest_side, need.shortest_side), of.exactly || need.exactly};
    }
  }
  return needs;
}

/// How far the way to another vertex may be that is told, at most.
double reach_of_teller(const Enclosure& known, double distance) {
  return std::max(known.lo - distance, distance - known.hi);
}

}  // namespace

std::vector<std::uint32_t> tellers(const Mesh& mesh, std::span<const Enclosure> rows, double distance,
                                   double tolerance) {
  std::vector<Enclosure> distances;
  distances.reserve(rows.size());
  for (const Enclosure& row : rows) distances.push_back(verify::widened(verify::magnitude(row), 2.0 * tolerance));
  const std::vector<NeededDistance> needs = needs_of(mesh, distances, distance);
  std::vector<std::uint32_t> teller(rows.size());
  std::iota(teller.begin(), teller.end(), 0U);
  std::vector<std::uint32_t> order = teller;
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](std::uint32_t v) { return reach_of_teller(distances[v], distance); });
  std::vector<std::uint32_t> open;  // who may be told, and is not yet
  std::ranges::copy_if(order, std::back_inserter(open), [&](std::uint32_t v) { return !needs[v].exactly; });
  for (const std::uint32_t from : order) {
    const Enclosure& known = distances[from];
    if (teller[from] != from || !(reach_of_teller(known, distance) > needs[from].shortest_side)) continue;
    std::erase_if(open, [&](std::uint32_t v) {
      if (v == from) return true;
      const double way = length_between(mesh.vertices[from], mesh.vertices[v]) * (1.0 + share_of_roundings);
      if (!(known.lo - way > needs[v].farther) && !(known.hi + way < needs[v].nearer)) return false;
      teller[v] = from;
      return true;
    });
  }
  return teller;
}

}  // namespace verisq
