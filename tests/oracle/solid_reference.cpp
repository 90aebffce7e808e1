/// Sampling, search and proof of the reference.
#include "tests/oracle/solid_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "tests/oracle/approach.hpp"
#include "tests/oracle/clear_ball.hpp"
#include "tests/oracle/edge_descent.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::oracle {

namespace {

constexpr int samples_a_primitive = 4000;
constexpr std::size_t most_starts = 6;
constexpr int quick_trials = 120;
constexpr int long_trials = 200;
[[nodiscard]] std::size_t octant(const Point& local) {
  return (local[0] < 0 ? 1U : 0U) + (local[1] < 0 ? 2U : 0U) + (local[2] < 0 ? 4U : 0U);
}

[[nodiscard]] double distance(const Point& a, const Point& b) {
  return length(difference(a, b));
}

}  // namespace

SolidReference::SolidReference(const Model& model) : placed_(model), exact_(model) {
  RandomCases random(1);
  for (std::size_t i = 0; i < placed_.primitives().size(); ++i) {
    const PlacedPrimitive& p = placed_.primitives()[i];
    for (int k = 0; k < samples_a_primitive; ++k) {
      const Point local = random.boundary_point(p.primitive().superquadric).point;
      for (const double scale : {1 - 1e-6, 1 + 1e-6}) {
        const Sample sample{p.placed(scaled(local, scale)), 8 * i + octant(local)};
        const Membership side = placed_(sample.point);
        if (side == Membership::inside) inside_.push_back(sample);
        if (side == Membership::outside) outside_.push_back(sample);
      }
    }
  }
}

std::vector<Point> SolidReference::points_of_solid() const {
  std::vector<Point> points;
  for (const Sample& sample : inside_) points.push_back(sample.point);
  return points;
}

/// The nearest samples of different bins, and q drawn onto the boundary of each primitive.
std::vector<Point> SolidReference::starts(const Point& q, Membership set) const {
  std::map<std::size_t, std::pair<double, Point>> nearest;
  for (const auto& [point, bin] : samples(set)) {
    const double away = distance(point, q);
    const auto [entry, is_new] = nearest.try_emplace(bin, away, point);
    if (!is_new && away < entry->second.first) entry->second = {away, point};
  }
  for (std::size_t i = 0; i < placed_.primitives().size(); ++i) {
    const PlacedPrimitive& p = placed_.primitives()[i];
    const Point local = p.own(q);
    const double gauge = p.norm().gauge(local);
    if (!(gauge > 0)) continue;
    for (const double scale : {1 - 1e-9, 1 + 1e-9}) {
      const Point point = p.placed(scaled(local, scale / gauge));
      if (placed_(point) == set) nearest.try_emplace(1000 + 2 * i + (scale > 1 ? 1 : 0), distance(point, q), point);
    }
  }
  std::vector<std::pair<double, Point>> ranked;
  ranked.reserve(nearest.size());
  for (const auto& [bin, candidate] : nearest) ranked.push_back(candidate);
  std::sort(ranked.begin(), ranked.end());
  std::vector<Point> result;
  for (std::size_t i = 0; i < std::min(most_starts, ranked.size()); ++i) result.push_back(ranked[i].second);
  return result;
}

Point SolidReference::polished(const Point& q, Membership set, const Point& start) const {
  const auto in_set = [&](const Point& point) { return placed_(point) == set; };
  RandomCases random(3);
  return approach(q, slid_along_edges(placed_, set, q, start), long_trials, random, in_set);
}

Point SolidReference::nearest(const Point& q, Membership set) const {
  if (exact_(widened(q)) == set) return q;
  const auto in_set = [&](const Point& point) { return placed_(point) == set; };
  const auto nearer = [&](const Point& a, const Point& b) { return distance(a, q) < distance(b, q); };
  RandomCases random(2);
  std::vector<Point> candidates;
  for (const Point& start : starts(q, set)) candidates.push_back(approach(q, start, quick_trials, random, in_set));
  std::sort(candidates.begin(), candidates.end(), nearer);
  for (std::size_t i = 0; i < std::min<std::size_t>(3, candidates.size()); ++i) {
    candidates.push_back(polished(q, set, candidates[i]));
  }
  std::sort(candidates.begin(), candidates.end(), nearer);
  for (const Point& candidate : candidates) {
    if (exact_(widened(candidate)) == set) return candidate;
  }
  return {infinity, infinity, infinity};
}

SolidFacts SolidReference::facts(const Point& q, std::size_t budget) const {
  const Vector exact_q = widened(q);
  const Membership side = exact_(exact_q);
  if (side == Membership::boundary) {
    // Nearer to the boundary than the margin of ExactMembership, by the size and the smallest semi-axis.
    const Real slack = ldexp(Real(size()) + length(exact_q), -60);
    return {side, -slack, slack};
  }
  const Membership set = complement(side);
  Real distance = std::numeric_limits<Real>::infinity();
  const auto use = [&](const Point& member) {
    if (!std::isfinite(member[0]) || exact_(widened(member)) != set) return;
    distance = std::min<Real>(distance, length(difference(exact_q, widened(member))) * (1 + ldexp(Real(1), -190)));
  };
  use(nearest(q, set));
  double clear = 0.0;
  if (set == Membership::inside || isfinite(distance)) {
    const ClearBall ball = clear_ball(placed_, set, q, distance.convert_to<double>(), budget);
    clear = ball.radius;
    if (ball.member) use(polished(q, set, *ball.member));
  }
  return side == Membership::outside ? SolidFacts{side, Real(clear), distance}
                                     : SolidFacts{side, -distance, Real(-clear)};
}

}  // namespace verisq::oracle
