/// The improvement of triangles of tetrahedra_surface.hpp.
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "host/prepare/tetrahedra_surface.hpp"

namespace verisq::tessellation {
namespace {

/// Directions from a cube's centre to its corners, edges and faces: no direction is farther than 28 degrees from one of
/// them.
std::vector<Eigen::Vector3d> spread_directions() {
  std::vector<Eigen::Vector3d> directions;
  for (const int x : {-1, 0, 1}) {
    for (const int y : {-1, 0, 1}) {
      for (const int z : {-1, 0, 1}) {
        if (x != 0 || y != 0 || z != 0) directions.push_back(Eigen::Vector3d(x, y, z).normalized());
      }
    }
  }
  return directions;
}

/// Returns whether a point at most `deviation` away lies on the other side of the surface.
bool is_near(const Solid& solid, const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double deviation) {
  static const std::vector<Eigen::Vector3d> anywhere = spread_directions();
  const bool inside = solid.contains(point);
  const auto passes = [&](const Eigen::Vector3d& direction) {
    return solid.contains(point + deviation * direction) != inside;
  };
  const double out = inside ? 1.0 : -1.0;
  if (passes(out * normal) || passes(-out * normal)) return true;
  const Eigen::Vector3d gradient = solid.outward(point, deviation);
  return passes(out * gradient) || std::ranges::any_of(anywhere, passes);
}

}  // namespace

bool within(const Solid& solid, const TriangleCorners& triangle, double deviation, Sampling sampling) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d normal = doubled_area(triangle).stableNormalized();
  const auto near_surface = [&](const Eigen::Vector3d& point) { return is_near(solid, point, normal, deviation); };
  if (!near_surface((a + b + c) / 3.0)) return false;
  const int steps = static_cast<int>(sampling);
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j <= steps - i; ++j) {
      const int k = steps - i - j;
      if (j == steps || k == steps || (i == j && j == k)) continue;
      if (!near_surface((i * a + j * b + k * c) / steps)) return false;
    }
  }
  return true;
}

double sampled_deviation(const Solid& solid, const TriangleCorners& triangle, double least, double most,
                         Sampling sampling) {
  double deviation = least;
  while (deviation < most && !within(solid, triangle, deviation, sampling)) deviation *= 1.125;
  return deviation < most ? deviation : most;
}

namespace {

constexpr int bisections = 24;
/// Cosine between normals of a triangle before and after.
constexpr double most_turned_by_snapping = 0.3;
/// Twice the area over the square of the longest side: 0.87 for equal sides.
constexpr double flattest_after_snapping = 0.02;

struct Move {
  std::uint32_t vertex;
  std::uint32_t other;  ///< the edge's other end, in the order of preference
  Eigen::Vector3d target;
  double length;
};

class CreaseSnapper {
 public:
  CreaseSnapper(const Solid& solid, TetrahedraSurface& surface)
      : solid_(solid), surface_(surface), moved_(surface.vertices.size(), false), triangles_at_(moved_.size()) {
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      const auto& [a, b, c] = surface.triangles[t];
      if (surface.primitives[a] == surface.primitives[b] && surface.primitives[b] == surface.primitives[c]) continue;
      for (const std::uint32_t corner : {a, b, c}) mixed_.push_back(corner);
    }
    std::ranges::sort(mixed_);
    mixed_.erase(std::unique(mixed_.begin(), mixed_.end()), mixed_.end());
    std::vector<bool> wanted(moved_.size(), false);
    for (const std::uint32_t vertex : mixed_) wanted[vertex] = true;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      for (const std::uint32_t corner : surface.triangles[t]) {
        if (wanted[corner]) triangles_at_[corner].push_back(t);
      }
    }
  }

  std::vector<bool> run(const std::function<bool()>& interrupted) && {
    std::vector<Move> moves = find_moves(interrupted);
    std::ranges::sort(moves, {}, &Move::length);
    for (const Move& move : moves) {
      if (moved_[move.vertex] || moved_[move.other]) continue;
      if (may_move(move.vertex, move.target)) {
        surface_.vertices[move.vertex] = move.target;
        moved_[move.vertex] = true;
      }
    }
    return std::move(moved_);
  }

 private:
  /// The possible moves: both ends of each mixed edge may move.
  [[nodiscard]] std::vector<Move> find_moves(const std::function<bool()>& interrupted) const {
    std::vector<Move> moves;
    for (const std::uint32_t a : mixed_) {
      if (interrupted()) return {};
      for (const std::uint32_t t : triangles_at_[a]) {
        const auto& corners = surface_.triangles[t];
        const auto place = std::ranges::find(corners, a) - corners.begin();
        const std::uint32_t b = corners[static_cast<std::size_t>(place + 1) % 3];
        if (surface_.primitives[a] == surface_.primitives[b] || a > b) continue;
        const std::optional<Eigen::Vector3d> crease = crease_between(a, b);
        if (!crease) continue;
        moves.push_back({a, b, *crease, (surface_.vertices[a] - *crease).norm()});
        moves.push_back({b, a, *crease, (surface_.vertices[b] - *crease).norm()});
      }
    }
    return moves;
  }

  [[nodiscard]] Eigen::Vector3d normal_at(std::uint32_t vertex) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::uint32_t t : triangles_at_[vertex]) sum += doubled_area(corners(surface_.triangles[t]));
    return sum.stableNormalized();
  }

  [[nodiscard]] std::optional<Eigen::Vector3d> crease_between(std::uint32_t a, std::uint32_t b) const {
    const Eigen::Vector3d& from = surface_.vertices[a];
    const Eigen::Vector3d& to = surface_.vertices[b];
    const Eigen::Vector3d normal = (normal_at(a) + normal_at(b)).stableNormalized();
    const double reach = (to - from).norm();
    double low = 0.0;
    double high = 1.0;
    std::optional<Eigen::Vector3d> point;
    for (int step = 0; step < bisections; ++step) {
      const double middle = (low + high) / 2.0;
      point = solid_.surface_along(from + middle * (to - from), normal, reach);
      if (!point) return std::nullopt;
      (solid_.level(*point).primitive == surface_.primitives[a] ? low : high) = middle;
    }
    return point;
  }

  [[nodiscard]] TriangleCorners corners(const std::array<std::uint32_t, 3>& triangle) const {
    return {surface_.vertices[triangle[0]], surface_.vertices[triangle[1]], surface_.vertices[triangle[2]]};
  }

  [[nodiscard]] bool may_move(std::uint32_t vertex, const Eigen::Vector3d& target) const {
    return std::ranges::all_of(triangles_at_[vertex], [&](std::uint32_t t) {
      const auto& triangle = surface_.triangles[t];
      const TriangleCorners before = corners(triangle);
      TriangleCorners after = before;
      after[static_cast<std::size_t>(std::ranges::find(triangle, vertex) - triangle.begin())] = target;
      return shape(after) > std::min(flattest_after_snapping, 0.5 * shape(before)) &&
             cosine_between(before, after) > most_turned_by_snapping;
    });
  }

  const Solid& solid_;
  TetrahedraSurface& surface_;
  std::vector<bool> moved_;
  std::vector<std::vector<std::uint32_t>> triangles_at_;  // of the vertices in mixed_
  std::vector<std::uint32_t> mixed_;                      // corners of triangles across a crease
};

}  // namespace

std::vector<bool> snap_to_creases(const Solid& solid, TetrahedraSurface& surface,
                                  const std::function<bool()>& interrupted) {
  return CreaseSnapper(solid, surface).run(interrupted);
}

namespace {

/// Cosine between the normals of a triangle before and after.
constexpr double most_turned_by_collapse = 0.5;
/// Twice the area over the square of the longest side, unless it was less before.
constexpr double flattest_after_collapse = 0.05;
constexpr int most_passes = 12;
/// Share of the vertices: a pass that removes fewer is the last one.
constexpr double least_gain = 0.01;

using Corners = std::array<std::uint32_t, 3>;

double squared_distance_to_segment(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d way = b - a;
  const double t = std::clamp((point - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (point - a - t * way).squaredNorm();
}

double squared_distance(const Eigen::Vector3d& point, const TriangleCorners& triangle) {
  const Eigen::Vector3d normal = doubled_area(triangle);
  const auto beyond = [&](std::size_t i) {  // the side from corner i
    const Eigen::Vector3d side = triangle[(i + 1) % 3] - triangle[i];
    return side.cross(point - triangle[i]).dot(normal) < 0.0;
  };
  if (!beyond(0) && !beyond(1) && !beyond(2)) {
    const double height = (point - triangle[0]).dot(normal);
    return height * height / normal.squaredNorm();
  }
  return std::min({squared_distance_to_segment(point, triangle[0], triangle[1]),
                   squared_distance_to_segment(point, triangle[1], triangle[2]),
                   squared_distance_to_segment(point, triangle[2], triangle[0])});
}

class EdgeCollapser {
 public:
  EdgeCollapser(const Solid& solid, Triangles surface, double deviation)
      : solid_(solid),
        deviation_(deviation),
        vertices_(std::move(surface.vertices)),
        triangles_(std::move(surface.triangles)),
        alive_(triangles_.size(), true),
        replaced_(triangles_.size()),
        triangles_at_(vertices_.size()),
        changed_(vertices_.size(), true) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (const std::uint32_t corner : triangles_[t]) triangles_at_[corner].push_back(t);
    }
  }

  Triangles run(const std::function<bool()>& interrupted) && {
    for (int pass = 0; pass < most_passes; ++pass) {
      const std::size_t collapsed = collapse_once(interrupted);
      if (static_cast<double>(collapsed) < least_gain * static_cast<double>(vertices_.size()) || interrupted()) break;
    }
    return compressed();
  }

 private:
  struct Edge {
    double squared_length;
    std::uint32_t from, to;
  };

  std::size_t collapse_once(const std::function<bool()>& interrupted) {
    const std::vector<Edge> candidates = edges_to_try();
    changed_.assign(changed_.size(), false);
    std::size_t collapsed = 0;
    for (const Edge& edge : candidates) {
      if (collapsed % 1024 == 0 && interrupted()) break;
      if (try_collapse(edge.from, edge.to) || try_collapse(edge.to, edge.from)) ++collapsed;
    }
    return collapsed;
  }

  [[nodiscard]] std::vector<Edge> edges_to_try() const {
    std::vector<Edge> found;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!alive_[t]) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = triangles_[t][i];
        const std::uint32_t b = triangles_[t][(i + 1) % 3];
        if (a < b && (changed_[a] || changed_[b])) found.push_back({(vertices_[a] - vertices_[b]).squaredNorm(), a, b});
      }
    }
    std::ranges::sort(found, {}, [](const Edge& edge) { return std::tuple(edge.squared_length, edge.from, edge.to); });
    return found;
  }

  bool try_collapse(std::uint32_t from, std::uint32_t to) {
    if (!keeps_topology(from, to)) return false;
    std::vector<std::uint32_t> changing;
    std::vector<std::uint32_t> dying;
    for (const std::uint32_t t : triangles_at_[from]) {
      (std::ranges::count(triangles_[t], to) > 0 ? dying : changing).push_back(t);
    }
    std::vector<TriangleCorners> after;
    for (const std::uint32_t t : changing) {
      const TriangleCorners before = corners(triangles_[t]);
      after.push_back(corners(with(triangles_[t], from, to)));
      if (!keeps_shape(before, after.back())) return false;
    }
    const auto moved = points_moved(from, changing, dying, after);
    if (!moved) return false;
    const auto near_solid = [&](const TriangleCorners& triangle) {
      return within(solid_, triangle, deviation_, Sampling::usual);
    };
    if (!std::ranges::all_of(after, near_solid)) return false;
    collapse(from, to, changing, dying, *moved);
    return true;
  }

  /// The link condition: the ends have no common neighbours but the two apexes of the edge's triangles; and no
  /// tetrahedron vanishes.
  [[nodiscard]] bool keeps_topology(std::uint32_t from, std::uint32_t to) const {
    const std::vector<std::uint32_t> around_from = neighbours(from);
    if (!std::ranges::binary_search(around_from, to)) return false;
    const std::vector<std::uint32_t> around_to = neighbours(to);
    std::vector<std::uint32_t> common;
    std::ranges::set_intersection(around_from, around_to, std::back_inserter(common));
    return common.size() == 2 && around_from.size() > 3 && around_to.size() > 3 &&
           std::ranges::all_of(common, [&](std::uint32_t apex) { return triangles_at_[apex].size() > 3; });
  }

  [[nodiscard]] std::vector<std::uint32_t> neighbours(std::uint32_t vertex) const {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t t : triangles_at_[vertex]) {
      for (const std::uint32_t corner : triangles_[t]) {
        if (corner != vertex) result.push_back(corner);
      }
    }
    std::ranges::sort(result);
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  /// A triangle almost without area has no normal that could be kept: then the solid determines the outward direction.
  [[nodiscard]] bool keeps_shape(const TriangleCorners& before, const TriangleCorners& after) const {
    const double shape_before = shape(before);
    if (shape(after) < std::min(flattest_after_collapse, shape_before)) return false;
    if (shape_before >= flattest_after_collapse) return cosine_between(before, after) > most_turned_by_collapse;
    const Eigen::Vector3d middle = (after[0] + after[1] + after[2]) / 3.0;
    return solid_.outward(middle, deviation_).dot(doubled_area(after).stableNormalized()) > most_turned_by_collapse;
  }

  /// For each point that the triangles represented, and for the vertex that goes: the new triangle that represents it.
  /// Nothing if one of them is too far from all new triangles.
  using Moved = std::vector<std::pair<std::uint32_t, std::size_t>>;
  [[nodiscard]] std::optional<Moved> points_moved(std::uint32_t from, const std::vector<std::uint32_t>& changing,
                                                  const std::vector<std::uint32_t>& dying,
                                                  const std::vector<TriangleCorners>& after) const {
    Moved moved;
    const auto move = [&](std::uint32_t point) {
      std::size_t nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < after.size(); ++i) {
        const double distance = squared_distance(vertices_[point], after[i]);
        if (distance < least) std::tie(least, nearest) = std::tuple(distance, i);
      }
      moved.emplace_back(point, nearest);
      return least <= deviation_ * deviation_;
    };
    if (!move(from)) return std::nullopt;
    for (const auto* triangles : {&changing, &dying}) {
      for (const std::uint32_t t : *triangles) {
        if (!std::ranges::all_of(replaced_[t], move)) return std::nullopt;
      }
    }
    return moved;
  }

  void collapse(std::uint32_t from, std::uint32_t to, const std::vector<std::uint32_t>& changing,
                const std::vector<std::uint32_t>& dying, const Moved& moved) {
    for (const std::uint32_t t : dying) {
      alive_[t] = false;
      replaced_[t].clear();
      for (const std::uint32_t corner : triangles_[t]) std::erase(triangles_at_[corner], t);
    }
    for (const std::uint32_t t : changing) {
      triangles_[t] = with(triangles_[t], from, to);
      replaced_[t].clear();
      triangles_at_[to].push_back(t);
      for (const std::uint32_t corner : triangles_[t]) changed_[corner] = true;
    }
    triangles_at_[from].clear();
    for (const auto& [point, triangle] : moved) replaced_[changing[triangle]].push_back(point);
  }

  [[nodiscard]] static Corners with(Corners triangle, std::uint32_t from, std::uint32_t to) {
    std::ranges::replace(triangle, from, to);
    return triangle;
  }

  [[nodiscard]] TriangleCorners corners(const Corners& triangle) const {
    return {vertices_[triangle[0]], vertices_[triangle[1]], vertices_[triangle[2]]};
  }

  [[nodiscard]] Triangles compressed() const {
    Triangles result;
    std::vector<std::uint32_t> index(vertices_.size());
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      index[v] = static_cast<std::uint32_t>(result.vertices.size());
      if (!triangles_at_[v].empty()) result.vertices.push_back(vertices_[v]);
    }
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!alive_[t]) continue;
      const auto& [a, b, c] = triangles_[t];
      result.triangles.push_back({index[a], index[b], index[c]});
    }
    return result;
  }

  const Solid& solid_;
  double deviation_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Corners> triangles_;
  std::vector<bool> alive_;
  std::vector<std::vector<std::uint32_t>> replaced_;      // vertices that were near this triangle and are no more
  std::vector<std::vector<std::uint32_t>> triangles_at_;  // of each vertex
  std::vector<bool> changed_;                             // vertices whose triangles are not those of the last pass
};

}  // namespace

Triangles collapse_edges(const Solid& solid, Triangles surface, double deviation,
                         const std::function<bool()>& interrupted) {
  return EdgeCollapser(solid, std::move(surface), deviation).run(interrupted);
}

}  // namespace verisq::tessellation
