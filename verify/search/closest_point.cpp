/// What follows of a signed distance and of a normal.
#include "verisq/closest_point.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proof/rigid_motion.hpp"
#include "verify/search/enclosing_box.hpp"

namespace verisq {

ClosestPoint closest_point_within(const Enclosure& distance, const Point& x) {
  using verify::Direction;
  const double farthest = std::max(std::fabs(distance.lo), std::fabs(distance.hi));
  ClosestPoint result{distance, {}, {}, std::nullopt, false};
  for (std::size_t k = 0; k < 3; ++k) {
    result.point[k] = {verify::subtract(x[k], farthest, Direction::down), verify::add(x[k], farthest, Direction::up)};
    result.normal[k] = {-1.0, 1.0};
  }
  return result;
}

std::array<Enclosure, 6> gradient_by_motion(const ClosestPoint& closest, const Point& x, const Point& centre) {
  using verify::PreciseInterval;
  const auto component = [&](std::size_t k) {
    return PreciseInterval(verify::Real(closest.normal[k].lo), verify::Real(closest.normal[k].hi));
  };
  const verify::PreciseVector n{component(0), component(1), component(2)};
  const verify::PreciseVector arm = verify::precise(x) - verify::precise(centre);
  const verify::PreciseVector moment{arm[1] * n[2] - arm[2] * n[1], arm[2] * n[0] - arm[0] * n[2],
                                     arm[0] * n[1] - arm[1] * n[0]};
  const auto turning = verify::rounded_outward(moment);
  return {closest.normal[0], closest.normal[1], closest.normal[2], turning[0], turning[1], turning[2]};
}

}  // namespace verisq
