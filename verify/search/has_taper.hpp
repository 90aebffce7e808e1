/// Models with tapered primitives.
#pragma once

#include <algorithm>

#include "verisq/model.hpp"

namespace verisq::verify {

/// Whether a primitive has a taper that changes anything.
[[nodiscard]] inline bool has_taper(const Model& model) {
  return std::ranges::any_of(model.primitives, [](const Primitive& p) { return is_tapered(p.superquadric); });
}

}  // namespace verisq::verify
