/// Equilibria over one box of parameters, by Krawczyk's operator (docs/stance.md §7).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/stance_equilibrium.hpp>

#include "verify/equilibrium/equilibrium_ranges.hpp"
#include "verify/stance/contraction.hpp"
#include "verify/stance/mean_value_range.hpp"
#include "verify/stance/standing_problem.hpp"

namespace verisq::stance {

/// A part of an equilibrium's components, by name.
[[nodiscard]] verify::EquilibriumRanges<verify::Interval> named(const StandingProblem& problem,
                                                                const IntervalVector& components);

struct CellVerdict {
  StandingVerdict verdict = StandingVerdict::open;
  IntervalVector components = {};  ///< ranges of what an equilibrium consists of, where it stands
  /// Then, by uncertain parameter: how much of each range's width is there because the sign of its derivative is open.
  std::vector<Eigen::VectorXd> unclear = {};
};

/// `parameters` has an interval for each parameter of the model.
[[nodiscard]] CellVerdict examine(const StandingProblem& problem, const Box& parameters);

/// The components at one sample, in plain floating point; nothing where it does not stand on all cylinders.
[[nodiscard]] std::optional<Eigen::VectorXd> sampled_equilibrium(const StandingProblem& problem,
                                                                 const std::vector<double>& parameters);

}  // namespace verisq::stance
