/// How far around a point a model is proven to be absent, or to be all there is: a lower bound of |signed distance|.
#pragma once

#include <cstddef>
#include <optional>

#include "tests/oracle/placed_model.hpp"

namespace verisq::oracle {

struct ClearBall {
  double radius;
  std::optional<Point> member;  ///< a point of the set that the search met, near the nearest one at best
};

/// No point of the set is nearer to q than the radius: of the solid with Membership::inside, of its complement with
/// Membership::outside. Best-first search over an octree with first-order exclusion of each cube's ball, in double with
/// margins; ends where the radius reaches `limit` or after `budget` cubes: then it is small, not wrong. For the
/// complement `limit` must be finite.
[[nodiscard]] ClearBall clear_ball(const PlacedModel& model, Membership set, const Point& q, double limit,
                                   std::size_t budget);

}  // namespace verisq::oracle
