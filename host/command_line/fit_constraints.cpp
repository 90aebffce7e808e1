/// What an implant changes of a bone's features, as ranges that a fit keeps to.
#include "host/command_line/fit_constraints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <verisq/posed_model.hpp>

#include "host/command_line/refusal.hpp"

namespace verisq::command_line {
namespace {

/// Of what is not known in a pose: broken, and finite for the search.
constexpr Enclosure unknown{-1e9, 1e9};

const Feature* feature_of(const FemurFeatures& changes, const std::string& name) {
  const auto found = std::ranges::find(changes.features, name, &Feature::name);
  return found == changes.features.end() ? nullptr : &*found;
}

}  // namespace

FemurFeatures changes_of(const FitProblem& problem, double landmark_radius, std::size_t implant, const Pose& pose) {
  return implant_changes(problem.bone->landmarks, problem.bone->side, landmark_radius,
                         posed(problem.landmarks[implant], pose));
}

/// Whatever the pose is, the same landmarks are there.
void check_kept(const FitArguments& arguments, const FitProblem& problem) {
  if (arguments.landmarks.empty()) {
    if (!arguments.kept.empty()) refuse("--keep: needs --landmarks, the bone's");
    return;
  }
  for (std::size_t i = 0; i < problem.series.size(); ++i) {
    const FemurFeatures changes =
        changes_of(problem, arguments.landmark_radius, i, arguments.pose_start.value_or(Pose{}));
    for (const KeptFeature& kept : arguments.kept) {
      if (feature_of(changes, kept.name) != nullptr) continue;
      std::vector<std::string> known;
      for (const Feature& feature : changes.features) known.push_back(feature.name);
      const std::string why = changes.missing.empty() ? "" : fmt::format(" ({})", fmt::join(changes.missing, "; "));
      refuse(fmt::format("--keep {}: {} and {} say nothing of it; known are {}{}", kept.name, arguments.landmarks,
                         arguments.implants[i], known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")),
                         why));
    }
  }
}

std::vector<FitConstraint> constraints_of(const FitArguments& arguments, const FitProblem& problem) {
  std::vector<FitConstraint> constraints;
  for (const KeptFeature& kept : arguments.kept) {
    const auto value = [&problem, name = kept.name, radius = arguments.landmark_radius](std::size_t implant,
                                                                                        const Pose& pose) {
      const FemurFeatures changes = changes_of(problem, radius, implant, pose);
      const Feature* feature = feature_of(changes, name);
      return feature == nullptr ? unknown : feature->value;
    };
    constraints.push_back({.name = kept.name, .range = kept.range, .unit = 1.0, .value = value});
  }
  return constraints;
}

}  // namespace verisq::command_line
