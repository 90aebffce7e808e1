/// Along an edge, projected onto the surface, bisection finds where one primitive gives way to the other.
#include "host/tessellation/crease_snapping.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <utility>

#include "host/tessellation/triangle_shape.hpp"

namespace verisq::tessellation {
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

  std::vector<bool> run() && {
    std::vector<Move> moves = find_moves();
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
  /// Both ends of each mixed edge may move.
  [[nodiscard]] std::vector<Move> find_moves() const {
    std::vector<Move> moves;
    for (const std::uint32_t a : mixed_) {
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

std::vector<bool> snap_to_creases(const Solid& solid, TetrahedraSurface& surface) {
  return CreaseSnapper(solid, surface).run();
}

}  // namespace verisq::tessellation
