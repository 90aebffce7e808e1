/// What an implant changes of a bone's features, as ranges that a fit keeps to.
#include "host/planning/fit_constraints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <verisq/posed_model.hpp>

#include "host/errors/refusal.hpp"

namespace verisq {
namespace {

/// Of what is not known in a pose: broken, and finite for the search.
constexpr Enclosure unknown_change{-1e9, 1e9};

const Feature* feature_of(const FemurFeatures& changes, const std::string& name) {
  const auto found = std::ranges::find(changes.features, name, &Feature::name);
  return found == changes.features.end() ? nullptr : &*found;
}

}  // namespace

FemurFeatures changes_of(const FitProblem& problem, std::size_t implant, const Pose& pose) {
  if (!problem.bone) return {};
  return implant_changes(problem.bone->points, problem.bone->side, problem.bone->radius,
                         posed(problem.implant_landmarks[implant], pose));
}

std::optional<bool> is_within(const Enclosure& value, const Enclosure& range) {
  if (value.lo >= range.lo && value.hi <= range.hi) return true;
  if (value.hi < range.lo || value.lo > range.hi) return false;
  return std::nullopt;
}

bool is_preserved(const FemurFeatures& changes, std::span<const KeptFeature> kept) {
  return std::ranges::all_of(kept, [&](const KeptFeature& each) {
    const Feature* const change = feature_of(changes, each.name);
    return change != nullptr && is_within(change->value, each.range) == true;
  });
}

namespace planning {

/// Whatever the pose is, the same landmarks are there.
void check_kept(const FitProblem& problem) {
  if (!problem.bone) {
    if (!problem.kept.empty()) refuse("--keep: needs --landmarks, the bone's");
    return;
  }
  for (std::size_t i = 0; i < problem.series.size(); ++i) {
    const FemurFeatures changes = changes_of(problem, i, problem.options.range.start);
    for (const KeptFeature& kept : problem.kept) {
      if (feature_of(changes, kept.name) != nullptr) continue;
      std::vector<std::string> known;
      for (const Feature& feature : changes.features) known.push_back(feature.name);
      const std::string why = changes.missing.empty() ? "" : fmt::format(" ({})", fmt::join(changes.missing, "; "));
      refuse(fmt::format("--keep {}: {} and {} say nothing of it; known are {}{}", kept.name, problem.bone->name,
                         problem.names[i], known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")), why));
    }
  }
}

std::vector<FitConstraint> constraints_of(const FitProblem& problem) {
  std::vector<FitConstraint> constraints;
  for (const KeptFeature& kept : problem.kept) {
    const auto value = [&problem, name = kept.name](std::size_t implant, const Pose& pose) {
      const FemurFeatures changes = changes_of(problem, implant, pose);
      const Feature* const feature = feature_of(changes, name);
      return feature == nullptr ? unknown_change : feature->value;
    };
    constraints.push_back({.name = kept.name, .range = kept.range, .unit = 1.0, .value = value});
  }
  return constraints;
}

}  // namespace planning
}  // namespace verisq
