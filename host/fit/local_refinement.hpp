/// Climbs from a candidate to the nearest maximum of the objective, without regard to the limit of penetration.
#pragma once

#include "host/fit/candidate_space.hpp"
#include "host/fit/nlopt_maximiser.hpp"
#include "host/fit/search_watch.hpp"
#include "host/fit/side_requirements.hpp"

namespace verisq::fit_search {

struct Ranked {
  Parameters parameters;
  double objective;  ///< rank by a landscape
};

/// An objective to climb: over every stride-th point.
struct Landscape {
  Fitness fitness;
  std::size_t stride;
  double weight;  ///< of the points that take part, in all

  /// So that whoever lies where it has to ranks before all others: the objective is at least 0, at most the weight.
  [[nodiscard]] double rank(double objective, std::size_t misplaced) const {
    return objective - weight * static_cast<double>(misplaced);
  }
};

/// The fitness with its scale multiplied: wide enough, every point of the cavity tells where to go, and F has fewer
/// maxima.
[[nodiscard]] Fitness widened(const Fitness& fitness, double factor);

[[nodiscard]] Ranked refined(const CandidateSpace& space, CandidateEvaluator& evaluator, const SideRequirements& sides,
                             const Landscape& landscape, const Parameters& start, const StoppingCriteria& stop,
                             SearchWatch& watch);

}  // namespace verisq::fit_search
