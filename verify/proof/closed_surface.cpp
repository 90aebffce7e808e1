/// This file implements closed_surface.hpp.
#include "verify/proof/closed_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

/// A surface that encloses a smaller share of the cube about it counts as enclosing nothing: roundings enclose as much,
/// for example the rounding of the mean that closes a rim.
constexpr double smallest_share = 1e-12;

/// The power of two that scales the largest coordinate to at most 1 and more than a half, but for the very smallest.
double scale_of(std::span<const Triangle> triangles) {
  double largest = 0.0;
  for (const Triangle& triangle : triangles) largest = std::max(largest, largest_coordinate(triangle));
  constexpr int least_exponent = -1000;  // so that the scale is finite
  return std::ldexp(1.0, largest > 0.0 ? -std::max(std::ilogb(largest) + 1, least_exponent) : 0);
}

/// Approximate: it decides only which volumes are negligible.
double volume_of_cube_about(std::span<const Triangle> triangles, double scale) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    double low = scale * triangles[0][0][i];
    double high = low;
    for (const Triangle& triangle : triangles) {
      for (const Point& corner : triangle) {
        low = std::min(low, scale * corner[i]);
        high = std::max(high, scale * corner[i]);
      }
    }
    largest = std::max(largest, high - low);
  }
  return largest * largest * largest;
}

/// An edge as its two ends in order, and which way it is run through.
struct DirectedEdge {
  std::array<Point, 2> ends;
  int direction;
};

/// Coordinates in [-1, 1], exact but where they underflow.
Vector3<double> scaled(const Point& point, const Interval& scale) {
  return {scale * Interval(point[0]), scale * Interval(point[1]), scale * Interval(point[2])};
}

}  // namespace

bool is_closed(std::span<const Triangle> triangles) {
  std::vector<DirectedEdge> edges;
  for (const Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& from = triangle[k];
      const Point& to = triangle[(k + 1) % 3];
      if (from < to) edges.push_back({{from, to}, 1});
      if (to < from) edges.push_back({{to, from}, -1});
    }
  }
  std::ranges::sort(edges, {}, &DirectedEdge::ends);
  for (auto edge = edges.begin(); edge != edges.end();) {
    const std::array<Point, 2> ends = edge->ends;
    int sum = 0;
    for (; edge != edges.end() && edge->ends == ends; ++edge) sum += edge->direction;
    if (sum != 0) return false;
  }
  return true;
}

/// Six times the volume is the sum of six times the volumes of the tetrahedra between the triangles and one point. All
/// coordinates are scaled by a power of two, which does not change the sign: products of three coordinates would
/// overflow or underflow else. After scaling, each product's underflow, below 2^-1074, is within the intervals.
std::optional<int> orientation_of(std::span<const Triangle> triangles) {
  const double scale = scale_of(triangles);
  const Vector3<double> from = scaled(triangles.front().front(), scale);
  Interval sum(0);
  for (const auto& [a, b, c] : triangles) {
    sum += (scaled(a, scale) - from).dot(cross(scaled(b, scale) - from, scaled(c, scale) - from));
  }
  const double least = 6.0 * smallest_share * volume_of_cube_about(triangles, scale);
  if (sum.lower() > least) return 1;
  if (sum.upper() < -least) return -1;
  return std::nullopt;
}

namespace {

/// Slopes of the segments: their run in x and y for 1 in z. The choice can only decide whether an answer is found.
/// Small slopes keep the segments' boxes thin; odd ones keep them off the edges of regular meshes.
constexpr std::array<std::array<double, 2>, 6> slopes{
    {{0.0123, 0.0217}, {-0.0311, 0.0173}, {0.0271, -0.0397}, {-0.0149, -0.0091}, {0.0613, 0.0447}, {-0.0829, 0.0551}}};

/// Products of three differences are far from overflow.
constexpr double largest_size = 1e100;

/// How a segment meets a triangle.
enum class Crossing : std::uint8_t { none, outward, inward };

enum class Sign : std::uint8_t { negative, positive, unknown };

Sign sign_of(const Interval& x) {
  if (x.lower() > 0.0) return Sign::positive;
  return x.upper() < 0.0 ? Sign::negative : Sign::unknown;
}

std::array<Interval, 3> way(const Point& from, const Point& to) {
  return {Interval(to[0]) - Interval(from[0]), Interval(to[1]) - Interval(from[1]),
          Interval(to[2]) - Interval(from[2])};
}

/// The sign of six times the volume of the tetrahedron.
Sign orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto u = way(a, b);
  const auto v = way(a, c);
  const auto w = way(a, d);
  return sign_of(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                 u[2] * (v[0] * w[1] - v[1] * w[0]));
}

bool boxes_meet(const Point& from, const Point& to, const Triangle& triangle) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [low, high] = std::minmax({triangle[0][i], triangle[1][i], triangle[2][i]});
    if (std::max(from[i], to[i]) < low || std::min(from[i], to[i]) > high) return false;
  }
  return true;
}

/// The crossing of the triangle's interior; nothing if the segment may touch its boundary or end on it.
std::optional<Crossing> crossing(const Point& from, const Point& to, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const std::array around{orientation(from, to, a, b), orientation(from, to, b, c), orientation(from, to, c, a)};
  // The line meets the closed triangle only where none is positive or none is negative.
  if (std::ranges::count(around, Sign::positive) > 0 && std::ranges::count(around, Sign::negative) > 0) {
    return Crossing::none;
  }
  const Sign side_of_from = orientation(a, b, c, from);
  const Sign side_of_to = orientation(a, b, c, to);
  if (side_of_from == Sign::unknown || side_of_to == Sign::unknown) return std::nullopt;
  if (side_of_from == side_of_to) return Crossing::none;
  if (std::ranges::count(around, Sign::unknown) > 0) return std::nullopt;
  return side_of_to == Sign::positive ? Crossing::outward : Crossing::inward;  // where the normal points
}

}  // namespace

ClosedSurface::ClosedSurface(std::vector<Triangle> triangles)
    : triangles_(std::move(triangles)), lower_(triangles_[0][0]), upper_(lower_) {
  for (const Triangle& triangle : triangles_) {
    for (const Point& corner : triangle) {
      for (std::size_t i = 0; i < 3; ++i) {
        lower_[i] = std::min(lower_[i], corner[i]);
        upper_[i] = std::max(upper_[i], corner[i]);
      }
    }
  }
}

std::optional<bool> ClosedSurface::odd(const Point& point) const {
  const std::optional<Crossings> found = crossings(point);
  if (!found) return std::nullopt;
  return (found->outward + found->inward) % 2 == 1;
}

std::optional<int> ClosedSurface::winding_number(const Point& point) const {
  const std::optional<Crossings> found = crossings(point);
  if (!found) return std::nullopt;
  return found->outward - found->inward;
}

std::optional<int> ClosedSurface::winding_change(const Point& begin, const Point& end,
                                                 std::span<const std::uint32_t> triangles) const {
  if (largest_coordinate(Triangle{lower_, upper_, begin}) > largest_size || largest_coordinate(end) > largest_size) {
    return std::nullopt;
  }
  int change = 0;
  for (const std::uint32_t n : triangles) {
    if (!boxes_meet(begin, end, triangles_[n])) continue;
    const std::optional<Crossing> found = crossing(begin, end, triangles_[n]);
    if (!found) return std::nullopt;
    if (*found == Crossing::outward) --change;
    if (*found == Crossing::inward) ++change;
  }
  return change;
}

std::optional<ClosedSurface::Crossings> ClosedSurface::crossings(const Point& point) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (point[i] < lower_[i] || point[i] > upper_[i]) return Crossings{};
  }
  if (largest_coordinate(Triangle{lower_, upper_, point}) > largest_size) return std::nullopt;
  for (const auto& [slope_x, slope_y] : slopes) {
    const double height = 2.0 * (upper_[2] - point[2]) + (upper_[2] - lower_[2]);
    const Point to{point[0] + slope_x * height, point[1] + slope_y * height, point[2] + height};
    if (!(to[2] > upper_[2])) return std::nullopt;  // only then it is outside
    if (const std::optional<Crossings> found = crossings(point, to)) return found;
  }
  return std::nullopt;
}

std::optional<ClosedSurface::Crossings> ClosedSurface::crossings(const Point& from, const Point& to) const {
  Crossings sum;
  for (const Triangle& triangle : triangles_) {
    if (!boxes_meet(from, to, triangle)) continue;
    const std::optional<Crossing> found = crossing(from, to, triangle);
    if (!found) return std::nullopt;
    if (*found == Crossing::outward) ++sum.outward;
    if (*found == Crossing::inward) ++sum.inward;
  }
  return sum;
}

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// The edges of only one triangle, in the direction of that triangle.
std::multimap<std::uint32_t, std::uint32_t> open_edges(const Mesh& mesh) {
  std::set<Edge> open;
  for (const auto& corners : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge edge{corners[i], corners[(i + 1) % 3]};
      if (open.erase({edge.second, edge.first}) == 0) open.insert(edge);
    }
  }
  return {open.begin(), open.end()};
}

/// Takes the edges of the walk.
std::vector<std::uint32_t> walk(std::multimap<std::uint32_t, std::uint32_t>& edges) {
  std::vector<std::uint32_t> vertices;
  auto edge = edges.begin();
  const std::uint32_t start = edge->first;
  do {
    vertices.push_back(edge->first);
    const std::uint32_t end = edge->second;
    edges.erase(edge);
    if (end == start) break;
    edge = edges.find(end);
  } while (edge != edges.end());
  return vertices;
}

Point mean_of(const Mesh& mesh, const std::vector<std::uint32_t>& vertices) {
  Point mean{};
  for (const std::uint32_t v : vertices) {
    for (std::size_t i = 0; i < 3; ++i) mean[i] += mesh.vertices[v][i] / static_cast<double>(vertices.size());
  }
  return mean;
}

}  // namespace

Closing closing_over_rims(const Mesh& mesh) {
  Closing closing;
  auto edges = open_edges(mesh);
  closing.edges = edges.size();
  if (edges.empty()) return closing;
  closing.mesh.vertices = mesh.vertices;
  for (; !edges.empty(); ++closing.rims) {
    const std::vector<std::uint32_t> rim = walk(edges);
    const auto apex = static_cast<std::uint32_t>(closing.mesh.vertices.size());
    closing.mesh.vertices.push_back(mean_of(mesh, rim));
    for (std::size_t i = 0; i < rim.size(); ++i) {
      closing.mesh.triangles.push_back({rim[(i + 1) % rim.size()], rim[i], apex});
    }
  }
  return closing;
}

std::vector<Triangle> closed_triangles(const Mesh& mesh, const Closing& closing) {
  std::vector<Triangle> triangles = triangles_of(mesh);
  const std::vector<Triangle> openings = triangles_of(closing.mesh);
  triangles.insert(triangles.end(), openings.begin(), openings.end());
  return triangles;
}

namespace {

/// Share of the largest coordinate: smaller pieces that are not proven to be apart from the others are taken to meet
/// them. Far more than the rounding of their corners.
constexpr double least_piece = 1e-9;
/// If a cavity crosses the bone's surface, one of its vertices is inside as a rule, which is soon found.
constexpr std::size_t vertices_before = 16;

/// Returns whether the triangle is proven to have no point in common with the others.
bool is_apart(const Triangle& triangle, const TriangleTree& others) {
  const double off = displacement(triangle);
  std::vector<Triangle> open{triangle};
  while (!open.empty()) {
    const Triangle piece = open.back();
    open.pop_back();
    const double radius = shape_of(piece, off).radius;
    if (others.nearest(centre(piece)).distance.lo > add(radius, off, Direction::up)) continue;
    if (!std::isfinite(radius) || radius < least_piece * largest_coordinate(triangle)) return false;
    for (const Triangle& part : quarters(piece)) open.push_back(part);
  }
  return true;
}

/// Returns whether the outer surface is proven not to wind about any point of the cavity's surface.
bool is_beside(const Mesh& cavity, const ClosedSurface& outer) {
  const auto winds_about = [&](std::size_t vertex) {
    return outer.winding_number(cavity.vertices[vertex]) != std::optional(0);
  };
  const std::size_t step = 1 + cavity.triangles.size() / vertices_before;
  for (std::size_t n = 0; n < cavity.triangles.size(); n += step)
    if (winds_about(cavity.triangles[n][0])) return false;
  const std::vector<std::uint32_t> part = connected_parts(cavity);
  std::set<std::uint32_t> parts;
  for (const auto& corners : cavity.triangles) parts.insert(part[corners[0]]);
  if (std::ranges::any_of(parts, winds_about)) return false;
  const TriangleTree others(outer.triangles());
  return std::ranges::all_of(triangles_of(cavity),
                             [&](const Triangle& triangle) { return is_apart(triangle, others); });
}

}  // namespace

void require_cavities_in_bone(const BoneRegion& bone, const std::function<const ClosedSurface&(std::size_t)>& closed) {
  for (std::size_t n = 0; n < bone.surfaces.size(); ++n) {
    if (bone.surfaces[n].bone != BoneSide::inside) continue;
    for (const BoneSurface& cavity : bone.surfaces)
      if (cavity.bone == BoneSide::outside && is_beside(cavity.mesh, closed(n)))
        throw Error(ErrorKind::input,
                    "nothing of the cavity's surface is inside of the bone's outer surface: it lies beside the bone, "
                    "or around it. Are both of one bone, in the same coordinates?");
  }
}

}  // namespace verisq::verify
