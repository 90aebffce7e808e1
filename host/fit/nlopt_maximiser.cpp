/// NLopt's C interface: scaled parameters in, exceptions kept from crossing it.
#include "host/fit/nlopt_maximiser.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <memory>

namespace verisq::fit_search {

namespace {

struct Destroy {
  void operator()(nlopt_opt optimiser) const { nlopt_destroy(optimiser); }
};
using Optimiser = std::unique_ptr<nlopt_opt_s, Destroy>;

/// What NLopt calls back, in parameters divided by their units and an objective divided by its typical size.
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
  /// SLSQP asks for parameters that are no numbers where constraints contradict each other: the end of its search.
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

  // NLopt wants what must not be positive.
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

}  // namespace verisq::fit_search
