/// In which order searches look at primitives: the nearest bounding sphere first, so that far ones are never proven.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace verisq::verify {

/// One of several queries that may decide a distance.
struct Candidate {
  double sphere_bound;  ///< lower bound of its distance
  std::size_t index;
};

/// Those with indices below `count`, `sphere_bound(index)` rising.
template <class SphereBound>
[[nodiscard]] std::vector<Candidate> nearest_spheres_first(std::size_t count, const SphereBound& sphere_bound) {
  std::vector<Candidate> order;
  order.reserve(count);
  for (std::size_t i = 0; i < count; ++i) order.push_back({sphere_bound(i), i});
  std::ranges::sort(order, {}, &Candidate::sphere_bound);
  return order;
}

}  // namespace verisq::verify
