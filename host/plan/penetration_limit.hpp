/// Candidates at every point of the cavity, and searches that keep to the limit of penetration, at points and between
/// them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/plan/candidate_evaluation.hpp"
#include "host/plan/pose_search.hpp"
#include "host/plan/requirements.hpp"
#include "verisq/clearance.hpp"
#include "verisq/fit.hpp"
#include "verisq/mesh.hpp"

namespace verisq::fit_search {

// The evaluation of a candidate at every point of the cavity: the objective, the distances, and whether the limit is
// kept.

/// Remembers the last candidate, because optimisers call objective and constraints one after the other. Offers each
/// candidate to its own incumbent. Depths are those of PointDistance: inside an overlap of primitives the union may be
/// deeper.
class FullEvaluation {
 public:
  struct Result {
    Evaluation evaluation;  ///< including the terms that size and contact add to the objective
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

// Climbs to the nearest maximum of the objective among the candidates that no point of the cavity enters too deep.

/// A semi-infinite program solved by constraint generation. It finds an optimum under the constraints of the worst
/// points, adds the points that the optimum violates, and repeats until there are none. A small margin, within which
/// the optimiser may err, keeps its answer within the limit. Every evaluated candidate is offered to the incumbent. The
/// end of the search lies beyond the limit if no candidate nearby keeps it.
void refine_within_limit(FullEvaluation& cavity, const Parameters& start);

/// Moves a candidate beyond the limit to a near one within it, if there is one, and does nothing else.
void restore_within_limit(FullEvaluation& cavity, const Parameters& start);

// Points between those of the cavity, which an implant is kept off during the search.

/// The cavity with points of weight 0 added, on a grid over each triangle of at most the given spacing. The spacing is
/// wider if there would be more than the given number of points. Their area is the last; nothing changes if there are
/// no triangles. Precondition: spacing > 0.
[[nodiscard]] Cavity with_surface_points(const Cavity& cavity, double spacing, std::size_t most_points);

/// Points of a triangle about one of its points, denser near that point: a patch that an implant can hardly slip off.
/// The first is the point itself. `spacing` is that of the outer ones.
[[nodiscard]] std::vector<Point> patch(const Triangle& triangle, const Point& middle, double spacing);

// Keeps the implant from cutting the surface between the points of the cavity.

/// Constraint generation once more. A search nearby keeps off a grid of points, `spacing` apart, on the surface about
/// the implant. If a triangle is still proven to be cut deeper than the limit, the deepest known point of it is added,
/// until no triangle is. `device` is for the proofs. Returns the last evaluated candidate, whose `within_limit` and
/// `deepest_penetration` are proven for the whole surface. Precondition: the cavity has triangles.
[[nodiscard]] Found within_surface(const CandidateSpace& space, const Found& start, const Cavity& cavity,
                                   const Requirements& asked, double spacing, const FitOptions& options,
                                   const std::string& device, const MakeEvaluator& make_evaluator, SearchWatch& watch);

}  // namespace verisq::fit_search
