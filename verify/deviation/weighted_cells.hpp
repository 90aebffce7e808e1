/// Mean and percentiles of a distance over cells of which only bounds are known.
#pragma once

#include <span>
#include <vector>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// A part of what is weighed: all distances on it lie in `range`, their mean in `mean`.
struct WeightedCell {
  Enclosure weight;  ///< at least 0, finite
  Enclosure range;   ///< at least 0, as `mean`
  Enclosure mean;
};

/// Of all cells together, by weight. Precondition: at least one cell, and a total weight that is not proven above 0 is
/// allowed: then the hull of all ranges.
[[nodiscard]] Enclosure mean_of(std::span<const WeightedCell> cells);

/// Sorts the ends once, for any number of percentiles.
class Distribution {
 public:
  /// Precondition: at least one cell.
  explicit Distribution(std::span<const WeightedCell> cells);

  /// Of the least v such that the part of the weight with distances up to v is at least `percent`/100 of all.
  /// Precondition: 0 < percent <= 100.
  [[nodiscard]] Enclosure percentile(double percent) const;

 private:
  struct End {
    double distance;
    double weight;
  };

  [[nodiscard]] static double first_at_least(std::span<const End> ends, double weight, bool up);

  std::vector<End> lower_;  ///< sorted; with the largest weight that each may have
  std::vector<End> upper_;  ///< sorted; with the smallest
  Enclosure total_{0.0, 0.0};
};

}  // namespace verisq::verify
