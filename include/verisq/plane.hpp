/// A plane that divides space: where a bone is resected.
#pragma once

#include <verisq/model.hpp>

namespace verisq {

/// Beyond is where (x - point) . normal > 0.
struct Plane {
  Point point;
  Point normal;  ///< finite, of any length but 0
};

}  // namespace verisq
