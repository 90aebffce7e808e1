/// Whether a point has three finite coordinates.
#pragma once

#include <cmath>

#include "verisq/model.hpp"

namespace verisq::verify {

[[nodiscard]] inline bool is_finite(const Point& x) {
  return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
}

}  // namespace verisq::verify
