/// The distance of two solids by branch and bound over pairs of cubes (docs/mathematics.md §10, §11).
#pragma once

#include "verify/sets/solid_pair_cells.hpp"
#include "verisq/model_search.hpp"

namespace verisq::verify {

/// As ModelSearch says, which this does the work of.
[[nodiscard]] SearchedDistance solid_pair_distance(const SearchSolid& a, const SearchSolid& b, const Pose& pose,
                                                   const SearchOptions& options);

}  // namespace verisq::verify
