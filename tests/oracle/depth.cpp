/// Multi-start descent in double over the directions of the octant, Newton's method at 200 bits for the best.
#include "tests/oracle/depth.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include "tests/oracle/stationarity.hpp"

namespace verisq::oracle {

namespace {

using Direction = Triple<double>;

/// What the two kinds of search spend.
struct Effort {
  int fineness;           ///< steps of the grid of directions along an edge of the octant
  std::size_t descended;  ///< candidates that descend far
  int descent_steps;
  std::size_t polished;         ///< candidates that go to Newton's method
  double nearly_zero;           ///< q_i/a_i below which x_i may be anything: several starts for Newton's method
  std::vector<double> decades;  ///< the further starts x_i/a_i there, for the best candidate
};

[[nodiscard]] Effort effort_of(Search search) {
  if (search == Search::usual) return {4, 8, 40, 3, 1e-6, {}};
  return {45, 200, 2000, 12, 1e-2, {0.3, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-7, 1e-10}};
}

/// A boundary point, its normal, and the proven bound (1 - n·q)/|n| on the depth (up to rounding in double).
struct Candidate {
  Direction boundary_point;
  Direction normal;
  double depth;
};

/// Where the ray q + t v leaves the solid. Newton from beyond: g is convex along the ray, so the steps are monotone.
[[nodiscard]] Candidate ray_exit(const MixedNorm<double>& norm, const Direction& q, const Direction& v) {
  double t = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    if (v[i] > 0) t = std::min(t, (norm.semi_axes()[i] - q[i]) / v[i]);
  }
  Direction x = q;
  Direction normal{};
  for (int step = 0; step < 60; ++step) {
    for (std::size_t i = 0; i < 3; ++i) x[i] = q[i] + t * v[i];
    const double gauge = norm.gauge(x);
    normal = norm.gradient(x, gauge);
    const double decrease = (gauge - 1) / dot(normal, v);
    if (!(decrease > 1e-15 * t)) break;
    t -= decrease;
  }
  return {x, normal, (1 - dot(normal, q)) / length(normal)};
}

/// Descent: among the directions v with v_k·v >= 1 the least h(v) - v·q is attained at the normal of the point where
/// the ray along v_k leaves the solid, so the depth bound never grows.
[[nodiscard]] Candidate descend(const MixedNorm<double>& norm, const Direction& q, Candidate candidate, int steps) {
  for (int step = 0; step < steps; ++step) {
    const Candidate next = ray_exit(norm, q, candidate.normal);
    if (!(next.depth < candidate.depth * (1 - 1e-14))) break;
    candidate = next;
  }
  // Where the solid is flat the ray may leave far from the foot of the normal, which is the nearest point.
  const double step = candidate.depth / length(candidate.normal);
  for (std::size_t i = 0; i < 3; ++i) candidate.boundary_point[i] = q[i] + step * candidate.normal[i];
  return candidate;
}

/// Directions w of the octant on a barycentric grid, and the same as normals of the ellipsoid of these semi-axes.
[[nodiscard]] std::vector<Direction> starting_directions(const Direction& axes, int fineness) {
  std::vector<Direction> directions;
  for (int i = 0; i <= fineness; ++i) {
    for (int j = 0; i + j <= fineness; ++j) {
      const Direction w{static_cast<double>(i), static_cast<double>(j), static_cast<double>(fineness - i - j)};
      directions.push_back(w);
      const bool on_axis = i == fineness || j == fineness || i + j == 0;
      if (!on_axis) directions.push_back({w[0] / axes[0], w[1] / axes[1], w[2] / axes[2]});
    }
  }
  return directions;
}

[[nodiscard]] bool alike(const Candidate& a, const Candidate& b) {
  const double cosine = dot(a.normal, b.normal) / (length(a.normal) * length(b.normal));
  return cosine > 1 - 1e-10;
}

/// Descends from all starts, a few steps for all and many for the promising; the shallowest first, without repetition.
[[nodiscard]] std::vector<Candidate> shallowest(const MixedNorm<double>& norm, const Direction& q,
                                                const Effort& effort) {
  std::vector<Candidate> candidates;
  const double gauge = norm.gauge(q);
  if (gauge > 0) {
    const Direction normal = norm.gradient(q, gauge);
    candidates.push_back({scaled(q, 1 / gauge), normal, (1 - dot(normal, q)) / length(normal)});
  }
  for (const Direction& start : starting_directions(norm.semi_axes(), effort.fineness)) {
    candidates.push_back(ray_exit(norm, q, start));
  }
  const auto by_depth = [](const Candidate& a, const Candidate& b) { return a.depth < b.depth; };
  for (Candidate& candidate : candidates) candidate = descend(norm, q, candidate, 2);
  std::erase_if(candidates, [](const Candidate& c) { return !std::isfinite(c.depth); });
  std::sort(candidates.begin(), candidates.end(), by_depth);
  candidates.resize(std::min(candidates.size(), effort.descended));
  for (Candidate& candidate : candidates) candidate = descend(norm, q, candidate, effort.descent_steps);
  std::sort(candidates.begin(), candidates.end(), by_depth);
  std::vector<Candidate> distinct;
  for (const Candidate& candidate : candidates) {
    const bool known =
        std::any_of(distinct.begin(), distinct.end(), [&](const Candidate& d) { return alike(d, candidate); });
    if (!known && distinct.size() < effort.polished) distinct.push_back(candidate);
  }
  return distinct;
}

/// The proven bound of one direction.
[[nodiscard]] Real bound(const MixedNorm<Real>& norm, const Vector& q, const Vector& v) {
  return (dot(v, q) - norm.support(v)) / length(v);
}

/// The stationary point that Newton finds from x; empty when it finds none.
[[nodiscard]] std::optional<DeepestDirection> polished(const Stationarity& stationarity, const MixedNorm<Real>& norm,
                                                       const Vector& q, const Vector& x) {
  const std::array<bool, 3> present{x[0] > 0, x[1] > 0, x[2] > 0};
  const auto count = std::ranges::count(present, true);
  if (count == 0) return std::nullopt;
  if (count == 1) return DeepestDirection{x, x, bound(norm, q, x)};  // a tip: its normal is its axis
  const std::optional<Contact> contact = stationarity.solve(stationarity.contact_at(x, present), ldexp(Real(1), -60));
  if (!contact) return std::nullopt;
  const Vector boundary_point = stationarity.point(*contact);
  const Real gauge = norm.gauge(boundary_point);
  if (!isfinite(gauge) || gauge <= 0) return std::nullopt;
  const Vector normal = norm.gradient(boundary_point, gauge);
  return DeepestDirection{boundary_point, normal, bound(norm, q, normal)};
}

/// Where a nearest point may leave the plane x_i = 0 although q_i = 0: with p < 2 the solid has a ridge there, and the
/// balance x_i = λ ∂g/∂x_i reads (x_i/a_i)^(2-p) = λ/a_i^2, for the section times r^(p1-p2); near the tips of z, where
/// p1 governs the section too, (x_i/a_i)^(2-p1) = λ/a_i^2.
[[nodiscard]] std::vector<Real> heights_over_ridge(const MixedNorm<double>& norm, const Candidate& candidate,
                                                   std::size_t i) {
  constexpr double negligible = 1e-40;
  const auto& [x, normal, depth] = candidate;
  const double p1 = norm.outer().primal;
  const double p2 = norm.inner().primal;
  const Real section = norm.gauge({x[0], x[1], 0.0});
  const double axis = norm.semi_axes()[i];
  const Real balance = depth / length(normal) / (axis * axis);
  std::vector<Real> heights;
  const auto add = [&](const Real& ratio, double p) {
    if (p >= 2) return;
    const Real height = pow(ratio, 1 / (2 - Real(p)));
    if (height > negligible && height < 1) heights.push_back(axis * std::min<Real>(height, 0.5));
  };
  if (i < 2) add(balance * pow(section, p1 - p2), p2);
  if (i == 2 || section < 0.1) add(balance, p1);
  return heights;
}

/// Starts for Newton near one candidate. A coordinate of q that is zero or nearly so has two kinds of stationary
/// points, one with x_i near q_i (zero if q_i is) and one away from it; descent tells them apart too slowly, so all
/// are tried, in all combinations, with x_i/a_i of `decades` besides.
[[nodiscard]] std::vector<Vector> newton_starts(const MixedNorm<double>& norm, const Vector& q,
                                                const Candidate& candidate, double nearly_zero,
                                                std::span<const double> decades) {
  constexpr double away = 1e-4;
  Vector x = widened(candidate.boundary_point);
  for (std::size_t i = 0; i < 3; ++i) x[i] = std::max<Real>(x[i], q[i]);
  std::vector<Vector> starts{x};
  for (std::size_t i = 0; i < 3; ++i) {
    const double axis = norm.semi_axes()[i];
    if (q[i] > nearly_zero * axis) continue;
    std::vector<Real> values = heights_over_ridge(norm, candidate, i);
    const double own = candidate.boundary_point[i];
    const auto alike = [own](const Real& value) { return abs(value - own) < 0.01 * own; };
    if (own > away * axis && std::none_of(values.begin(), values.end(), alike)) values.emplace_back(own);
    for (const double ratio : decades) values.emplace_back(ratio * axis);
    const std::size_t so_far = starts.size();
    for (std::size_t k = 0; k < so_far; ++k) {
      for (const Real& value : values) {
        starts.push_back(starts[k]);
        starts.back()[i] = value + q[i];
      }
      starts[k][i] = 1.5 * q[i];
    }
  }
  return starts;
}

}  // namespace

DeepestDirection deepest_direction(const Superquadric& superquadric, const MixedNorm<Real>& norm, const Vector& q,
                                   Search search) {
  const Effort effort = effort_of(search);
  const Stationarity stationarity(norm, q, Side::inside);
  const MixedNorm<double> rough(superquadric);
  DeepestDirection best{{}, {}, -std::numeric_limits<Real>::infinity()};
  const auto improve = [&](std::span<const Vector> starts) {
    for (const Vector& x : starts) {
      const std::optional<DeepestDirection> point = polished(stationarity, norm, q, x);
      if (point && point->bound > best.bound) best = *point;
    }
  };
  for (const Candidate& candidate : shallowest(rough, rounded(q), effort)) {
    const Vector normal = widened(candidate.normal);
    const DeepestDirection unpolished{widened(candidate.boundary_point), normal, bound(norm, q, normal)};
    if (unpolished.bound > best.bound) best = unpolished;
    improve(newton_starts(rough, q, candidate, effort.nearly_zero, {}));
  }
  // Once more from the best: only at a polished point are the heights over the ridges those of a stationary point.
  const Candidate winner{rounded(best.boundary_point), rounded(best.normal), -best.bound.convert_to<double>()};
  const std::vector<Vector> starts = newton_starts(rough, q, winner, effort.nearly_zero, effort.decades);
  if (starts.size() > 1) improve(starts);
  return best;
}

}  // namespace verisq::oracle
