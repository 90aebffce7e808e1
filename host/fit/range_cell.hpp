/// Boxes of a range of poses that are searched, by halvings of it.
#pragma once

#include <array>
#include <cstdint>

#include "verify/best_fit/pose_cell.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

struct RangeCell {
  verify::PoseCell poses;
  double bound = infinity;   ///< of the objective in it
  std::uint8_t widest = 0;   ///< direction to be divided next
  std::uint8_t implant = 0;  ///< in the series
  std::uint32_t node = 0;    ///< of the implant's tree of halvings

  /// Their nodes follow each other from `first` on.
  [[nodiscard]] std::array<RangeCell, 2> halves(std::uint32_t first) const {
    std::array<RangeCell, 2> halves{*this, *this};
    const auto [low, high] = poses.halves(widest);
    halves[0].poses = low;
    halves[0].node = first;
    halves[1].poses = high;
    halves[1].node = first + 1;
    return halves;
  }
};

}  // namespace verisq::fit_search
