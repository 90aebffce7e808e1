/// How many queries a map works on at a time.
#pragma once

#include <algorithm>
#include <cstddef>

namespace verisq {

/// Enough to keep all processors busy; few enough that progress, Ctrl-C and limits are felt soon, whether a proof takes
/// microseconds or, by a search, milliseconds.
class ChunkPace {
 public:
  /// Begins with a few.
  ChunkPace() = default;
  /// Begins with `most`, for who is quick as a rule, and comes back to them.
  explicit ChunkPace(std::size_t most) : largest_(most), size_(most) {}

  [[nodiscard]] std::size_t size() const { return size_; }

  /// To be called with the time that each chunk of this size took.
  void took(double seconds) {
    if (seconds < shortest_seconds) size_ = std::min(2 * size_, largest_);
    if (seconds > longest_seconds) size_ = std::max(size_ / 2, smallest);
  }

 private:
  static constexpr std::size_t smallest = 16;
  static constexpr double shortest_seconds = 0.1;
  static constexpr double longest_seconds = 0.4;

  std::size_t largest_ = std::size_t{1} << 16U;
  std::size_t size_ = 64;
};

}  // namespace verisq
