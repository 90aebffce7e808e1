/// How many queries a map works on at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <verisq/map.hpp>

namespace verisq {

/// Enough to keep all processors busy; few enough that progress, Ctrl-C and limits are felt soon, whether a proof takes
/// microseconds or, by a search, milliseconds.
class ChunkPace {
 public:
  /// Begins with a few.
  ChunkPace() = default;
  /// Begins with `most`, for who is quick as a rule, and comes back to them.
  explicit ChunkPace(std::size_t most) : largest_(most), size_(most) {}
  /// Whole blocks (see rows_per_block) at every time, so that no row depends on how fast others were; begins with
  /// `size`.
  [[nodiscard]] static ChunkPace of_blocks(std::size_t size, std::size_t most) {
    ChunkPace pace(most);
    pace.size_ = size;
    pace.smallest_ = rows_per_block;
    return pace;
  }

  [[nodiscard]] std::size_t size() const {
    return smallest_ < rows_per_block ? size_ : std::max(size_ - size_ % rows_per_block, smallest_);
  }

  /// To be called with the time that each chunk of this size took.
  void took(double seconds) {
    if (seconds < shortest_seconds) size_ = std::min(2 * size_, largest_);
    if (seconds > longest_seconds) size_ = std::max(size_ / 2, smallest_);
  }

 private:
  static constexpr double shortest_seconds = 0.1;
  static constexpr double longest_seconds = 0.4;

  std::size_t largest_ = std::size_t{1} << 16U;
  std::size_t size_ = 64;
  std::size_t smallest_ = 16;
};

}  // namespace verisq
