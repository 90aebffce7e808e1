/// Climbs from a candidate to the nearest maximum of the objective, without regard to the limit of penetration.
#pragma once

#include "host/fit/candidate_space.hpp"
#include "host/fit/nlopt_maximiser.hpp"
#include "host/fit/requirements.hpp"
#include "host/fit/search_watch.hpp"

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

  /// A sample on the wrong side, or a unit that is missing, costs what all points are worth at best.
  [[nodiscard]] double rank(double objective, double broken) const { return objective - weight * broken; }
};

/// The fitness with its scale multiplied: wide enough, every point of the cavity tells where to go, and F has fewer
/// maxima.
[[nodiscard]] Fitness widened(const Fitness& fitness, double factor);

[[nodiscard]] Ranked refined(const CandidateSpace& space, CandidateEvaluator& evaluator, const Requirements& asked,
                             const Landscape& landscape, const Parameters& start, const StoppingCriteria& stop,
                             SearchWatch& watch);

}  // namespace verisq::fit_search
