/// The distance of two points, rounded up.
#pragma once

#include "verify/proof/rigid_motion.hpp"

namespace verisq::verify {

/// |x - y|, rounded up to binary64.
[[nodiscard]] inline double distance_up(const Point& x, const Point& y) {
  return length<Real>(PreciseVector(precise(x) - precise(y))).upper().to_double(Direction::up);
}

}  // namespace verisq::verify
