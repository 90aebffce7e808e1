/// How well distances have to be known that say what is in contact.
#pragma once

#include <algorithm>
#include <limits>

#include "verisq/model.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {

/// Finer for solids that are told at once.
[[nodiscard]] inline double contact_tolerance(const Model& model) {
  constexpr double fine = 1e-6;  // of the bounding radius
  constexpr double coarse = 1e-3;
  const double share = is_union_of_convex(model) ? fine : coarse;
  return std::min(share * bounding_radius(model), std::numeric_limits<double>::max());
}

}  // namespace verisq
