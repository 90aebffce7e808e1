/// Solves a requested fit: the largest implant that fits, and proofs of its conditions.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/fit_solution.hpp>

#include "host/errors/refusal.hpp"
#include "host/plan/fit_problem.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/device.hpp"

namespace verisq::planning {

// The conditions of a fit, from its proof.

/// The name of the limit's condition.
inline constexpr std::string_view limit_condition = "smallest distance";

/// The conditions of the changes with a required range.
[[nodiscard]] std::vector<FitCondition> conditions_of_changes(const FitProblem& problem, const FemurFeatures& changes);

/// All conditions: the limit of penetration, sides, changes, contact.
[[nodiscard]] std::vector<FitCondition> conditions_of(const FitProblem& problem, const Fit& fit, const FitProof& proof);

// The largest implant of a series, or the largest sizes, for which all requirements are proven.

/// As defined by solve_fit. It is not proven that no larger implant can keep the conditions: the search found no pose
/// of one.
[[nodiscard]] FitSolution largest_fit(const FitProblem& problem, const FitSolutionOptions& options);

namespace {

constexpr double close_in_scales = 0.01;
constexpr double close_in_degrees = 0.01;
constexpr double close_in_percent = 0.5;

double close_to(ConditionUnit unit, const FitProblem& problem) {
  switch (unit) {
    case ConditionUnit::degrees: return close_in_degrees;
    case ConditionUnit::percent: return close_in_percent;
    default: return close_in_scales * problem.options.fitness.scale;
  }
}

/// A condition that is proven to be broken ends nothing, nor does an end that no value can pass.
std::optional<RangeEnd> binding_end(const FitCondition& condition, const FitProblem& problem) {
  if (condition.kept == false) return std::nullopt;
  const bool is_share = condition.unit == ConditionUnit::percent;
  const double close = close_to(condition.unit, problem);
  if (!(is_share && condition.range->lo <= 0.0) && condition.value->lo - condition.range->lo <= close)
    return RangeEnd::lower;
  if (!(is_share && condition.range->hi >= 100.0) && condition.range->hi - condition.value->hi <= close)
    return RangeEnd::upper;
  return std::nullopt;
}

/// The bone is no nearer than minus the limit.
FitCondition condition_of_limit(const FitProblem& problem, const FitProof& proof) {
  const Clearance& clearance = proof.clearance;
  FitCondition condition{.name = std::string(limit_condition),
                         .unit = ConditionUnit::length,
                         .value = proof.surface ? proof.surface->smallest_distance : clearance.smallest_distance,
                         .range = Enclosure{0.0 - problem.options.penetration_limit, infinity}};
  const bool broken = clearance.proven_too_deep > 0 || (proof.surface && proof.surface->proven_too_deep > 0);
  const bool proven =
      clearance.proven_shallow == clearance.map.points && (!proof.surface || proof.surface->undecided == 0);
  if (broken || proven) condition.kept = !broken;
  condition.binds = binding_end(condition, problem);
  return condition;
}

std::vector<FitCondition> conditions_of_sides(const FitProblem& problem, const Fit& fit, const FitProof& proof) {
  std::vector<FitCondition> conditions;
  if (!proof.sides) return conditions;
  for (std::size_t k = 0; k < fit.model.primitives.size(); ++k) {
    if (problem.options.sides[fit.implant][k] == SurfaceSide::any) continue;
    FitCondition condition{.name = fmt::format("side of {}", name_of_primitive(fit.model, k))};
    const SideFinding finding = proof.sides->of_primitives[k];
    if (finding == SideFinding::kept) condition.kept = true;
    if (finding == SideFinding::other_side) condition.kept = false;
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

/// The shares in percent, rounded outward by far more than the error of 100 x.
Enclosure in_percent(const Enclosure& share) {
  constexpr double rounding = 1e-13;
  return {std::max(0.0, 100.0 * share.lo - rounding), std::min(100.0, 100.0 * share.hi + rounding)};
}

std::vector<FitCondition> conditions_of_contact(const FitProblem& problem, const FitProof& proof) {
  std::vector<FitCondition> conditions;
  for (const KeptFeature& kept : problem.contacts) {
    const Enclosure value = in_percent(*share_named(problem, *proof.contact, kept.name));
    FitCondition condition{.name = kept.name,
                           .unit = ConditionUnit::percent,
                           .value = value,
                           .range = kept.range,
                           .kept = is_within(value, kept.range)};
    condition.binds = binding_end(condition, problem);
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

}  // namespace

std::vector<FitCondition> conditions_of_changes(const FitProblem& problem, const FemurFeatures& changes) {
  std::vector<FitCondition> conditions;
  for (const KeptFeature& kept : problem.kept) {
    const auto change = std::ranges::find(changes.features, kept.name, &Feature::name);
    FitCondition condition{.name = kept.name};
    if (change != changes.features.end()) {
      condition.unit = change->unit == FeatureUnit::degrees ? ConditionUnit::degrees : ConditionUnit::length;
      condition.value = change->value;
      condition.range = kept.range;
      condition.kept = is_within(change->value, kept.range);
      condition.binds = binding_end(condition, problem);
    }
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

std::vector<FitCondition> conditions_of(const FitProblem& problem, const Fit& fit, const FitProof& proof) {
  std::vector<FitCondition> conditions{condition_of_limit(problem, proof)};
  const auto add = [&conditions](std::vector<FitCondition> more) {
    conditions.insert(conditions.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  add(conditions_of_sides(problem, fit, proof));
  add(conditions_of_changes(problem, proof.changes));
  add(conditions_of_contact(problem, proof));
  return conditions;
}

namespace {

/// Share of the bounding radius: the rows of a trial's proof need not be narrow.
constexpr double tolerance_of_rows = 1e-6;

/// An implant of the series, and the results for it.
struct Member {
  std::size_t implant;
  double size;                 ///< its largest possible size, then the size that the search gave it
  std::optional<Fit> fit;      ///< once searched
  std::optional<bool> proven;  ///< once tried: all conditions, or not
  std::vector<std::string> open;
};

class LargestFit {
 public:
  LargestFit(const FitProblem& problem, const FitSolutionOptions& options) : problem_(problem), options_(options) {
    for (std::size_t i = 0; i < problem.series.size(); ++i)
      members_.push_back({i, implant_size(bracket(problem.series[i]).largest), {}, {}, {}});
  }

  FitSolution operator()() {
    for (Member* next = largest_open(); next != nullptr && !ended(); next = largest_open()) {
      if (!next->fit) {
        search(*next);
      } else {
        prove(*next);
        if (next->proven == true) break;
      }
    }
    if (std::ranges::none_of(members_, [](const Member& member) { return member.fit.has_value(); }))
      search(members_.front());  // interrupted at once: where it starts, at least
    return solution();
  }

 private:
  [[nodiscard]] bool out_of_time() const { return options_.search_out_of_time && options_.search_out_of_time(); }
  [[nodiscard]] bool ended() const { return options_.interrupted() || out_of_time(); }

  /// The largest open member; of equals the earlier. Nothing when all are searched and none is proven.
  Member* largest_open() {
    Member* largest = nullptr;
    for (Member& member : members_) {
      if (!member.proven && (largest == nullptr || member.size > largest->size)) largest = &member;
    }
    return largest;
  }

  void search(Member& member) {
    const std::size_t i = member.implant;
    FitOptions of_search = problem_.options;
    if (!of_search.sides.empty()) of_search.sides = {problem_.options.sides[i]};
    of_search.constraints = constraints_of(problem_);
    of_search.contacts = contacts_of(problem_);
    for (FitConstraint& constraint : of_search.constraints) {
      constraint.value = [i, value = std::move(constraint.value)](std::size_t, const Pose& pose) {
        return value(i, pose);
      };
    }
    of_search.interrupted = options_.interrupted;
    of_search.out_of_time = options_.search_out_of_time;
    of_search.progress = [this, i](const FitProgress& progress) {
      options_.progress({progress.objective, progress.done, i});
    };
    member.fit = fit({&problem_.series[i], 1}, problem_.cavity, of_search);
    member.fit->implant = i;
    for (FitFinalist& finalist : member.fit->finalists) finalist.implant = i;
    member.size = implant_size(member.fit->model);
  }

  /// An implant without a pose within the limit is not tried. Rows are thrown away: for the chosen implant they are
  /// proven again on demand.
  void prove(Member& member) {
    if (!member.fit->within_limit) {
      member.open = {std::string(limit_condition)};
      member.proven = false;
      return;
    }
    const FitSolution found{.fit = *member.fit};
    const MapOptions of_map{.tolerance = tolerance_of_rows * bounding_radius(found.fit.model),
                            .device = problem_.options.device,
                            .interrupted = options_.interrupted,
                            .out_of_time = options_.search_out_of_time};
    const FitProof proof =
        prove_fit(problem_, found, of_map, [](std::span<const Point>, std::span<const MapResult>, auto) {});
    for (const FitCondition& condition : proof.conditions) {
      if (condition.kept != true) member.open.push_back(condition.name);
    }
    member.proven = member.open.empty() && !ended();
  }

  /// Proven before not; then as a fit chooses among its finalists.
  static bool better(const Member& a, const Member& b) {
    const auto rank = [](const Member& member) {
      const Fit& fit = *member.fit;
      return std::tuple(member.proven == true, fit.within_limit, fit.within_limit ? 0.0 : -fit.deepest_penetration,
                        fit.objective);
    };
    return rank(a) > rank(b);
  }

  [[nodiscard]] FitTrial trial(const Member& member) const {
    const Fit& fit = *member.fit;
    return {.fit = {.implant = member.implant,
                    .pose = fit.pose,
                    .model = fit.model,
                    .objective = fit.objective,
                    .deepest_penetration = fit.deepest_penetration,
                    .within_limit = fit.within_limit,
                    .kept = member.proven == true},
            .size = member.size,
            .changes = changes_of(problem_, member.implant, fit.pose),
            .kept = member.proven,
            .open = member.open};
  }

  [[nodiscard]] FitSolution solution() {
    std::ranges::stable_sort(members_, std::greater<>(), &Member::size);
    const Member* chosen = nullptr;
    for (const Member& member : members_) {
      if (member.fit && (chosen == nullptr || better(member, *chosen))) chosen = &member;
    }
    FitSolution solution{.fit = *chosen->fit};
    for (const Member& member : members_) {
      if (member.fit && &member != chosen) solution.trials.push_back(trial(member));
    }
    solution.fit.finalists.clear();
    for (const FitTrial& trial : solution.trials) solution.fit.finalists.push_back(trial.fit);
    solution.fit.interrupted = solution.fit.interrupted || options_.interrupted();
    solution.fit.out_of_time = solution.fit.out_of_time || out_of_time();
    options_.found(solution.fit);
    return solution;
  }

  const FitProblem& problem_;
  const FitSolutionOptions& options_;
  std::vector<Member> members_;
};

}  // namespace

FitSolution largest_fit(const FitProblem& problem, const FitSolutionOptions& options) {
  return LargestFit(problem, options)();
}

}  // namespace verisq::planning

namespace verisq {
namespace {

// The depth of a cut needs many samples to be known closely, and none where nothing is cut.
constexpr double surface_coarseness = 10.0;
// Eight times the limit of the search's own proofs: if an implant is pressed flat against the bone, more samples would
// only enclose more closely how far it is too deep.
constexpr std::uint64_t most_surface_samples = std::uint64_t{1} << 19U;

/// Refuses, before the search, requests that have no bound.
void refuse_what_has_no_bound(const FitProblem& problem) {
  if (problem.options.objective == FitObjective::size)
    refuse("`bound`: is of F, which `objective` size does not maximise");
  for (std::size_t i = 0; i < problem.series.size(); ++i) {
    if (!is_exact(problem.series[i])) {
      refuse(fmt::format("`bound`: {} has sizes to choose from, and the bound is of poses alone", problem.names[i]));
    }
    if (is_union_of_convex(bracket(problem.series[i]).largest)) continue;
    refuse(fmt::format("`bound`: {}: is known of unions of superquadrics without bends alone", problem.names[i]));
  }
}

/// Searches from the poses `tried` alone, where there are any.
Fit searched(const FitProblem& problem, const FitSolutionOptions& options, std::vector<Pose> tried) {
  FitOptions of_search = problem.options;
  of_search.constraints = planning::constraints_of(problem);
  of_search.contacts = planning::contacts_of(problem);
  if (!tried.empty()) of_search.samples = 1;
  of_search.tried = std::move(tried);
  of_search.interrupted = options.interrupted;
  of_search.out_of_time = options.search_out_of_time;
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

/// The trials of the search that chose the fit.
std::vector<FitTrial> trials_of(const FitProblem& problem, const Fit& fit) {
  std::vector<FitTrial> trials;
  trials.reserve(fit.finalists.size());
  for (const FitFinalist& finalist : fit.finalists) trials.push_back(untried(problem, finalist));
  return trials;
}

bool out_of_time(const FitSolutionOptions& options) {
  return options.out_of_time() || (options.search_out_of_time && options.search_out_of_time());
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
                    .out_of_time = [&options] { return out_of_time(options); },
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

void add_unfinished(FitProof& proof) {
  const MapSummary& map = proof.clearance.map;
  if (map.interrupted || map.out_of_time) proof.unfinished.emplace_back("vertices");
  if (proof.surface && proof.surface->interrupted) proof.unfinished.emplace_back("surface");
  if (proof.contact && proof.contact->interrupted) proof.unfinished.emplace_back("contact");
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
    // Two poses are tried, the first search's too, so that the result is no worse: a whole search would repeat itself.
    Fit again = searched(problem, options, {solution.bound->promising->pose, solution.fit.pose});
    if (again.interrupted || again.out_of_time) {
      solution.fit.interrupted = again.interrupted;
      solution.fit.out_of_time = again.out_of_time;
    } else if (again.within_limit >= solution.fit.within_limit && again.objective > solution.fit.objective) {
      again.finalists = std::move(solution.fit.finalists);
      again.poses += solution.fit.poses;
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
                         .interrupted = either(options.interrupted, options.out_of_time)});
}

FitProof prove_fit(const FitProblem& problem, const FitSolution& solution, const MapOptions& options,
                   const Sink<Point>& sink) {
  const std::function<bool()> stop = either(options.interrupted, options.out_of_time);
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
                              problem.options.penetration_limit, stop);
    if (!proof.sides->kept() && stop()) proof.unfinished.emplace_back("sides");
  }
  add_unfinished(proof);
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
  return !solution.fit.out_of_time && proof.unfinished.empty() && proof.clearance.map.wide == 0 &&
         proof.clearance.proven_too_deep == 0 && (!proof.surface || proof.surface->proven_too_deep == 0) &&
         (!proof.sides || proof.sides->kept()) && is_preserved(proof.changes, problem.kept) && contact_is_kept(proof) &&
         near_enough;
}

}  // namespace verisq
