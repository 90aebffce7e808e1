/// Where a solid is, about, for searches to begin at: proves nothing.
#pragma once

#include "verisq/model.hpp"

namespace verisq::verify {

/// A ball about the middle of its bounding box.
struct SolidExtent {
  Point centre;
  double radius;
};

[[nodiscard]] SolidExtent extent_of(const Model& model);

}  // namespace verisq::verify
