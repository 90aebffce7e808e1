/// The hull of samples, which only decides where to bisect: its rounding errors make no enclosure wrong.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "verify/numbers/interval.hpp"

namespace verisq::stance {

class SampledHull {
 public:
  void add(const std::optional<Eigen::VectorXd>& sample) {
    if (!sample) return;
    lowest_ = is_empty() ? *sample : lowest_.cwiseMin(*sample);
    highest_ = is_empty() ? *sample : highest_.cwiseMax(*sample);
  }

  [[nodiscard]] bool is_empty() const { return highest_.size() == 0; }

  // Preconditions of the following: the hull is not empty.

  [[nodiscard]] double lowest(Eigen::Index component) const { return lowest_[component]; }
  [[nodiscard]] double highest(Eigen::Index component) const { return highest_[component]; }
  [[nodiscard]] double width(Eigen::Index component) const { return highest_[component] - lowest_[component]; }
  [[nodiscard]] double largest_magnitude() const {
    return std::fmax(lowest_.cwiseAbs().maxCoeff(), highest_.cwiseAbs().maxCoeff());
  }

  /// How far an enclosure of the component sticks out.
  [[nodiscard]] double excess(Eigen::Index component, const verify::Interval& enclosure) const {
    return std::fmax(enclosure.upper() - highest_[component], lowest_[component] - enclosure.lower());
  }

 private:
  Eigen::VectorXd lowest_, highest_;
};

}  // namespace verisq::stance
