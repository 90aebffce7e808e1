/// Every triangle keeps the vertices taken out that are nearest to it: the way back from the surface to the mesh.
#include "host/tessellation/edge_collapse.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "host/tessellation/sampled_deviation.hpp"
#include "host/tessellation/triangle_shape.hpp"

namespace verisq::tessellation {
namespace {

/// Cosine between the normals of a triangle before and after.
constexpr double most_turned_by_collapse = 0.5;
/// Twice the area over the square of the longest side, unless it was less before.
constexpr double flattest_after_collapse = 0.05;
constexpr int most_passes = 12;
/// Of the vertices: a pass that takes out fewer is the last one.
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

  /// A triangle almost without area has no normal that could be kept: then the solid says where out is.
  [[nodiscard]] bool keeps_shape(const TriangleCorners& before, const TriangleCorners& after) const {
    const double shape_before = shape(before);
    if (shape(after) < std::min(flattest_after_collapse, shape_before)) return false;
    if (shape_before >= flattest_after_collapse) return cosine_between(before, after) > most_turned_by_collapse;
    const Eigen::Vector3d middle = (after[0] + after[1] + after[2]) / 3.0;
    return solid_.outward(middle, deviation_).dot(doubled_area(after).stableNormalized()) > most_turned_by_collapse;
  }

  /// For each point that the triangles kept, and the vertex that goes: which of the new triangles keeps it. Nothing
  /// where one is too far from all of them.
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
