/// This file implements closed_mesh.hpp.
#include "verify/search/closed_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "verify/numbers/points.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

/// Throws where it is no mesh for a tree.
std::vector<Triangle> checked_triangles(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  std::vector<Triangle> triangles = triangles_of(mesh);
  double largest = 0.0;
  for (const Triangle& triangle : triangles) largest = std::max(largest, largest_coordinate(triangle));
  if (!(largest >= WideTree::least_size && largest <= WideTree::largest_size)) {
    throw Error(ErrorKind::input,
                fmt::format("the mesh's largest coordinate is {}: use units in which it lies between {:.1e} and {:.1e}",
                            largest, WideTree::least_size, WideTree::largest_size));
  }
  return triangles;
}

/// One number for all vertices in one place.
std::vector<Corners> corners_by_place(const Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return mesh.vertices[a] < mesh.vertices[b]; });
  std::vector<std::uint32_t> number(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && mesh.vertices[order[i]] == mesh.vertices[order[i - 1]];
    number[order[i]] = same ? number[order[i - 1]] : order[i];
  }
  std::vector<Corners> corners;
  corners.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) corners.push_back({number[a], number[b], number[c]});
  return corners;
}

/// Which of them hang together.
class Connected {
 public:
  explicit Connected(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::uint32_t root(std::uint32_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

/// A side of a triangle: its ends in order, and whether the triangle runs from the first to the second.
struct ClosedMesh::SidedEdge {
  std::uint64_t ends;
  std::uint32_t triangle;
  std::int32_t direction;
};

ClosedMesh::ClosedMesh(const Mesh& mesh)
    : corners_(corners_by_place(mesh)), tree_(checked_triangles(mesh)), sides_(mesh.triangles.size()) {
  facts_.triangles = mesh.triangles.size();
  const std::vector<SidedEdge> edges = closed_edges();
  find_sides(edges, clean_triangles());
}

/// Sorted. Throws unless each is run through as often one way as the other.
std::vector<ClosedMesh::SidedEdge> ClosedMesh::closed_edges() const {
  std::vector<SidedEdge> edges;
  edges.reserve(3 * corners_.size());
  for (std::uint32_t n = 0; n < corners_.size(); ++n) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t from = corners_[n][k];
      const std::uint64_t to = corners_[n][(k + 1) % 3];
      if (from < to) edges.push_back({from << 32U | to, n, 1});
      if (to < from) edges.push_back({to << 32U | from, n, -1});
    }
  }
  std::ranges::sort(edges, {}, &SidedEdge::ends);
  std::size_t open = 0;
  for (auto edge = edges.begin(); edge != edges.end();) {
    const std::uint64_t ends = edge->ends;
    int sum = 0;
    for (; edge != edges.end() && edge->ends == ends; ++edge) sum += edge->direction;
    open += static_cast<std::size_t>(std::abs(sum));
  }
  if (open > 0) {
    throw Error(ErrorKind::input, fmt::format("the mesh is not closed: {} of its edges are open, or run through the "
                                              "same way by both triangles",
                                              open));
  }
  return edges;
}

/// Not degenerate, and proven to meet all others in common corners alone.
std::vector<bool> ClosedMesh::clean_triangles() const {
  std::vector<bool> clean(corners_.size(), true);
  std::vector<std::uint32_t> others;
  for (const std::uint32_t n : tree_.order()) {
    others.clear();
    tree_.overlapping(n, others);
    for (const std::uint32_t other : others) {
      if (!clean[n] && !clean[other]) continue;
      if (meet_in_common_corners(tree_.triangle(n), corners_[n], tree_.triangle(other), corners_[other])) continue;
      clean[n] = clean[other] = false;
    }
  }
  return clean;
}

/// Patches of clean triangles: over a side with two triangles, which run through it in opposite ways, winding numbers
/// before and behind are the same for both. One triangle of each patch is asked.
void ClosedMesh::find_sides(const std::vector<SidedEdge>& edges, const std::vector<bool>& clean) {
  Connected patches(corners_.size());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].ends == edges[i].ends) ++end;
    if (end == i + 2 && clean[edges[i].triangle] && clean[edges[i + 1].triangle]) {
      patches.join(edges[i].triangle, edges[i + 1].triangle);
    }
    i = end;
  }
  constexpr int most_tries = 8;  // triangles of a patch: where it is hidden among others none may be nearest
  std::vector<int> tries(corners_.size(), 0);
  std::vector<std::optional<int>> winding(corners_.size());
  for (const std::uint32_t n : tree_.order()) {
    if (!clean[n] || is_degenerate(tree_.triangle(n))) continue;
    const std::uint32_t patch = patches.root(n);
    if (!winding[patch] && tries[patch]++ < most_tries) winding[patch] = winding_before(n);
  }
  for (std::uint32_t n = 0; n < corners_.size(); ++n) {
    const bool degenerate = is_degenerate(tree_.triangle(n));
    facts_.degenerate += degenerate ? 1 : 0;
    facts_.unclean += !degenerate && !clean[n] ? 1 : 0;
    if (degenerate || !clean[n]) continue;
    facts_.patches += patches.root(n) == n ? 1 : 0;
    const std::optional<int> before = winding[patches.root(n)];
    if (!before) continue;
    sides_[n] = {true, *before != 0, *before + 1 != 0};
    facts_.outward += *before == 0 ? 1 : 0;
    facts_.inward += *before == -1 ? 1 : 0;
    facts_.within += sides_[n].before && sides_[n].behind ? 1 : 0;
  }
}

/// A point before the triangle, to which it alone is nearest, lies in the region that touches it there
/// (docs/mathematics.md §29).
std::optional<int> ClosedMesh::winding_before(std::uint32_t n) const {
  const Triangle& triangle = tree_.triangle(n);
  Point middle, ab, ac;
  for (std::size_t i = 0; i < 3; ++i) {
    middle[i] = triangle[0][i] / 3 + triangle[1][i] / 3 + triangle[2][i] / 3;
    ab[i] = triangle[1][i] - triangle[0][i];
    ac[i] = triangle[2][i] - triangle[0][i];
  }
  const Point normal{ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]};
  const double doubled_area = length(normal[0], normal[1], normal[2]);
  for (double height = 0x1p-4; height > 0x1p-30; height *= 0x1p-6) {
    Point point = middle;
    for (std::size_t i = 0; i < 3; ++i) point[i] += normal[i] / std::sqrt(doubled_area) * height;
    if (near_orientation(triangle, point) != 1) continue;
    const WideTree::Nearest nearest = tree_.nearest(point, n);
    if (!nearest.complete || nearest.count != 1 || nearest.near[0].triangle != n) continue;
    if (nearest.distance.lo > 0.0) return winding_number(point);
  }
  return std::nullopt;
}

bool ClosedMesh::is_in_box(const Point& point) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (point[i] < tree_.lower()[i] || point[i] > tree_.upper()[i]) return false;
  }
  return true;
}

/// Along the axis and the way on which the box ends first.
int ClosedMesh::winding_number(const Point& point) const {
  if (!is_in_box(point)) return 0;
  std::size_t axis = 0;
  bool upward = true;
  double shortest = infinity;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const bool up : {false, true}) {
      const double way = up ? tree_.upper()[i] - point[i] : point[i] - tree_.lower()[i];
      if (way >= shortest) continue;
      shortest = way;
      axis = i;
      upward = up;
    }
  }
  std::vector<std::uint32_t> met;
  tree_.along_ray(point, axis, upward, met);
  int sum = 0;
  for (const std::uint32_t n : met) sum += crossing(point, axis, upward, tree_.triangle(n));
  return sum;
}

bool ClosedMesh::is_on_triangle(const Point& point, const WideTree::Nearest& nearest) const {
  std::vector<std::uint32_t> all;
  if (nearest.complete) {
    for (std::size_t i = 0; i < nearest.count; ++i) all.push_back(nearest.near[i].triangle);
  } else {
    tree_.within(point, nearest.distance.hi, all);
  }
  return std::ranges::any_of(all, [&](std::uint32_t n) { return lies_on(point, tree_.triangle(n)); });
}

/// Where all triangles that may be nearest agree (docs/mathematics.md §29).
std::optional<ClosedMesh::Side> ClosedMesh::side_by_planes(const Point& point, const WideTree::Nearest& nearest) const {
  if (!nearest.complete) return std::nullopt;
  std::optional<bool> all;
  for (std::size_t i = 0; i < nearest.count; ++i) {
    const std::uint32_t n = nearest.near[i].triangle;
    if (!sides_[n].known) return std::nullopt;
    const std::optional<int> sign = near_orientation(tree_.triangle(n), point);
    if (!sign) return std::nullopt;
    const bool inside = *sign > 0 ? sides_[n].before : sides_[n].behind;
    if (all && *all != inside) return std::nullopt;
    all = inside;
  }
  if (!all) return std::nullopt;
  return *all ? Side::inside : Side::outside;
}

void ClosedMesh::decide_side(const Point& point, const WideTree::Nearest& nearest, Distance& distance) const {
  if (!is_in_box(point)) {
    distance.side = Side::outside;
    distance.means = Means::box;
    return;
  }
  distance.means = Means::planes;
  if (const std::optional<Side> side = side_by_planes(point, nearest)) {
    distance.side = *side;
    return;
  }
  if (!(nearest.distance.lo > 0.0) && is_on_triangle(point, nearest)) {
    distance.side = Side::on_surface;
    distance.means = Means::exact;
    return;
  }
  distance.side = winding_number(point) != 0 ? Side::inside : Side::outside;
  distance.means = Means::ray;
}

ClosedMesh::Distance ClosedMesh::signed_distance(const Point& point, std::optional<std::uint32_t> hint) const {
  const WideTree::Nearest nearest = tree_.nearest(point, hint);
  Distance distance{.signed_distance = nearest.distance,
                    .side = Side::outside,
                    .means = Means::box,
                    .triangle = nearest.triangle,
                    .alone = nearest.complete && nearest.count == 1,
                    .closest = {},
                    .normal = {}};
  decide_side(point, nearest, distance);
  const Enclosure& unsigned_distance = nearest.distance;
  if (distance.side == Side::inside) distance.signed_distance = {-unsigned_distance.hi, -unsigned_distance.lo};
  if (distance.side == Side::on_surface) distance.signed_distance = {0.0, 0.0};
  const double outward = distance.side == Side::inside ? 1.0 : -1.0;
  const double scale = unsigned_distance.hi > 0.0 ? outward / unsigned_distance.hi : 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    distance.closest[i] = point[i] + nearest.way[i];
    distance.normal[i] = nearest.way[i] * scale;
  }
  return distance;
}

namespace {

/// The bits of three coordinates in turn, ten of each (Morton's order), for points within the box; others are clamped.
std::uint32_t morton_code(const Point& point, const Point& lower, const std::array<double, 3>& scale) {
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double cell = std::clamp((point[i] - lower[i]) * scale[i], 0.0, 1023.0);
    auto bits = static_cast<std::uint32_t>(cell);
    bits = (bits | bits << 16U) & 0x030000FFU;
    bits = (bits | bits << 8U) & 0x0300F00FU;
    bits = (bits | bits << 4U) & 0x030C30C3U;
    bits = (bits | bits << 2U) & 0x09249249U;
    code |= bits << i;
  }
  return code;
}

std::vector<std::uint64_t> morton_order(std::span<const Point> points) {
  if (points.empty()) return {};
  Point lower = points[0];
  Point upper = points[0];
  for (const Point& point : points) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], point[i]);
      upper[i] = std::max(upper[i], point[i]);
    }
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, upper[i] - lower[i]);
  const double scale = largest > 0.0 ? 1023.0 / largest : 0.0;
  std::vector<std::uint64_t> order(points.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    order[n] = std::uint64_t{morton_code(points[n], lower, {scale, scale, scale})} << 32U | n;
  }
  std::ranges::sort(order);
  return order;
}

}  // namespace

void ClosedMesh::signed_distances(std::span<const Point> points, std::span<Distance> distances) const {
  std::optional<std::uint32_t> hint;
  for (const std::uint64_t place : morton_order(points)) {
    const auto n = static_cast<std::uint32_t>(place);
    distances[n] = signed_distance(points[n], hint);
    hint = distances[n].triangle;
  }
}

}  // namespace verisq::verify
