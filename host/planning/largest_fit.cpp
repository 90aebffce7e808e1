/// What may be largest is searched first; what is largest by its search is proven first.
#include "host/planning/largest_fit.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <verisq/signed_distance.hpp>

#include "host/planning/fit_conditions.hpp"
#include "host/planning/fit_constraints.hpp"
#include "host/planning/fit_contacts.hpp"

namespace verisq::planning {
namespace {

/// Of the bounding radius: the rows of a trial's proof need not be narrow.
constexpr double tolerance_of_rows = 1e-6;

/// An implant of the series, and what is known of it.
struct Member {
  std::size_t implant;
  double size;                 ///< that it may have at most, then what the search gave it
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
    for (Member* next = largest_open(); next != nullptr && !options_.interrupted(); next = largest_open()) {
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
  /// Of equals the earlier; nothing when all are searched and none is proven.
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
    of_search.progress = [this, i](const FitProgress& progress) {
      options_.progress({progress.objective, progress.done, i});
    };
    member.fit = fit({&problem_.series[i], 1}, problem_.cavity, of_search);
    member.fit->implant = i;
    for (FitFinalist& finalist : member.fit->finalists) finalist.implant = i;
    member.size = implant_size(member.fit->model);
  }

  /// What the search found no pose of within the limit is not tried. Rows are thrown away: the chosen one's are proven
  /// again for whoever wants them.
  void prove(Member& member) {
    if (!member.fit->within_limit) {
      member.open = {std::string(limit_condition)};
      member.proven = false;
      return;
    }
    const FitSolution found{.fit = *member.fit};
    const MapOptions of_map{.tolerance = tolerance_of_rows * bounding_radius(found.fit.model),
                            .device = problem_.options.device,
                            .interrupted = options_.interrupted};
    const FitProof proof =
        prove_fit(problem_, found, of_map, [](std::span<const Point>, std::span<const MapResult>, auto) {});
    for (const FitCondition& condition : proof.conditions) {
      if (condition.kept != true) member.open.push_back(condition.name);
    }
    member.proven = member.open.empty() && !options_.interrupted();
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
