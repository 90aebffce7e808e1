/// The objective as a function of parameters, handed to the optimiser.
#include "host/fit/local_refinement.hpp"

#include <algorithm>

#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

Fitness widened(const Fitness& fitness, double factor) {
  return {fitness.target, fitness.scale * factor, fitness.serves};
}

Ranked refined(const CandidateSpace& space, CandidateEvaluator& evaluator, const Requirements& asked,
               const Landscape& landscape, const Parameters& start, const StoppingCriteria& stop, SearchWatch& watch) {
  Ranked best{start, -infinity};
  std::vector<Evaluation> evaluations;
  const auto objective = [&](std::span<const double> parameters, std::span<double> gradient) {
    const Candidate candidate = space.candidate(parameters);
    evaluator.evaluate({&candidate, 1}, landscape.fitness, {}, landscape.stride, evaluations);
    watch.count(1);
    const Evaluation& found = evaluations.front();
    std::ranges::copy(space.gradient(parameters, found.pose_gradient, found.size_gradient), gradient.begin());
    const double rank = landscape.rank(found.objective, asked.broken(parameters, candidate));
    if (rank > best.objective) best = {{parameters.begin(), parameters.end()}, rank};
    return found.objective;
  };
  Parameters units = space.units();
  for (double& unit : units) unit *= landscape.fitness.scale;
  const MaximisationProblem problem{.lower = space.lower(),
                                    .upper = space.upper(),
                                    .units = units,
                                    .typical = landscape.weight,
                                    .objective = objective,
                                    .interrupted = [&] { return watch.interrupted(); }};
  (void)maximised(problem, start, stop);  // the best evaluation is kept above
  return best;
}

}  // namespace verisq::fit_search
