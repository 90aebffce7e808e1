/// Lets the size of an implant count for more than F does.
#pragma once

#include <span>

#include "host/fit/candidate_evaluation.hpp"
#include "host/fit/candidate_space.hpp"

namespace verisq::fit_search {

class SizeAim {
 public:
  /// Sizes do not count.
  SizeAim() = default;
  /// From the least sizes to the largest, the objective gains a hundred times the weight of all points: F, which is at
  /// most that weight, decides where sizes differ by less than about a hundredth of their range.
  SizeAim(const CandidateSpace& space, double weight);

  /// What it adds at most.
  [[nodiscard]] double most() const { return most_; }
  /// What it adds for these sizes.
  [[nodiscard]] double value(std::span<const Primitive> primitives) const;
  /// The value and its derivatives by semi-axes.
  void add_to(Evaluation& evaluation, const Candidate& candidate) const;

 private:
  double least_size_ = 0.0;
  double most_ = 0.0;
  double per_size_ = 0.0;
};

}  // namespace verisq::fit_search
