/// Best-first refinement of the polyhedron's shallowest face.
#include "verify/search/inscribed_polyhedron.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>
#include <vector>

#include "verify/proof/superquadric.hpp"
#include "verify/proposals/boundary.hpp"
#include "verify/proposals/triangle.hpp"
#include "verisq/enclosure.hpp"

// Why the faces of the polyhedron prove a depth. Let d1, d2, d3 >= 0 with q + d_i proven inside the solid K, and c >= 0
// with |c| <= 1 and c·d_i >= t > 0. A vector v of the cone of the d_i with |v| <= t is v = Σ l_i d_i, l_i >= 0, and
// t Σ l_i <= c·v <= |v| <= t, so that q + v lies in the hull of q and the q + d_i, which lies in K. When cones cover
// the octant, B(q, t) lies in K, because g is monotone in each |coordinate| and |q_k + t u_k| <= q_k + t |u_k|. The
// best c points at the point of the triangle d1 d2 d3 closest to q, and then t is the distance to it. The gap to the
// surface is that of chords: zero where the surface is flat, quadratic in the size of the face elsewhere. Of a tapered
// solid g is monotone in |x| and |y| alone: cones cover z < 0, too, where d_i and c have z <= 0.

namespace verisq::verify {

namespace {

using Vector = Coordinates<double>;

/// Σ a_k b_k of numbers whose products are not negative, on one side.
double rounded_dot(const Vector& a, const Vector& b, Direction direction) {
  const double xy = add(multiply(a[0], b[0], direction), multiply(a[1], b[1], direction), direction);
  return add(xy, multiply(a[2], b[2], direction), direction);
}

/// A point q + reach * direction, proven to lie in the solid.
struct Corner {
  Vector direction;  ///< exact: barycentric coordinates that are multiples of a power of two
  double reach;
  Vector offset;  ///< reach * direction, rounded down
};

/// The cone of three corners (of two, one repeated, in the plane).
struct Cell {
  std::array<int, 3> corners;
  double depth;  ///< proven for this cone
  int level;     ///< bisections so far

  bool operator<(const Cell& other) const { return depth > other.depth; }  // the shallowest cell comes first
};

/// Directions stay exact for this many bisections; tolerances of 1e-12 need about 40.
constexpr int kDeepestLevel = 50;

class Polyhedron {
 public:
  Polyhedron(const Superquadric& solid, const Vector& q) : boundary_(solid), bounds_(solid), q_(q) {}

  Depth enclose(bool planar, const DepthGoal& goal) {
    best_.lower = goal.known;
    const Vector start = boundary_.normal(q_);
    descend(start, boundary_.exit(q_, start));
    const int x = add_corner({1.0, 0.0, 0.0});
    const int z = add_corner({0.0, 0.0, 1.0});
    const int y = planar ? z : add_corner({0.0, 1.0, 0.0});
    std::priority_queue<Cell> cells;
    cells.push(cell({x, y, z}, 0));
    if (bounds_.is_tapered()) {
      const int below = add_corner({0.0, 0.0, -1.0});
      cells.push(cell({x, planar ? below : y, below}, 0));
    }
    for (;;) {
      const Cell worst = cells.top();
      best_.lower = std::max(best_.lower, worst.depth);
      if (best_.upper - best_.lower <= goal.tolerance || worst.level == kDeepestLevel ||
          static_cast<int>(corners_.size()) >= goal.budget) {
        return best_;
      }
      cells.pop();
      for (const Cell& half : bisect(worst)) cells.push(half);
    }
  }

 private:
  /// From a direction to the normal where its ray leaves the solid, and again: each tangent plane is at least as close
  /// as the exit before it. Keeps the closest plane.
  void descend(Vector w, double exit) {
    for (int i = 0; i < 30; ++i) {
      const Vector n = boundary_.normal(along(q_, w, exit));
      const double distance = exit * dot(w, n);
      if (!(distance < best_.upper)) return;
      const bool settled = best_.upper - distance < 1e-15 * distance;
      best_.upper = distance;
      best_.normal = n;
      if (settled) return;
      w = n;
      exit = boundary_.exit(q_, w);
    }
  }

  [[nodiscard]] bool proven_inside(const Vector& w, double reach) const {
    Vector3<double> x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = Interval(q_[k]) + Interval(reach) * Interval(w[k]);
    return bounds_.gauge_up(x) <= 1.0;
  }

  /// As far along the ray as can be proven; zero at worst, for q itself is inside.
  [[nodiscard]] double proven_reach(const Vector& w) const {
    double margin = 4e-15;
    while (margin < 1.0) {
      const double reach = boundary_.exit(q_, w, 1.0 - margin);
      if (proven_inside(w, reach)) return reach;
      margin *= 8.0;
    }
    return 0.0;
  }

  int add_corner(const Vector& w) {
    descend(w, boundary_.exit(q_, w));
    Corner corner{w, proven_reach(w), {}};
    for (std::size_t k = 0; k < 3; ++k) {
      corner.offset[k] = multiply(corner.reach, w[k], w[k] < 0.0 ? Direction::up : Direction::down);  // towards 0
    }
    corners_.push_back(corner);
    return static_cast<int>(corners_.size()) - 1;
  }

  [[nodiscard]] const Vector& offset(int corner) const { return corners_[static_cast<std::size_t>(corner)].offset; }

  [[nodiscard]] Cell cell(const std::array<int, 3>& corners, int level) const {
    const Vector& a = offset(corners[0]);
    const Vector& b = offset(corners[1]);
    const Vector& c = offset(corners[2]);
    Vector axis = closest_to_origin(a, b, c);
    // Dividing by a length rounded up, downwards, makes |axis| <= 1 certain.
    const double length = square_root(rounded_dot(axis, axis, Direction::up), Direction::up);
    if (!(length > 0.0)) return {corners, 0.0, level};
    const bool below = a[2] < 0.0 || b[2] < 0.0 || c[2] < 0.0;
    axis[2] = below ? -axis[2] : axis[2];
    for (double& k : axis) k = divide(std::max(k, 0.0), length, Direction::down);
    axis[2] = below ? -axis[2] : axis[2];
    const double depth = std::min({rounded_dot(axis, a, Direction::down), rounded_dot(axis, b, Direction::down),
                                   rounded_dot(axis, c, Direction::down)});
    return {corners, depth, level};
  }

  /// Splits at the middle of the longest edge of the face.
  std::array<Cell, 2> bisect(const Cell& parent) {
    constexpr std::array<std::pair<int, int>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};
    std::pair<int, int> longest{};
    double squared = -1.0;
    for (const auto& [i, j] : edges) {
      const Vector edge = difference(offset(parent.corners[i]), offset(parent.corners[j]));
      if (dot(edge, edge) <= squared) continue;
      squared = dot(edge, edge);
      longest = {parent.corners[i], parent.corners[j]};
    }
    const int middle = middle_of(longest.first, longest.second);
    std::array<int, 3> first = parent.corners;
    std::array<int, 3> second = parent.corners;
    std::ranges::replace(first, longest.second, middle);
    std::ranges::replace(second, longest.first, middle);
    return {cell(first, parent.level + 1), cell(second, parent.level + 1)};
  }

  int middle_of(int a, int b) {
    const auto [position, created] = middles_.try_emplace(std::minmax(a, b), 0);
    if (created) {
      const Vector& u = corners_[static_cast<std::size_t>(a)].direction;
      const Vector& v = corners_[static_cast<std::size_t>(b)].direction;
      position->second = add_corner({0.5 * (u[0] + v[0]), 0.5 * (u[1] + v[1]), 0.5 * (u[2] + v[2])});
    }
    return position->second;
  }

  Boundary<double> boundary_;
  SuperquadricBounds<double> bounds_;
  Vector q_;
  Depth best_{0.0, infinity, {1.0, 0.0, 0.0}};
  std::vector<Corner> corners_;
  std::map<std::pair<int, int>, int> middles_;
};

}  // namespace

Depth enclose_depth(const Superquadric& solid, const std::array<double, 3>& q, bool planar, const DepthGoal& goal) {
  return Polyhedron(solid, q).enclose(planar, goal);
}

}  // namespace verisq::verify
