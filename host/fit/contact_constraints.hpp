/// Shares of the cavity's area that have to be in contact, for the search.
#pragma once

#include <span>
#include <vector>

#include "host/fit/candidate_space.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {

/// A share is a sum over points: each counts from 1 to 0 as its distance grows past the contact's, smoothly within a
/// tenth of the fitness' scale to either side.
class ContactConstraints {
 public:
  ContactConstraints() = default;
  /// Both must outlive it.
  ContactConstraints(std::span<const FitContact> contacts, double scale);

  /// One for each end of a range that can be missed.
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  /// How far each is within its end, in tenths of the area: negative beyond.
  [[nodiscard]] std::vector<double> slack(std::span<const PointDistance> distances) const;
  /// What is missing, of all.
  [[nodiscard]] double violation(std::span<const PointDistance> distances) const;
  /// Derivatives of the slacks by the parameters, row by row.
  void write_jacobian(const CandidateSpace& space, std::span<const double> parameters, std::span<const Point> points,
                      std::span<const PointDistance> distances, std::span<double> jacobian) const;

 private:
  struct Row {
    const FitContact* contact;
    bool upper;
    double weight;  ///< of all its points
  };

  std::vector<Row> rows_;
  double reach_ = 0.0;
};

}  // namespace verisq::fit_search
