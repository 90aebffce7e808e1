/// The distance of two solids by branch and bound over pairs of cubes (docs/mathematics.md §10, §11).
#pragma once

#include <optional>

#include "verify/sets/distance_of_balls.hpp"
#include "verify/sets/solid_pair_cells.hpp"
#include "verisq/model_search.hpp"

namespace verisq::verify {

/// As ModelSearch says, which this does the work of.
class PairSearch {
 public:
  PairSearch(const Model& a, const Model& b);

  [[nodiscard]] SearchedDistance operator()(const Pose& pose, const SearchOptions& options) const;

 private:
  SearchSolid a_;
  SearchSolid b_;
  // Of balls the distances of their centres bound the distance, however much of the other solid is about as near.
  std::optional<BallUnion> balls_of_a_;
  std::optional<BallUnion> balls_of_b_;
  std::optional<SolidDistance> distance_from_b_;
  std::optional<SolidDistance> distance_from_a_;
};

}  // namespace verisq::verify
