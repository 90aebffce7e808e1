/// Boxes of parameters and their divisions: what analyses by bisection share.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <deque>
#include <iterator>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "verify/numbers/interval.hpp"

namespace verisq::stance {

/// An interval for each parameter of a model.
using Box = std::vector<verify::Interval>;

/// A number of the interval, near its middle.
[[nodiscard]] inline double middle_of(const verify::Interval& side) {
  return std::clamp(0.5 * side.lower() + 0.5 * side.upper(), side.lower(), side.upper());
}

/// A point of the box, near its middle.
[[nodiscard]] inline std::vector<double> middle_of(const Box& box) {
  std::vector<double> middle;
  middle.reserve(box.size());
  for (const verify::Interval& side : box) middle.push_back(middle_of(side));
  return middle;
}

/// Corners of the box's sides `variables`, where extremes of nearly monotone functions lie; the middle of all other
/// sides, and of the variables from the ninth on.
[[nodiscard]] inline std::vector<std::vector<double>> corners_of(const Box& box,
                                                                 std::span<const std::uint32_t> variables) {
  constexpr std::size_t most_variables = 8;
  const std::size_t count = std::min(variables.size(), most_variables);
  std::vector<std::vector<double>> corners(std::size_t{1} << count, middle_of(box));
  for (std::size_t corner = 0; corner < corners.size(); ++corner) {
    for (std::size_t k = 0; k < count; ++k) {
      const verify::Interval& side = box[variables[k]];
      corners[corner][variables[k]] = ((corner >> k) & 1U) != 0 ? side.upper() : side.lower();
    }
  }
  return corners;
}

/// A part of a box that was bisected.
struct BoxPart {
  Box box;
  std::vector<std::uint32_t> halvings;  ///< of each variable

  static BoxPart whole(const Box& box, std::size_t variables) {
    return {box, std::vector<std::uint32_t>(variables, 0)};
  }

  /// Of the whole: a power of 2, exact.
  [[nodiscard]] double share() const {
    double share = 1.0;
    for (const std::uint32_t count : halvings) share = std::ldexp(share, -static_cast<int>(count));
    return share;
  }
};

/// The bisections of a box along some of its sides, each to a finest part.
class BoxDivision {
 public:
  /// Precondition: `finest` > 0, the number of parts of a side, rounded up to a power of 2.
  BoxDivision(std::span<const std::uint32_t> variables, std::uint32_t finest)
      : variables_(variables.begin(), variables.end()),
        most_halvings_(static_cast<std::uint32_t>(std::bit_width(finest - 1))) {}

  [[nodiscard]] bool is_divisible(const BoxPart& part, std::size_t variable) const {
    const verify::Interval& side = part.box[variables_[variable]];
    const double middle = middle_of(side);
    return part.halvings[variable] < most_halvings_ && side.lower() < middle && middle < side.upper();
  }

  /// The variable that has been halved least; none where all are as fine as they may be.
  [[nodiscard]] std::optional<std::size_t> least_halved(const BoxPart& part) const {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < part.halvings.size(); ++k) {
      if (is_divisible(part, k) && (!best || part.halvings[k] < part.halvings[*best])) best = k;
    }
    return best;
  }

  [[nodiscard]] std::array<BoxPart, 2> halves(const BoxPart& part, std::size_t variable) const {
    const std::uint32_t i = variables_[variable];
    const verify::Interval side = part.box[i];
    std::array<BoxPart, 2> halves{part, part};
    halves[0].box[i] = verify::Interval(side.lower(), middle_of(side));
    halves[1].box[i] = verify::Interval(middle_of(side), side.upper());
    for (BoxPart& half : halves) ++half.halvings[variable];
    return halves;
  }

 private:
  std::vector<std::uint32_t> variables_;
  std::uint32_t most_halvings_;
};

/// The sum of the shares of some parts, rounded, which must not hide that there are others.
[[nodiscard]] inline double share_beside_others(double share, bool others) {
  return others ? std::fmin(share, std::nextafter(1.0, 0.0)) : share;
}

/// Takes the first items: so many as keep all cores busy between two reports of progress.
template <class Item>
[[nodiscard]] std::vector<Item> take_batch(std::deque<Item>& items) {
  constexpr std::size_t most = 16;
  const auto end = items.begin() + static_cast<std::ptrdiff_t>(std::min(most, items.size()));
  std::vector<Item> batch(std::make_move_iterator(items.begin()), std::make_move_iterator(end));
  items.erase(items.begin(), end);
  return batch;
}

/// Calls examine(item) for each item, on all cores: each by itself, so that the result does not depend on their number.
template <class Item, class Examine>
void examine_on_all_cores(std::vector<Item>& items, const Examine& examine) {
  if (items.empty()) return;
  const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, items.size());
  std::vector<std::jthread> workers;
  for (std::size_t first = 0; first < threads; ++first) {
    workers.emplace_back([&items, &examine, first, threads] {
      for (std::size_t i = first; i < items.size(); i += threads) examine(items[i]);
    });
  }
}

}  // namespace verisq::stance
