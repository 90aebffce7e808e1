/// Points as vectors of intervals of no width.
#pragma once

#include <verisq/model.hpp>

#include "verify/numbers/vector.hpp"

namespace verisq::verify {

[[nodiscard]] inline Vector3<double> exact_vector(const Point& x) {
  return {Interval(x[0]), Interval(x[1]), Interval(x[2])};
}

}  // namespace verisq::verify
