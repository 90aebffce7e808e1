/// Boxes of a range of poses by halvings of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace verisq::verify {

/// A translation's three parameters, then a rotation vector's.
constexpr std::size_t pose_parameters = 6;

/// Divisions of one direction: beyond, boxes are as small as roundings. Shares of the range are exact in binary64.
constexpr std::uint8_t most_divisions = 30;

/// In each direction part `index` of 2^`level`.
struct PoseCell {
  std::array<std::uint32_t, pose_parameters> index{};
  std::array<std::uint8_t, pose_parameters> level{};

  [[nodiscard]] bool can_be_halved(std::size_t direction) const { return level[direction] < most_divisions; }

  /// The lower half first.
  [[nodiscard]] std::array<PoseCell, 2> halves(std::size_t direction) const {
    PoseCell low = *this;
    ++low.level[direction];
    low.index[direction] *= 2;
    PoseCell high = low;
    ++high.index[direction];
    return {low, high};
  }
};

}  // namespace verisq::verify
