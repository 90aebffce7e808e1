/// This file implements closed_mesh.hpp.
#include "verify/search/closed_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
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

ClosedMesh::ClosedMesh(const Mesh& mesh)
    : corners_(corners_by_place(mesh)), tree_(checked_triangles(mesh)), sides_(mesh.triangles.size()) {
  facts_.triangles = mesh.triangles.size();
  const std::vector<SidedEdge> edges = closed_edges(corners_);
  find_sides(edges, clean_triangles());
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

namespace {

/// Patches of clean triangles: over a side with two triangles, which run through it in opposite ways, winding numbers
/// before and behind are the same for both.
Connected patches_of(std::size_t triangles, const std::vector<SidedEdge>& edges, const std::vector<bool>& clean) {
  Connected patches(triangles);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].ends == edges[i].ends) ++end;
    if (end == i + 2 && clean[edges[i].triangle] && clean[edges[i + 1].triangle]) {
      patches.join(edges[i].triangle, edges[i + 1].triangle);
    }
    i = end;
  }
  return patches;
}

}  // namespace

/// One triangle of each patch is asked.
void ClosedMesh::find_sides(const std::vector<SidedEdge>& edges, const std::vector<bool>& clean) {
  Connected patches = patches_of(corners_.size(), edges, clean);
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
    if (const std::optional<int> before = winding[patches.root(n)]) set_sides(n, *before);
  }
}

/// Behind a triangle the winding number is one higher.
void ClosedMesh::set_sides(std::uint32_t n, int before) {
  sides_[n] = {true, before != 0, before + 1 != 0};
  facts_.outward += before == 0 ? 1 : 0;
  facts_.inward += before == -1 ? 1 : 0;
  facts_.within += sides_[n].before && sides_[n].behind ? 1 : 0;
}

/// A point before the triangle, to which it alone is nearest, lies in the region that touches it there
/// (docs/mathematics.md §29).
std::optional<int> ClosedMesh::winding_before(std::uint32_t n) const {
  const Triangle& triangle = tree_.triangle(n);
  Point middle;
  Point ab;
  Point ac;
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
std::optional<ClosedMesh::Side> ClosedMesh::side_by_planes(const WideTree::Nearest& nearest) const {
  if (!nearest.complete) return std::nullopt;
  std::optional<bool> all;
  for (std::size_t i = 0; i < nearest.count; ++i) {
    const std::uint32_t n = nearest.near[i].triangle;
    if (!sides_[n].known) return std::nullopt;
    const int sign = nearest.near[i].side;
    if (sign == 0) return std::nullopt;
    const bool inside = sign > 0 ? sides_[n].before : sides_[n].behind;
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
  if (const std::optional<Side> side = side_by_planes(nearest)) {
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

bool is_at_rest(const Pose& pose) {
  const auto& q = pose.quaternion;
  return pose.translation == Point{} && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0;
}

PlacedMesh placed(const Primitive& primitive) {
  if (is_at_rest(primitive.pose)) return {*primitive.mesh};
  return placed(*primitive.mesh, RigidMotion(primitive.pose));
}

namespace {

/// Which of a model's meshes is refused, its name tells.
ClosedMesh closed_mesh_of(const Primitive& primitive) {
  try {
    return ClosedMesh(*primitive.mesh);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: {}", primitive.name, error.what()));
  }
}

}  // namespace

PosedMesh::PosedMesh(const Primitive& primitive) : mesh_(closed_mesh_of(primitive)) {
  if (is_at_rest(primitive.pose)) return;
  motion_.emplace(primitive.pose);
  turned_.translation = primitive.pose.translation;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      turned_.rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          in_binary64(motion_->rotation(i, j)).lower();
    }
  }
}

/// R^T (x - t). Each difference d rounds by u, each element of R by at most 2u of 1, the three products and two sums by
/// 3u: a coordinate is off by at most 6.1 u Σ|d|, the point by less than 2^-49 Σ|d|. Underflow is far below
/// 2^-1000.
PosedMesh::OwnPoint PosedMesh::own_point(const Point& point) const {
  if (!motion_) return {point, 0.0};
  OwnPoint own{{}, 0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const double way = point[i] - turned_.translation[i];
    own.displacement += std::abs(way);
    for (std::size_t j = 0; j < 3; ++j) own.point[j] += turned_.rows[i][j] * way;
  }
  own.displacement = own.displacement * 0x1p-49 + 0x1p-1000;
  return own;
}

Point PosedMesh::model_vector(const Point& own) const {
  if (!motion_) return own;
  Point result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = turned_.rows[i];
    result[i] = row[0] * own[0] + row[1] * own[1] + row[2] * own[2];
  }
  return result;
}

Point PosedMesh::model_point(const Point& own) const {
  Point result = model_vector(own);
  if (!motion_) return result;
  for (std::size_t i = 0; i < 3; ++i) result[i] += turned_.translation[i];
  return result;
}

Triangle PosedMesh::triangle(std::uint32_t n) const {
  Triangle result = mesh_.tree().triangle(n);
  for (Point& corner : result) corner = model_point(corner);
  return result;
}

/// R v + (t - c). Elements of R are off by at most 2u of 1, three products and two sums round by 3u: R v by 5.1 u Σ|v|.
/// The difference rounds by u, the last sum by u of both: 6.2 u Σ|v| + 2.1 u |t - c|, at most 6.2 u of the size.
Triangle PosedMesh::triangle_about(const Point& centre, std::uint32_t n) const {
  Triangle result = mesh_.tree().triangle(n);
  for (Point& corner : result) {
    corner = model_vector(corner);
    for (std::size_t i = 0; i < 3; ++i) corner[i] += turned_.translation[i] - centre[i];
  }
  return result;
}

/// Σ|v| of the box's farthest corner and the largest |t - c|, with more than their sums round by.
double PosedMesh::size_about(const Point& centre) const {
  double sum = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += std::max(std::abs(mesh_.tree().lower()[i]), std::abs(mesh_.tree().upper()[i]));
    largest = std::max(largest, std::abs(turned_.translation[i] - centre[i]));
  }
  return (sum + largest) * (1.0 + 0x1p-40);
}

namespace {

/// For a point so far that its place in the own frame overflows.
constexpr ClosedMesh::Distance nothing_known{.signed_distance = {-infinity, infinity},
                                             .side = ClosedMesh::Side::outside,
                                             .means = ClosedMesh::Means::box,
                                             .triangle = 0,
                                             .alone = false,
                                             .closest = {},
                                             .normal = {}};

bool is_known(const PosedMesh::OwnPoint& own) {
  return is_finite(own.point) && std::isfinite(own.displacement);
}

}  // namespace

/// The signed distance changes by no more than the way between two points, across the surface, too.
void PosedMesh::place(double displacement, ClosedMesh::Distance& distance) const {
  if (!motion_) return;
  const Interval widened =
      Interval(distance.signed_distance.lo, distance.signed_distance.hi) + Interval(-displacement, displacement);
  distance.signed_distance = {widened.lower(), widened.upper()};
  distance.closest = model_point(distance.closest);
  distance.normal = model_vector(distance.normal);
}

ClosedMesh::Distance PosedMesh::signed_distance(const Point& point, std::optional<std::uint32_t> hint) const {
  const OwnPoint own = own_point(point);
  if (!is_known(own)) return nothing_known;
  ClosedMesh::Distance distance = mesh_.signed_distance(own.point, hint);
  place(own.displacement, distance);
  return distance;
}

void PosedMesh::signed_distances(std::span<const Point> points, std::span<ClosedMesh::Distance> distances) const {
  if (!motion_) return mesh_.signed_distances(points, distances);
  std::vector<OwnPoint> own;
  std::vector<Point> places;
  for (const Point& point : points) {
    own.push_back(own_point(point));
    places.push_back(is_known(own.back()) ? own.back().point : Point{});
  }
  mesh_.signed_distances(places, distances);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_known(own[i]))
      place(own[i].displacement, distances[i]);
    else
      distances[i] = nothing_known;
  }
}

}  // namespace verisq::verify
