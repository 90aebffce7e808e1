/// What distances say together: sums, fitness, shares.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verisq/clearance.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// Distances in the order of the points; the report is of those added so far.
class ClearanceSum {
 public:
  /// Spans must outlive the sum. Precondition: `area_of`, one a point, indices of `areas`.
  ClearanceSum(std::span<const Area> areas, std::span<const std::uint32_t> area_of, const Fitness& fitness,
               double penetration_limit);

  /// Of the next point. Precondition: in all no more than there are points.
  void add(const Enclosure& distance);
  void add(std::span<const MapResult> rows);

  /// All but the summary of the map.
  [[nodiscard]] Clearance report() const;

 private:
  /// Of one area, by its points.
  struct Distances {
    verify::PreciseInterval sum{0};
    std::vector<double> lower;
    std::vector<double> upper;

    void add(const Enclosure& distance);
    void tell(AreaClearance& area) const;
  };

  std::span<const std::uint32_t> area_of_;
  Fitness fitness_;
  double penetration_limit_;
  std::size_t points_ = 0;
  /// Of terms of either sign: 127 bits, because the roundings of thousands of binary64 additions would add up.
  verify::PreciseInterval objective_{0};
  Clearance clearance_{};
  std::vector<Distances> distances_;  ///< by area
};

}  // namespace verisq
