/// Best-first search: the nearest cube that is not excluded is the bound.
#include "tests/oracle/clear_ball.hpp"

#include <cmath>
#include <numbers>
#include <queue>

namespace verisq::oracle {

namespace {

struct Cell {
  Point centre;
  double half_edge;
  double distance;  ///< of q to the cube

  Cell(const Point& c, double half, const Point& q) : centre(c), half_edge(half) {
    Point gap;
    for (std::size_t i = 0; i < 3; ++i) gap[i] = std::max(0.0, std::abs(q[i] - c[i]) - half);
    distance = length(gap);
  }

  [[nodiscard]] Ball ball() const { return {centre, half_edge * std::numbers::sqrt3 * (1 + 1e-12)}; }
  [[nodiscard]] bool operator<(const Cell& other) const { return distance > other.distance; }
};

}  // namespace

ClearBall clear_ball(const PlacedModel& model, Membership set, const Point& q, double limit, std::size_t budget) {
  const Membership excluded = complement(set);
  const Ball whole = set == Membership::inside ? model.bounding_ball() : Ball{q, limit};
  std::optional<Point> member;
  double to_member = limit;
  std::priority_queue<Cell> cells;
  cells.emplace(whole.centre, whole.radius, q);
  for (std::size_t spent = 0; !cells.empty(); spent += 8) {
    const Cell nearest = cells.top();
    if (nearest.distance >= limit || spent >= budget) break;
    cells.pop();
    const double to_centre = length(difference(nearest.centre, q));
    if (to_centre < to_member && model(nearest.centre) == set) {
      member = nearest.centre;
      to_member = to_centre;
    }
    const double half = nearest.half_edge / 2;
    for (unsigned corner = 0; corner < 8; ++corner) {
      Point centre = nearest.centre;
      for (unsigned i = 0; i < 3; ++i) centre[i] += (corner >> i & 1) != 0 ? half : -half;
      const Cell child(centre, half, q);
      if (child.distance < limit && model(child.ball()) != excluded) cells.push(child);
    }
  }
  const double radius = cells.empty() ? limit : std::min(limit, cells.top().distance);
  // The centres of cubes are rounded: far below what the margins of PlacedModel cover, not below a tiny radius.
  const double rounding = std::ldexp(length(q) + length(whole.centre) + whole.radius, -46);
  return {std::max(0.0, radius * (1 - 1e-12) - rounding), member};
}

}  // namespace verisq::oracle
