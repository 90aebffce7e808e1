/// Joint statements of many distances: sums, fitness, shares.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verisq/clearance.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// Distances in the order of the points; the report covers the distances added so far.
class ClearanceSum {
 public:
  /// Spans must outlive the sum. Precondition: `area_of` has one index of `areas` for each point.
  ClearanceSum(std::span<const Area> areas, std::span<const std::uint32_t> area_of, const Fitness& fitness,
               double penetration_limit);

  /// Adds the distance of the next point. Precondition: in all no more distances than points.
  void add(const Enclosure& distance);
  void add(std::span<const MapResult> rows);

  /// The report, but for the summary of the map.
  [[nodiscard]] Clearance report() const;

 private:
  /// The distances of one area's points.
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
  /// A sum of terms of either sign: 127 bits, because the roundings of thousands of binary64 additions would add up.
  verify::PreciseInterval objective_{0};
  Clearance clearance_{};
  std::vector<Distances> distances_;  ///< by area
};

}  // namespace verisq
