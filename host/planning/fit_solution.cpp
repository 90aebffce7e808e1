/// Searches, bounds, searches again; then proves.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>
#include <verisq/fit_solution.hpp>

#include "host/errors/refusal.hpp"
#include "host/planning/fit_conditions.hpp"
#include "host/planning/fit_constraints.hpp"
#include "host/planning/fit_contacts.hpp"
#include "host/planning/largest_fit.hpp"
#include "verify/numbers/rounding.hpp"

namespace verisq {
namespace {

// The depth of a cut needs many samples to be known closely, and none where nothing is cut.
constexpr double surface_coarseness = 10.0;
// Eight times what the search's own proofs may take: where an implant is pressed flat against the bone, more would only
// say more closely how far it is too deep.
constexpr std::uint64_t most_surface_samples = std::uint64_t{1} << 19U;

/// Before the search, not after it.
void refuse_what_has_no_bound(const FitProblem& problem) {
  if (problem.options.objective == FitObjective::size)
    refuse("--bound: is of F, which --objective size does not maximise");
  for (std::size_t i = 0; i < problem.series.size(); ++i) {
    if (!is_exact(problem.series[i])) {
      refuse(fmt::format("--bound: {} has sizes to choose from, and the bound is of poses alone", problem.names[i]));
    }
    if (is_union_of_convex(bracket(problem.series[i]).largest)) continue;
    refuse(fmt::format("--bound: {}: is known of unions of primitives without bends alone", problem.names[i]));
  }
}

Fit searched(const FitProblem& problem, const FitSolutionOptions& options, std::vector<Pose> tried) {
  FitOptions of_search = problem.options;
  of_search.constraints = planning::constraints_of(problem);
  of_search.contacts = planning::contacts_of(problem);
  of_search.tried = std::move(tried);
  of_search.interrupted = options.interrupted;
  of_search.progress = options.progress;
  return fit(problem.series, problem.cavity, of_search);
}

FitTrial untried(const FitProblem& problem, const FitFinalist& finalist) {
  FitTrial trial{.fit = finalist,
                 .size = implant_size(finalist.model),
                 .changes = changes_of(problem, finalist.implant, finalist.pose),
                 .kept = {},
                 .open = {}};
  for (const FitCondition& condition : planning::conditions_of_changes(problem, trial.changes)) {
    if (condition.kept == true) continue;
    trial.open.push_back(condition.name);
    if (condition.kept == false) trial.kept = false;
  }
  return trial;
}

/// Of the search that chose the fit.
std::vector<FitTrial> trials_of(const FitProblem& problem, const Fit& fit) {
  std::vector<FitTrial> trials;
  trials.reserve(fit.finalists.size());
  for (const FitFinalist& finalist : fit.finalists) trials.push_back(untried(problem, finalist));
  return trials;
}

FitBound bounded(const FitProblem& problem, const FitSolutionOptions& options, double known) {
  return bound_fit(problem.series, problem.cavity,
                   {.fitness = problem.options.fitness,
                    .penetration_limit = problem.options.penetration_limit,
                    .range = problem.options.range,
                    .known = known,
                    .gap = *options.gap,
                    .device = problem.options.device,
                    .interrupted = options.interrupted,
                    .out_of_time = options.out_of_time,
                    .progress = options.bound_progress});
}

/// (upper - objective) / upper, rounded up.
std::optional<double> proven_gap(const FitBound& bound, const Clearance& clearance) {
  using verify::Direction;
  const double objective = clearance.objective.lo;
  if (clearance.proven_shallow != clearance.map.points || !(objective > 0.0) || !(bound.upper >= objective))
    return std::nullopt;
  return verify::divide(verify::subtract(bound.upper, objective, Direction::up), bound.upper, Direction::up);
}

bool contact_is_kept(const FitProof& proof) {
  return std::ranges::all_of(proof.conditions, [](const FitCondition& condition) {
    return condition.unit != ConditionUnit::percent || condition.kept == true;
  });
}

}  // namespace

FitSolution solve_fit(const FitProblem& problem, const FitSolutionOptions& options) {
  if (options.gap) refuse_what_has_no_bound(problem);
  if (problem.options.objective == FitObjective::size) return planning::largest_fit(problem, options);
  FitSolution solution{.fit = searched(problem, options, {})};
  options.found(solution.fit);
  if (!options.gap || solution.fit.interrupted) {
    solution.trials = trials_of(problem, solution.fit);
    return solution;
  }
  const auto start = std::chrono::steady_clock::now();
  solution.bound = bounded(problem, options, solution.fit.objective);
  if (solution.bound->promising && !options.interrupted()) {
    Fit again = searched(problem, options, {solution.bound->promising->pose});
    if (again.interrupted) {
      solution.fit.interrupted = true;
    } else if (again.objective != solution.fit.objective) {  // of all that the first search found, too
      solution.fit = std::move(again);
      options.found(solution.fit);
    }
  }
  solution.trials = trials_of(problem, solution.fit);
  solution.bound_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return solution;
}

MeshClearance prove_surface(const FitProblem& problem, const Model& model, const MapOptions& options) {
  return mesh_clearance(model, problem.mesh,
                        {.penetration_limit = problem.options.penetration_limit,
                         .tolerance = surface_coarseness * problem.options.surface_tolerance,
                         .limit_tolerance = problem.options.surface_tolerance,
                         .most_samples = most_surface_samples,
                         .device = problem.options.device,
                         .interrupted = options.interrupted});
}

FitProof prove_fit(const FitProblem& problem, const FitSolution& solution, const MapOptions& options,
                   const Sink<Point>& sink) {
  const Fit& fit = solution.fit;
  FitProof proof{.clearance = certified_clearance(fit.model, problem.cavity, problem.options.fitness,
                                                  problem.options.penetration_limit, options, sink),
                 .surface = {},
                 .sides = {},
                 .changes = changes_of(problem, fit.implant, fit.pose),
                 .contact = planning::proven_contact(problem, fit.implant, fit.model, options),
                 .conditions = {},
                 .gap = {}};
  if (!problem.cavity.triangles.empty()) proof.surface = prove_surface(problem, fit.model, options);
  if (problem.surface != FitSurface::unsided) {
    proof.sides = prove_sides(fit.model, problem.mesh, problem.options.sides[fit.implant],
                              problem.options.penetration_limit, options.interrupted);
  }
  proof.conditions = planning::conditions_of(problem, fit, proof);
  if (solution.bound) proof.gap = proven_gap(*solution.bound, proof.clearance);
  return proof;
}

CertifiedContact certified_contact(const FitProblem& problem, const Fit& fit, const FitProof& proof,
                                   const std::function<bool()>& interrupted,
                                   const std::function<void(double)>& progress) {
  return certified_contact(fit.model, problem.mesh, *proof.contact,
                           planning::contact_options(problem, fit.implant, interrupted), progress);
}

bool is_as_asked(const FitProblem& problem, const FitSolution& solution, const FitProof& proof,
                 const std::optional<double>& gap) {
  const bool near_enough = !solution.bound || !gap || (proof.gap && *proof.gap <= *gap);
  return proof.clearance.map.wide == 0 && proof.clearance.proven_too_deep == 0 &&
         (!proof.surface || proof.surface->proven_too_deep == 0) && (!proof.sides || proof.sides->kept()) &&
         is_preserved(proof.changes, problem.kept) && contact_is_kept(proof) && near_enough;
}

}  // namespace verisq
