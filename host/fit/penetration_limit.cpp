/// Rounds of optimisation under a growing set of constraints.
#include "host/fit/penetration_limit.hpp"

#include <algorithm>

#include "host/fit/evaluation_sum.hpp"
#include "host/fit/nlopt_maximiser.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

namespace {

constexpr int kMostRounds = 12;
constexpr StoppingCriteria kRefinement{.step = 1e-8, .evaluations = 80};
constexpr StoppingCriteria kRestoration{.step = 1e-8, .evaluations = 120};
/// Points added in a round, at most.
constexpr std::size_t kAdded = 128;
/// In parts of the fitness' scale: how close to the limit a point is watched, and what keeps rounding from crossing it.
constexpr double kWatched = 0.5;
constexpr double kMargin = 1e-6;
/// In parts of the sum of weights: what makes another round worth its while.
constexpr double kWorthwhile = 1e-9;

class LimitedRefinement {
 public:
  explicit LimitedRefinement(FullEvaluation& cavity)
      : cavity_(cavity), scale_(cavity.fitness().scale), units_(cavity.space().units()) {
    for (double& unit : units_) unit *= scale_;
    for (const std::uint32_t area : cavity.cavity().area_of) weight_ += cavity.cavity().areas[area].weight;
  }

  void run(Parameters parameters) {
    double reached = -infinity;
    for (int round = 0; round < kMostRounds && !cavity_.watch().interrupted(); ++round) {
      const bool more = watch_worst(parameters);
      // Where the nearest primitive changes the distance has a kink, at which the optimiser may stop early: a fresh
      // start goes on.
      const double objective = cavity_.at(parameters).evaluation.objective;
      if (!more && objective <= reached + kWorthwhile * weight_) break;
      reached = more ? -infinity : objective;
      parameters = maximised(limited_problem(), restored(parameters), kRefinement);
    }
    (void)restored(parameters);
  }

  void restore(const Parameters& parameters) { (void)restored(parameters); }

 private:
  /// Of a distance: what is missing to the limit and the margin, negative where it is beyond.
  [[nodiscard]] double slack(const PointDistance& at) const {
    return at.distance + cavity_.penetration_limit() - kMargin * scale_;
  }

  /// Adds points to the watched; false where all that are too deep are watched already.
  bool watch_worst(const Parameters& parameters) {
    const std::vector<PointDistance>& distances = cavity_.at(parameters).distances;
    const bool first = watched_.empty();
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t i = 0; i < distances.size(); ++i) {
      const bool near = slack(distances[i]) < (first ? kWatched * scale_ : 0.0);
      if (near && !std::ranges::binary_search(watched_, i)) candidates.push_back(i);
    }
    std::ranges::stable_sort(candidates, {}, [&](std::uint32_t i) { return distances[i].distance; });
    candidates.resize(std::min(candidates.size(), kAdded));
    watched_.insert(watched_.end(), candidates.begin(), candidates.end());
    std::ranges::sort(watched_);
    return !candidates.empty();
  }

  [[nodiscard]] MaximisationProblem problem(
      double typical, std::function<double(std::span<const double>, std::span<double>)> objective) const {
    return {.lower = cavity_.space().lower(),
            .upper = cavity_.space().upper(),
            .units = units_,
            .typical = typical,
            .objective = std::move(objective),
            .interrupted = [this] { return cavity_.watch().interrupted(); }};
  }

  /// The objective, the watched points as constraints in parts of the scale.
  [[nodiscard]] MaximisationProblem limited_problem() {
    MaximisationProblem result =
        problem(weight_ + cavity_.asked().most(), [this](std::span<const double> x, std::span<double> gradient) {
          const Evaluation& found = cavity_.at(x).evaluation;
          std::ranges::copy(cavity_.space().gradient(x, found.pose_gradient, found.size_gradient), gradient.begin());
          return found.objective;
        });
    result.constraints = watched_.size() + cavity_.asked().constraints.rows();
    result.constraint_tolerance = kMargin / 2.0;
    result.constrain = [this](std::span<const double> x, std::span<double> values, std::span<double> jacobian) {
      const FullEvaluation::Result& found = cavity_.at(x);
      for (std::size_t j = 0; j < watched_.size(); ++j) {
        values[j] = slack(found.distances[watched_[j]]) / scale_;
        const std::span<double> row = jacobian.subspan(j * x.size(), x.size());
        write_derivatives(x, watched_[j], found.distances[watched_[j]], row);
        for (double& derivative : row) derivative /= scale_;
      }
      const PoseConstraints& asked = cavity_.asked().constraints;
      std::ranges::transform(asked.slack(x), values.begin() + static_cast<std::ptrdiff_t>(watched_.size()),
                             [](double slack) { return slack - kMargin; });
      std::ranges::copy(asked.jacobian(x), jacobian.begin() + static_cast<std::ptrdiff_t>(watched_.size() * x.size()));
    };
    return result;
  }

  void write_derivatives(std::span<const double> x, std::uint32_t point, const PointDistance& at,
                         std::span<double> row) const {
    const Point pivot = cavity_.space().pivot(x);
    const auto by_pose = pose_gradient(cavity_.cavity().points[point], pivot, at.normal);
    cavity_.space().gradient(x, by_pose, at, row);
  }

  /// The squares of what is missing of the constraints; their derivatives are taken off the gradient.
  [[nodiscard]] double add_missing(std::span<const double> x, std::span<double> gradient) const {
    const PoseConstraints& asked = cavity_.asked().constraints;
    std::vector<double> missing = asked.slack(x);
    for (double& slack : missing) slack = std::min(slack - 2.0 * kMargin, 0.0);
    double sum = 0.0;
    for (const double part : missing) sum += part * part;
    if (sum == 0.0) return sum;  // derivatives cost a dozen values each
    const std::vector<double> derivatives = asked.jacobian(x);
    for (std::size_t j = 0; j < missing.size(); ++j) {
      for (std::size_t k = 0; k < x.size(); ++k) gradient[k] -= 2.0 * missing[j] * derivatives[j * x.size() + k];
    }
    return sum;
  }

  /// From a candidate beyond the limit to one within it, if one is near: least squares of what all points are too deep.
  [[nodiscard]] Parameters restored(const Parameters& parameters) const {
    const PoseConstraints& asked = cavity_.asked().constraints;
    if (cavity_.at(parameters).within_limit && asked.violation(parameters) == 0.0) return parameters;
    std::vector<double> row(parameters.size());
    Parameters best = parameters;
    double least = infinity;
    const auto minus_squares = [&](std::span<const double> x, std::span<double> gradient) {
      const FullEvaluation::Result& found = cavity_.at(x);
      double sum = 0.0;
      std::ranges::fill(gradient, 0.0);
      for (std::uint32_t i = 0; i < found.distances.size(); ++i) {
        // Twice the margin: the squares leave a little of what they are to remove.
        const double missing = std::min(slack(found.distances[i]) - kMargin * scale_, 0.0) / scale_;
        if (missing == 0.0) continue;
        sum += missing * missing;
        write_derivatives(x, i, found.distances[i], row);
        for (std::size_t k = 0; k < row.size(); ++k) gradient[k] -= 2.0 * missing * row[k] / scale_;
      }
      sum += add_missing(x, gradient);
      if (sum < least) {
        least = sum;
        best.assign(x.begin(), x.end());
      }
      return -sum;
    };
    (void)maximised(problem(1.0, minus_squares), parameters, kRestoration);
    return best;
  }

  FullEvaluation& cavity_;
  double scale_;
  Parameters units_;
  double weight_ = 0.0;
  std::vector<std::uint32_t> watched_;  ///< ascending
};

}  // namespace

void refine_within_limit(FullEvaluation& cavity, const Parameters& start) {
  LimitedRefinement(cavity).run(start);
}

void restore_within_limit(FullEvaluation& cavity, const Parameters& start) {
  LimitedRefinement(cavity).restore(start);
}

}  // namespace verisq::fit_search
