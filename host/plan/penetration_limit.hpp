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

// A candidate at every point of the cavity: the objective, the distances, whether the limit is respected.

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

// Climbs to the nearest maximum of the objective among the candidates that no point of the cavity enters too deep.

/// A semi-infinite program solved by constraint generation: an optimum under the constraints of the worst points, then
/// those that it violates added, until there are none. A small margin, within which the optimiser may err, keeps its
/// answer within the limit. Whatever it evaluates is offered to the incumbent. Returns where it ended, which lies
/// beyond the limit where no candidate nearby respects it.
void refine_within_limit(FullEvaluation& cavity, const Parameters& start);

/// Only moves a candidate beyond the limit to a near one within it, if there is one.
void restore_within_limit(FullEvaluation& cavity, const Parameters& start);

// Points between those of the cavity, which an implant is kept off during the search.

/// The cavity with points of weight 0 added, on a grid over each triangle of at most the given spacing, or a wider one
/// where that would be more than the given number. The area they belong to is the last; nothing changes where there are
/// no triangles. Precondition: spacing > 0.
[[nodiscard]] Cavity with_surface_points(const Cavity& cavity, double spacing, std::size_t most_points);

/// Points of a triangle about one of it, the closer together the nearer they are to it: a patch that an implant can
/// hardly slip off. The first is the point itself. `spacing` is that of the outer ones.
[[nodiscard]] std::vector<Point> patch(const Triangle& triangle, const Point& middle, double spacing);

// Keeps the implant from cutting the surface between the points of the cavity.

/// Constraint generation once more: a search nearby keeps off a grid of points, `spacing` apart, on the surface about
/// the implant; where a triangle is proven to be cut deeper than the limit all the same, the deepest point known of it
/// is added, until no triangle is. `device` is for the proofs. Returns the last candidate looked at, whose
/// `within_limit` and `deepest_penetration` are of the whole surface and proven. Precondition: the cavity has
/// triangles.
[[nodiscard]] Found within_surface(const CandidateSpace& space, const Found& start, const Cavity& cavity,
                                   const Requirements& asked, double spacing, const FitOptions& options,
                                   const std::string& device, const MakeEvaluator& make_evaluator, SearchWatch& watch);

}  // namespace verisq::fit_search
