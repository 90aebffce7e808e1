/// The search for a pose: its objective, on a device or the host, and its steps.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/plan/candidate_evaluation.hpp"
#include "host/plan/requirements.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/fit.hpp"
#include "verisq/mesh.hpp"

namespace verisq::fit_search {

// The search of a fit: from many starts, then locally, by NLopt, until the caller or time ends it.

// The reports of a running fit to its caller, and the caller's interruptions.

class SearchWatch {
 public:
  /// Keeps a reference to the options.
  SearchWatch(const FitOptions& options, std::size_t implants) : options_(options), implants_(implants) {}

  /// Returns whether the search is to end: polls the caller and its time limit until one of them has ended it, and
  /// reports the progress a few times a second.
  [[nodiscard]] bool ended();

  /// Which of them ended it, if one did.
  [[nodiscard]] bool interrupted() const { return interrupted_; }
  [[nodiscard]] bool out_of_time() const { return out_of_time_; }

  /// From now on this implant is searched, and this share of the work on it is done.
  void at(std::size_t implant, double share);

  /// A pose within the limit has this objective.
  void found(double objective) { best_ = std::max(best_, objective); }

  void count(std::size_t poses) { poses_ += poses; }
  [[nodiscard]] std::uint64_t poses() const { return poses_; }

 private:
  using Clock = std::chrono::steady_clock;

  void report_now_and_then();

  const FitOptions& options_;
  std::size_t implants_;
  std::size_t implant_ = 0;
  double share_ = 0.0;
  double best_ = -infinity;
  bool interrupted_ = false;
  bool out_of_time_ = false;
  std::uint64_t poses_ = 0;
  Clock::time_point next_report_ = Clock::now();
};

// Maximises a smooth function of bounded parameters under inequality constraints, by NLopt's SLSQP.

struct MaximisationProblem {
  const Parameters& lower;
  const Parameters& upper;
  Parameters units;  ///< steps of this size change the objective noticeably: the optimiser counts in them
  double typical;    ///< size of the objective, > 0

  /// Returns the objective and writes its derivatives.
  std::function<double(std::span<const double> parameters, std::span<double> gradient)> objective;

  /// Constraints are numbers that must not be negative, or by no more than the tolerance: an optimum lies on some of
  /// them, and rounding to either side. `jacobian` contains their derivatives row by row.
  std::size_t constraints = 0;
  double constraint_tolerance = 0.0;
  std::function<void(std::span<const double> parameters, std::span<double> values, std::span<double> jacobian)>
      constrain = {};

  /// Polled before each evaluation; true ends the search with the best so far.
  std::function<bool()> interrupted;
};

struct StoppingCriteria {
  double step;  ///< of every parameter, in its unit
  int evaluations;
};

/// A local maximum near the start, as far as the criteria allow. Exceptions of the functions are passed on.
/// Precondition: the start lies within the bounds.
[[nodiscard]] Parameters maximised(const MaximisationProblem& problem, const Parameters& start,
                                   const StoppingCriteria& stop);

// Climbs from a candidate to the nearest maximum of the objective, without regard to the limit of penetration.

struct Ranked {
  Parameters parameters;
  double objective;  ///< rank by a landscape
};

/// An objective to climb: over every stride-th point.
struct Landscape {
  Fitness fitness;
  std::size_t stride;
  double weight;  ///< sum of the weights of the points that take part

  /// A sample on the wrong side, or a missing unit, costs the largest objective of all points.
  [[nodiscard]] double rank(double objective, double broken) const { return objective - weight * broken; }
};

/// The fitness with its scale multiplied: if it is wide enough, every point of the cavity shows the direction to go,
/// and F has fewer maxima.
[[nodiscard]] Fitness widened(const Fitness& fitness, double factor);

[[nodiscard]] Ranked refined(const CandidateSpace& space, CandidateEvaluator& evaluator, const Requirements& asked,
                             const Landscape& landscape, const Parameters& start, const StoppingCriteria& stop,
                             SearchWatch& watch);

// The start of the search: poses sampled evenly, then again around the best of them; cells without prospects are left
// out.

struct Sampling {
  std::size_t samples;  ///< number of samples in all
  std::uint64_t seed;
  std::size_t keep;  ///< starts returned, at most
};

/// The best samples, best first, no two of them in one cell. Sizes stay at the middle of their intervals.
[[nodiscard]] std::vector<Ranked> global_start(const CandidateSpace& space, CandidateEvaluator& evaluator,
                                               const Requirements& asked, const Landscape& landscape,
                                               const Sampling& sampling, SearchWatch& watch);

}  // namespace verisq::fit_search

namespace verisq::device {

// Evaluates many candidates for the pose of an implant against all points of a cavity in one launch of a device.

/// An evaluator that keeps `points`, with one of `weights` each, on the device; a call brings the candidates there and
/// their evaluations back, in launches of at most about a fifth of a second on two processor cores (at least one
/// candidate each). The same call gives the same bits again, and so does a candidate among others. Distances outside
/// and of shallow points inside are right to about 1e-12 of the primitive's size, but for those whose search misses the
/// closest point: one outside in some 200,000, of tapered primitives one in 2,000, with exponents above 1.4 a few in a
/// thousand. Deep inside, where several faces are about equally near, depths may be overestimated (one in a hundred).
/// Exponents above 1.95 count as 1.95: a solid at most 3.5 % larger. The first call compiles its kernels, or takes them
/// from the cache. Throws Error(failure) here and in calls where the device fails. Precondition: at least one point;
/// finite; weights >= 0; stride > 0; at least one primitive a candidate, none bent; candidates of a call agree on which
/// primitives are tapered.
[[nodiscard]] std::unique_ptr<fit_search::CandidateEvaluator> device_candidate_evaluator(
    const Device& device, std::span<const Point> points, std::span<const double> weights);

}  // namespace verisq::device

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
