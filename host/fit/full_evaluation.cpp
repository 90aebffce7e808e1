/// Distances of all points, summed up.
#include "host/fit/full_evaluation.hpp"

#include <algorithm>

#include "host/fit/evaluation_sum.hpp"

namespace verisq::fit_search {

FullEvaluation::FullEvaluation(const CandidateSpace& space, CandidateEvaluator& evaluator, const Cavity& cavity,
                               const Requirements& asked, const Fitness& fitness, double penetration_limit,
                               SearchWatch& watch)
    : space_(space),
      evaluator_(evaluator),
      cavity_(cavity),
      asked_(asked),
      fitness_(fitness),
      penetration_limit_(penetration_limit),
      watch_(watch),
      result_{} {}

const FullEvaluation::Result& FullEvaluation::at(std::span<const double> parameters) {
  if (std::ranges::equal(parameters, parameters_)) return result_;
  parameters_.assign(parameters.begin(), parameters.end());
  const Candidate candidate = space_.candidate(parameters);
  evaluator_.distances(candidate, result_.distances);
  watch_.count(1);
  EvaluationSum sum(fitness_, candidate);
  for (std::size_t i = 0; i < cavity_.points.size(); ++i)
    sum.add(cavity_.points[i], cavity_.areas[cavity_.area_of[i]].weight, result_.distances[i]);
  result_.evaluation = sum.result();
  result_.deepest_penetration = std::max(-result_.evaluation.smallest_distance, 0.0);
  result_.within_limit = -result_.evaluation.smallest_distance <= penetration_limit_;
  const double broken = asked_.broken(parameters_, candidate);
  if (result_.within_limit && broken == 0.0) watch_.found(result_.evaluation.objective);
  asked_.size.add_to(result_.evaluation, candidate);
  const double apart = asked_.contacts.add_to(result_.evaluation, candidate);
  const Found found{.parameters = parameters_,
                    .objective = result_.evaluation.objective,
                    .deepest_penetration = result_.deepest_penetration,
                    .within_limit = result_.within_limit,
                    .broken = broken,
                    .apart = apart};
  incumbent_.offer(found);
  latest_.offer(found);
  return result_;
}

}  // namespace verisq::fit_search
