/// Shares of the cavity's area that have to be in contact, as a term of the search's objective.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "host/fit/candidate_evaluation.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {

/// A share is a sum over points: each counts from 1 to 0 as its distance grows past the contact's, smoothly within a
/// tenth of the fitness' scale to either side. What is missing costs more than F could gain by it.
class ContactAim {
 public:
  ContactAim() = default;
  /// `weight`: of all points of the cavity. The contacts must outlive it.
  ContactAim(std::span<const FitContact> contacts, double scale, double weight, const MakeEvaluator& make_evaluator);

  /// The same with wider steps: points farther off tell where to go.
  [[nodiscard]] ContactAim widened(double factor) const;
  [[nodiscard]] bool asks() const { return !contacts_.empty(); }

  /// What all contact that is missing costs at most.
  [[nodiscard]] double most() const { return cost_ * static_cast<double>(contacts_.size()); }
  /// The cost, negative, and its derivatives. Returns the shares that are missing, of all ranges.
  double add_to(Evaluation& evaluation, const Candidate& candidate) const;

 private:
  struct Contact {
    const FitContact* asked;
    double weight;  ///< of all its points
    std::shared_ptr<CandidateEvaluator> evaluator;
  };

  [[nodiscard]] double share(const Contact& contact, std::span<const PointDistance> distances) const;
  void add_derivatives(Evaluation& evaluation, const Contact& contact, double by_share, const Candidate& candidate,
                       std::span<const PointDistance> distances) const;

  std::vector<Contact> contacts_;
  double reach_ = 0.0;
  double cost_ = 0.0;
};

}  // namespace verisq::fit_search
