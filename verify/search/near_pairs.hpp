/// Which pairs of primitives may be the nearest of two models, at a price of nanoseconds each.
#pragma once

#include <cstdint>
#include <vector>

#include "verify/pairs/posed_pairs.hpp"

namespace verisq::verify {

struct PrimitivePair {
  std::uint32_t a;
  std::uint32_t b;
};

struct NearPairs {
  std::vector<PrimitivePair> pairs;  ///< at least one
  double others;                     ///< proven: all others are at least so far apart
};

/// Those whose bounding spheres are not farther apart than the nearest centres, which lie in their primitives.
[[nodiscard]] NearPairs near_pairs(const PosedPairs& pairs);

}  // namespace verisq::verify
