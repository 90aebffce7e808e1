/// How much a device is given at a time: no more than it does within a tenth of a second.
#pragma once

#include <algorithm>
#include <cstddef>

namespace verisq::device {

/// A graphics processor cannot be interrupted, and one that drives a display is reset when a launch takes seconds; the
/// fastest and the slowest are a thousand times apart. So it begins with little and is given more while that is done
/// soon. Sizes are whole vectors of queries, and so many that a device has work for all its processors.
class LaunchPace {
 public:
  /// `largest`: what the buffers hold.
  explicit LaunchPace(std::size_t largest, std::size_t first = usual_first)
      : largest_(largest), size_(std::min(largest, first)) {}

  [[nodiscard]] std::size_t size() const { return size_; }

  /// To be called with how long the kernels of each chunk ran.
  void took(std::size_t queries, double seconds) {
    if (seconds > longest_seconds) size_ = std::min(size_, std::max(whole(queries / 2), std::min(largest_, smallest)));
    if (seconds < shortest_seconds && queries >= size_) size_ = std::min(2 * size_, largest_);
  }

 private:
  static constexpr std::size_t usual_first = std::size_t{1} << 14U;
  static constexpr std::size_t smallest = std::size_t{1} << 10U;
  static constexpr double shortest_seconds = 0.04;
  static constexpr double longest_seconds = 0.1;

  static std::size_t whole(std::size_t queries) { return queries - queries % smallest; }

  std::size_t largest_;
  std::size_t size_;
};

}  // namespace verisq::device
