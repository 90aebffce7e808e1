/// What is asked of the pose itself, as the search sees it: how much is left to the ends of each range.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host/fit/candidate_space.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {

/// A row for every finite end of a constraint's range.
class PoseConstraints {
 public:
  /// Of one implant of the series. Space and constraints must outlive it.
  PoseConstraints(const CandidateSpace& space, std::span<const FitConstraint> constraints, std::size_t implant);

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  /// At least 0 where the end is kept, in the constraint's units.
  [[nodiscard]] std::vector<double> slack(std::span<const double> parameters) const;
  /// Derivatives of the slack by all parameters, row by row: by central differences.
  [[nodiscard]] std::vector<double> jacobian(std::span<const double> parameters) const;
  /// The sum of what is missing.
  [[nodiscard]] double violation(std::span<const double> parameters) const;

 private:
  struct Row {
    const FitConstraint* constraint;
    bool upper;
  };

  const CandidateSpace& space_;
  std::size_t implant_;
  std::vector<Row> rows_;
};

}  // namespace verisq::fit_search
