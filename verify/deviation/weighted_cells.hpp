/// Mean and percentiles of a distance over cells of which only bounds are known (docs/mathematics.md §20).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "verisq/area_within.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// On a triangle, with the affine function of these values at its corners: d, or d² where `squared`, is at least that
/// function + below and at most that + above.
struct AffineBounds {
  std::array<double, 3> values{};  ///< in ascending order: which corner is which does not matter
  double below = -infinity;
  double above = infinity;
  bool squared = false;
};

/// A part of what is weighed: all distances on it lie in `range`, their mean in `mean`.
struct WeightedCell {
  Enclosure weight;  ///< at least 0, finite
  Enclosure range;   ///< at least 0, as `mean`
  Enclosure mean;
  AffineBounds affine = {};  ///< of a triangle weighed by area
};

/// Which part of the cell's weight has distances of at most `distance`: enclosed, in [0, 1].
[[nodiscard]] Enclosure part_up_to(const WeightedCell& cell, double distance);

/// Of all cells together, by weight, whichever of its interval each is; where the total is not proven above 0, the hull
/// of all ranges. Precondition: at least one cell.
[[nodiscard]] Enclosure mean_of(std::span<const WeightedCell> cells);

/// Which part of all weight, whichever of its interval each is, has distances of at most `distance`: in [0, 1].
/// Precondition: at least one cell.
[[nodiscard]] Enclosure share_up_to(std::span<const WeightedCell> cells, double distance);

/// How much weight that is.
[[nodiscard]] Enclosure weight_up_to(std::span<const WeightedCell> cells, double distance);

/// Both, and all weight, as areas. Nothing but zeros of no cells.
[[nodiscard]] AreaWithin area_within(std::span<const WeightedCell> cells, double distance);

/// Chooses the widest of (width, index), until the others leave no more than a share of what is allowed; sorts them.
/// Nothing is proven by this.
void choose_widest(std::vector<std::pair<double, std::size_t>>& widths, double allowed, std::vector<bool>& chosen);

/// Sorts the ends once, for any number of percentiles. The cells must outlive it.
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

  /// Cells that may lie on either side of a distance between two others, and the weight of what lies below all these.
  struct Near {
    std::vector<const WeightedCell*> cells;
    Enclosure before{0.0, 0.0};
  };

  [[nodiscard]] static double first_at_least(std::span<const End> ends, double weight, bool up);
  [[nodiscard]] Near near(const Enclosure& bracket) const;
  [[nodiscard]] static Enclosure weight_up_to(const Near& near, double distance);
  [[nodiscard]] Enclosure narrowed(const Enclosure& percentile, const Enclosure& wanted) const;
  [[nodiscard]] Enclosure balance(double distance, const Enclosure& part) const;
  [[nodiscard]] Enclosure balanced(const Enclosure& percentile, const Enclosure& part) const;

  std::span<const WeightedCell> cells_;
  std::vector<End> lower_;  ///< sorted; with the largest weight that each may have
  std::vector<End> upper_;  ///< sorted; with the smallest
  Enclosure total_{0.0, 0.0};
};

}  // namespace verisq::verify
