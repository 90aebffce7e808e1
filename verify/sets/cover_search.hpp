/// Looks for covers (docs/mathematics.md §28): of a neighbourhood as large as one is found for.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "verify/proof/empty_neighbourhood.hpp"

namespace verisq::verify {

/// A neighbourhood of some radius that is proven to hold nothing.
struct EmptyRadius {
  double radius;
  std::vector<Normal> normals;  ///< of the primitives that have the whole neighbourhood on one side
  std::vector<bool> cover;
};

/// Nothing where it takes more cells than `most`, or `interrupted` says so.
[[nodiscard]] std::optional<std::vector<bool>> cover_of(const EmptyNeighbourhood& neighbourhood, std::size_t most,
                                                        const std::function<bool()>& interrupted);

/// Of one point, triangle or body.
struct CoverQuestion {
  std::function<std::vector<Normal>(double radius)> telling;  ///< normals as above
  std::function<EmptyNeighbourhood(double radius, const std::vector<Normal>&)> neighbourhood;
  std::size_t most_cells = 3000;
};

/// A radius a little smaller than `distance`, that of a witness: by rounding, by up to `tolerance`, or by more where
/// the cover would have too many cells. Nothing where there is none, or `interrupted` says so.
[[nodiscard]] std::optional<EmptyRadius> empty_radius(const CoverQuestion& question, double distance, double tolerance,
                                                      const std::function<bool()>& interrupted);

}  // namespace verisq::verify
