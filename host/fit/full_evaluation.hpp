/// A candidate at every point of the cavity: the objective, the distances, whether the limit is respected.
#pragma once

#include "host/fit/candidate_space.hpp"
#include "host/fit/incumbent.hpp"
#include "host/fit/requirements.hpp"
#include "host/fit/search_watch.hpp"
#include "verisq/cavity.hpp"

namespace verisq::fit_search {

/// Remembers the last candidate, because optimisers ask for objective and constraints one after the other, and offers
/// each to the incumbent of its own. Depths are those of PointDistance: inside an overlap of primitives the union may
/// be deeper.
class FullEvaluation {
 public:
  struct Result {
    Evaluation evaluation;  ///< what size and contact add to the objective included
    std::vector<PointDistance> distances;
    double deepest_penetration;
    bool within_limit;
  };

  FullEvaluation(const CandidateSpace& space, CandidateEvaluator& evaluator, const Cavity& cavity,
                 const Requirements& asked, const Fitness& fitness, double penetration_limit, SearchWatch& watch);

  const Result& at(std::span<const double> parameters);

  [[nodiscard]] const CandidateSpace& space() const { return space_; }
  [[nodiscard]] const Cavity& cavity() const { return cavity_; }
  [[nodiscard]] const Requirements& asked() const { return asked_; }
  [[nodiscard]] const Fitness& fitness() const { return fitness_; }
  [[nodiscard]] double penetration_limit() const { return penetration_limit_; }
  [[nodiscard]] SearchWatch& watch() { return watch_; }
  /// The best of all that were evaluated.
  [[nodiscard]] const std::optional<Found>& best() const { return incumbent_.best(); }
  /// The best of those since then.
  void begin_anew() { latest_ = {}; }
  [[nodiscard]] const std::optional<Found>& best_since() const { return latest_.best(); }

 private:
  const CandidateSpace& space_;
  CandidateEvaluator& evaluator_;
  const Cavity& cavity_;
  const Requirements& asked_;
  Fitness fitness_;
  double penetration_limit_;
  SearchWatch& watch_;
  Incumbent incumbent_;
  Incumbent latest_;
  Parameters parameters_;
  Result result_;
};

}  // namespace verisq::fit_search
