/// Alternating projections, and pairs of cubes.
#include "tests/oracle/solid_pair_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "tests/oracle/solid_reference.hpp"

namespace verisq::oracle {

namespace {

constexpr std::size_t starts = 4;
constexpr int alternations = 12;

struct Cube {
  Point centre;
  double half_edge;

  [[nodiscard]] Ball ball() const { return {centre, half_edge * std::numbers::sqrt3 * (1 + 1e-12)}; }
  [[nodiscard]] Cube child(unsigned corner) const {
    Cube result{centre, half_edge / 2};
    for (unsigned i = 0; i < 3; ++i) result.centre[i] += (corner >> i & 1) != 0 ? half_edge / 2 : -half_edge / 2;
    return result;
  }
};

[[nodiscard]] double gap(const Cube& a, const Cube& b) {
  Point d;
  for (std::size_t i = 0; i < 3; ++i) {
    d[i] = std::max(0.0, std::abs(a.centre[i] - b.centre[i]) - a.half_edge - b.half_edge);
  }
  return length(d);
}

struct CubePair {
  Cube a;
  Cube b;
  double distance;

  CubePair(const Cube& first, const Cube& second) : a(first), b(second), distance(gap(first, second)) {}
  [[nodiscard]] bool operator<(const CubePair& other) const { return distance > other.distance; }
};

/// The nearest pair of cubes that may hold points of both models.
[[nodiscard]] double clear_distance(const PlacedModel& a, const PlacedModel& b, double limit, std::size_t budget) {
  const auto root = [](const PlacedModel& m) { return Cube{m.bounding_ball().centre, m.bounding_ball().radius}; };
  std::priority_queue<CubePair> pairs;
  pairs.emplace(root(a), root(b));
  for (std::size_t spent = 0; !pairs.empty(); spent += 8) {
    const CubePair nearest = pairs.top();
    if (nearest.distance >= limit || spent >= budget) break;
    pairs.pop();
    const bool divides_a = nearest.a.half_edge >= nearest.b.half_edge;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Cube child = (divides_a ? nearest.a : nearest.b).child(corner);
      const CubePair pair = divides_a ? CubePair(child, nearest.b) : CubePair(nearest.a, child);
      if (pair.distance >= limit) continue;
      if ((divides_a ? a : b)(child.ball()) != Membership::outside) pairs.push(pair);
    }
  }
  const double distance = pairs.empty() ? limit : std::min(limit, pairs.top().distance);
  const double magnitude = length(root(a).centre) + length(root(b).centre) + root(a).half_edge + root(b).half_edge;
  return std::max(0.0, distance * (1 - 1e-12) - std::ldexp(magnitude, -46));
}

/// Points of both, `distance` apart.
struct Chord {
  double distance;
  Point on_a;
  Point on_b;
};

[[nodiscard]] Chord chord(const Point& a, const Point& b) {
  return {length(difference(a, b)), a, b};
}

/// Goes from a point of A to the nearest of B, back, and so on.
[[nodiscard]] Chord alternated(const SolidReference& a, const SolidReference& b, Chord best) {
  for (int i = 0; i < alternations && best.distance > 0; ++i) {
    const Point on_b = b.nearest(best.on_a, Membership::inside);
    const Point on_a = a.nearest(on_b, Membership::inside);
    const Chord next = chord(on_a, on_b);
    const bool stalls = !(next.distance < best.distance * (1 - 1e-7));
    if (next.distance < best.distance) best = next;
    if (stalls) break;
  }
  return best;
}

}  // namespace

SolidPairFacts pair_facts(const Model& first, const Model& second, std::size_t budget) {
  const SolidReference a(first);
  const SolidReference b(second);
  // The nearest sample of B for some samples of A, the best few of them to go on from.
  std::vector<Chord> chords;
  const std::vector<Point> of_a = a.points_of_solid();
  const std::vector<Point> of_b = b.points_of_solid();
  for (std::size_t i = 0; i < of_a.size(); i += 1 + of_a.size() / 400) {
    Chord best{std::numeric_limits<double>::infinity(), {}, {}};
    for (const Point& point : of_b) {
      const Chord next = chord(of_a[i], point);
      if (next.distance < best.distance) best = next;
    }
    chords.push_back(best);
  }
  std::sort(chords.begin(), chords.end(), [](const Chord& x, const Chord& y) { return x.distance < y.distance; });
  Real upper = std::numeric_limits<Real>::infinity();
  for (std::size_t i = 0; i < std::min(starts, chords.size()); ++i) {
    const Chord found = alternated(a, b, chords[i * (chords.size() / starts) / 8]);
    const Vector on_a = widened(found.on_a);
    const Vector on_b = widened(found.on_b);
    if (a.exact()(on_a) != Membership::inside || b.exact()(on_b) != Membership::inside) continue;
    upper = std::min<Real>(upper, length(difference(on_a, on_b)) * (1 + ldexp(Real(1), -190)));
  }
  const double lower = clear_distance(a.placed(), b.placed(), upper.convert_to<double>(), budget);
  return {Real(lower), upper};
}

}  // namespace verisq::oracle
