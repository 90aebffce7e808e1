/// This file implements pose_search.hpp.
#include "host/plan/pose_search.hpp"

#include <nlopt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <random>

#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

namespace {

constexpr std::chrono::milliseconds kBetweenReports{200};

}  // namespace

bool SearchWatch::ended() {
  interrupted_ = interrupted_ || (!out_of_time_ && options_.interrupted());
  out_of_time_ = out_of_time_ || (!interrupted_ && options_.out_of_time && options_.out_of_time());
  report_now_and_then();
  return interrupted_ || out_of_time_;
}

void SearchWatch::at(std::size_t implant, double share) {
  implant_ = implant;
  share_ = share;
  report_now_and_then();
}

void SearchWatch::report_now_and_then() {
  if (Clock::now() < next_report_) return;
  next_report_ = Clock::now() + kBetweenReports;
  const double done = (static_cast<double>(implant_) + share_) / static_cast<double>(implants_);
  options_.progress({.objective = best_, .done = done, .implant = implant_});
}

namespace {

struct Destroy {
  void operator()(nlopt_opt optimiser) const { nlopt_destroy(optimiser); }
};
using Optimiser = std::unique_ptr<nlopt_opt_s, Destroy>;

/// The functions that NLopt calls, in parameters divided by their units and an objective divided by its typical size.
class Callbacks {
 public:
  Callbacks(const MaximisationProblem& problem, nlopt_opt optimiser)
      : problem_(problem), optimiser_(optimiser), parameters_(problem.units.size()) {}

  static double objective(unsigned, const double* scaled, double* gradient, void* self) {
    auto& callbacks = *static_cast<Callbacks*>(self);
    double value = 0.0;
    callbacks.guarded(scaled, [&] { value = callbacks.objective_at(scaled, gradient); });
    return value;
  }

  static void constraints(unsigned count, double* values, unsigned, const double* scaled, double* jacobian,
                          void* self) {
    auto& callbacks = *static_cast<Callbacks*>(self);
    std::fill_n(values, count, 0.0);
    callbacks.guarded(scaled, [&] { callbacks.constraints_at(scaled, {values, count}, jacobian); });
  }

  [[nodiscard]] Parameters unscaled(const double* scaled) const {
    Parameters parameters(problem_.units.size());
    for (std::size_t i = 0; i < parameters.size(); ++i)
      parameters[i] = std::clamp(scaled[i] * problem_.units[i], problem_.lower[i], problem_.upper[i]);
    return parameters;
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  /// SLSQP requests parameters that are NaN if constraints contradict each other: the end of its search.
  template <class Work>
  void guarded(const double* scaled, const Work& work) {
    try {
      const bool lost = std::any_of(scaled, scaled + parameters_.size(), [](double x) { return std::isnan(x); });
      if (lost || problem_.interrupted())
        nlopt_force_stop(optimiser_);
      else
        work();
    } catch (...) {
      failure_ = std::current_exception();
      nlopt_force_stop(optimiser_);
    }
  }

  double objective_at(const double* scaled, double* gradient) {
    parameters_ = unscaled(scaled);
    derivatives_.resize(parameters_.size());
    const double value = problem_.objective(parameters_, derivatives_);
    if (gradient != nullptr)
      for (std::size_t i = 0; i < parameters_.size(); ++i)
        gradient[i] = derivatives_[i] * problem_.units[i] / problem_.typical;
    return value / problem_.typical;
  }

  // NLopt requires values that must not be positive.
  void constraints_at(const double* scaled, std::span<double> values, double* jacobian) {
    parameters_ = unscaled(scaled);
    derivatives_.resize(values.size() * parameters_.size());
    problem_.constrain(parameters_, values, derivatives_);
    for (double& value : values) value = -value;
    if (jacobian == nullptr) return;
    for (std::size_t i = 0; i < derivatives_.size(); ++i)
      jacobian[i] = -derivatives_[i] * problem_.units[i % parameters_.size()];
  }

  const MaximisationProblem& problem_;
  nlopt_opt optimiser_;
  Parameters parameters_;
  std::vector<double> derivatives_;
  std::exception_ptr failure_;
};

Parameters divided(const Parameters& parameters, const Parameters& units) {
  Parameters result(parameters.size());
  std::ranges::transform(parameters, units, result.begin(), std::divides<>());
  return result;
}

}  // namespace

Parameters maximised(const MaximisationProblem& problem, const Parameters& start, const StoppingCriteria& stop) {
  if (problem.lower == problem.upper) return start;
  const Optimiser optimiser(nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(start.size())));
  Callbacks callbacks(problem, optimiser.get());
  const Parameters lower = divided(problem.lower, problem.units);
  const Parameters upper = divided(problem.upper, problem.units);
  nlopt_set_lower_bounds(optimiser.get(), lower.data());
  nlopt_set_upper_bounds(optimiser.get(), upper.data());
  nlopt_set_max_objective(optimiser.get(), Callbacks::objective, &callbacks);
  const std::vector<double> tolerances(problem.constraints, problem.constraint_tolerance);
  if (problem.constraints > 0)
    nlopt_add_inequality_mconstraint(optimiser.get(), static_cast<unsigned>(problem.constraints),
                                     Callbacks::constraints, &callbacks, tolerances.data());
  nlopt_set_xtol_abs1(optimiser.get(), stop.step);
  nlopt_set_maxeval(optimiser.get(), stop.evaluations);
  Parameters scaled = divided(start, problem.units);
  for (std::size_t i = 0; i < scaled.size(); ++i) scaled[i] = std::clamp(scaled[i], lower[i], upper[i]);
  double value = 0.0;
  // Whatever ends the search, failure by rounding too, leaves the best point found in `scaled`.
  nlopt_optimize(optimiser.get(), scaled.data(), &value);
  callbacks.rethrow();
  return callbacks.unscaled(scaled.data());
}

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
                                    .interrupted = [&] { return watch.ended(); }};
  (void)maximised(problem, start, stop);  // the best evaluation is kept above
  return best;
}

namespace {

constexpr std::size_t kDimensions = 6;
/// The root of x^7 = x + 1: the powers of its inverse make the additive recurrence of lowest known discrepancy in six
/// dimensions (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", after the golden ratio).
constexpr double kHarmonious = 1.1127756842787055;
/// Between two polls of the caller.
constexpr std::size_t kBatch = 64;
/// Cells that are sampled again, at most.
constexpr std::size_t kPromising = 16;
/// Rounds of sampling; the first gets half of the samples.
constexpr int kRounds = 3;

using Unit = std::array<double, kDimensions>;  ///< a point of the unit cube

class LowDiscrepancySequence {
 public:
  explicit LowDiscrepancySequence(std::uint64_t seed) {
    std::mt19937_64 random(seed);  // whose numbers the standard fixes, unlike those of its distributions
    for (double& x : at_) x = static_cast<double>(random() >> 11) * 0x1p-53;
  }

  Unit next() {
    double step = 1.0;
    for (double& x : at_) {
      step /= kHarmonious;
      x += step;
      x -= std::floor(x);
    }
    return at_;
  }

 private:
  Unit at_{};
};

/// A box of poses: `half` times the whole range to both sides of the centre, as far as the range goes.
struct Cell {
  Ranked centre;
  double bound;  ///< bound of the objective within the cell
};

class Sampler {
 public:
  Sampler(const CandidateSpace& space, CandidateEvaluator& evaluator, const Requirements& asked,
          const Landscape& landscape, std::uint64_t seed, SearchWatch& watch)
      : space_(space), evaluator_(evaluator), asked_(asked), landscape_(landscape), watch_(watch), sequence_(seed) {}

  /// Adds `count` samples of the box around the centre; each has a cell of its own size around it.
  void sample(const Parameters& centre, double half, double cell_half, std::size_t count, std::vector<Cell>& cells) {
    for (std::size_t done = 0; done < count && !watch_.ended(); done += kBatch) {
      std::vector<Parameters> poses(std::min(kBatch, count - done));
      for (Parameters& pose : poses) pose = placed(centre, half, sequence_.next());
      evaluate(poses, cell_half, cells);
    }
  }

 private:
  [[nodiscard]] Parameters placed(const Parameters& centre, double half, const Unit& unit) const {
    Parameters pose = centre;
    for (std::size_t i = 0; i < kDimensions; ++i) {
      const double reach = half * space_.upper()[i];
      const double low = std::max(centre[i] - reach, space_.lower()[i]);
      const double high = std::min(centre[i] + reach, space_.upper()[i]);
      pose[i] = low + unit[i] * (high - low);
    }
    return pose;
  }

  void evaluate(const std::vector<Parameters>& poses, double cell_half, std::vector<Cell>& cells) {
    std::vector<Candidate> candidates;
    candidates.reserve(poses.size());
    for (const Parameters& pose : poses) candidates.push_back(space_.candidate(pose));
    // Corners are the square root of 3 farther than faces. Rotation vectors that differ by δ make rotations that differ
    // by at most |δ|.
    const double corner = std::sqrt(3.0) * cell_half;
    const PoseCell cell{corner * space_.upper()[0], corner * space_.upper()[3]};
    evaluator_.evaluate(candidates, landscape_.fitness, cell, landscape_.stride, evaluations_);
    watch_.count(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double rank = landscape_.rank(evaluations_[i].objective, asked_.broken(poses[i], candidates[i]));
      cells.push_back({{poses[i], rank}, evaluations_[i].objective_bound});
    }
  }

  const CandidateSpace& space_;
  CandidateEvaluator& evaluator_;
  const Requirements& asked_;
  const Landscape& landscape_;
  SearchWatch& watch_;
  LowDiscrepancySequence sequence_;
  std::vector<Evaluation> evaluations_;
};

/// Half the side of the cells that `count` samples divide a box into.
double divided(double half, std::size_t count) {
  return half * std::pow(static_cast<double>(count), -1.0 / static_cast<double>(kDimensions));
}

void best_first(std::vector<Cell>& cells) {
  std::ranges::stable_sort(cells, [](const Cell& a, const Cell& b) { return a.centre.objective > b.centre.objective; });
}

/// Drops cells that cannot contain anything better than the known pose, then all but the best.
std::vector<Cell> promising(std::vector<Cell> cells) {
  best_first(cells);
  const double known = cells.front().centre.objective;
  std::erase_if(cells, [known](const Cell& cell) { return cell.bound < known; });
  cells.resize(std::min(cells.size(), kPromising));
  return cells;
}

/// Returns whether one lies in the other's cell.
bool close(const CandidateSpace& space, const Parameters& a, const Parameters& b, double half) {
  for (std::size_t i = 0; i < kDimensions; ++i)
    if (std::fabs(a[i] - b[i]) > half * space.upper()[i]) return false;
  return true;
}

}  // namespace

std::vector<Ranked> global_start(const CandidateSpace& space, CandidateEvaluator& evaluator, const Requirements& asked,
                                 const Landscape& landscape, const Sampling& sampling, SearchWatch& watch) {
  Sampler sampler(space, evaluator, asked, landscape, sampling.seed, watch);
  std::vector<Cell> all;
  sampler.sample(space.start(), 0.0, 0.0, 1, all);  // the start itself
  const std::size_t first = std::max<std::size_t>(sampling.samples / 2, 1);
  double half = divided(1.0, first);
  sampler.sample(space.start(), 1.0, half, first, all);
  const double separation = half;
  std::vector<Cell> cells = all;
  for (int round = 1; round < kRounds && !cells.empty(); ++round) {
    cells = promising(std::move(cells));
    const std::size_t each = sampling.samples / 2 / (kRounds - 1) / std::max<std::size_t>(cells.size(), 1);
    if (each == 0) break;
    std::vector<Cell> finer;
    for (const Cell& cell : cells) sampler.sample(cell.centre.parameters, half, divided(half, each), each, finer);
    half = divided(half, each);
    all.insert(all.end(), finer.begin(), finer.end());
    cells = std::move(finer);
  }

  best_first(all);
  std::vector<Ranked> starts;
  for (const Cell& cell : all) {
    const auto taken = [&](const Ranked& start) {
      return close(space, start.parameters, cell.centre.parameters, separation);
    };
    if (std::ranges::none_of(starts, taken)) starts.push_back(cell.centre);
    if (starts.size() == sampling.keep) break;
  }
  return starts;
}

}  // namespace verisq::fit_search
