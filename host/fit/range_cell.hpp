/// Boxes of a range of poses by halvings of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

/// Of one implant, in each direction part `index` of 2^`level`.
struct RangeCell {
  double bound = infinity;  ///< of the objective in it
  std::array<std::uint32_t, 6> index{};
  std::array<std::uint8_t, 6> level{};
  std::uint8_t widest = 0;   ///< direction to be divided next
  std::uint8_t implant = 0;  ///< in the series
  std::uint32_t node = 0;    ///< of the implant's tree of halvings

  [[nodiscard]] std::array<RangeCell, 2> halves() const {
    RangeCell low = *this;
    ++low.level[widest];
    low.index[widest] *= 2;
    RangeCell high = low;
    ++high.index[widest];
    return {low, high};
  }
};

}  // namespace verisq::fit_search
