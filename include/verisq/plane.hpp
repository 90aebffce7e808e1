/// A plane that parts what is kept from what is beyond it.
#pragma once

#include <verisq/model.hpp>

namespace verisq {

/// Beyond is where (x - point) . normal > 0.
struct Plane {
  Point point;
  Point normal;  ///< of any length but 0
};

}  // namespace verisq
