/// Where an equilibrium is, for every parameter of a box, by Krawczyk's operator (docs/stance.md §7).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "verify/stance/equilibrium_components.hpp"

namespace verisq::stance {

/// The components G, of which the first are F, what is missing for the balance, about parameters p_0 and a posture u:
/// row by row by the mean value theorem, first along the parameters P at u, then along the posture. With R near the
/// inverse of dF/du, every equilibrium u + e at a p of the box, e within E, has
///
///     e = -R F(u, p_0) - sum of (R dF/dp_k(u, P)) (p_k - p_0k) + (I - R dF/du(u + E, P)) e.
///
/// Derivatives meet R before the deviation does.
struct BalanceExpansion {
  std::vector<double> parameters, posture;     ///< p_0, which is all of a side without width, and u
  Eigen::MatrixXd inverse = {};                ///< R
  IntervalVector values = {};                  ///< G(u, p_0)
  std::vector<IntervalVector> variation = {};  ///< dG/dp_k(u, P)
  IntervalVector newton = {};                  ///< -R F(u, p_0)
  IntervalVector constant = {};                ///< what does not depend on e

  /// Nothing where dF/du is singular at the centres.
  [[nodiscard]] static std::optional<BalanceExpansion> about(const StandingProblem& problem, const Box& box,
                                                             std::vector<double> parameters,
                                                             std::vector<double> posture);

  /// I - R dF/du over `unknowns`.
  [[nodiscard]] IntervalMatrix rest(const StandingProblem& problem, const Box& box,
                                    const std::vector<verify::Interval>& unknowns) const;
};

/// For every parameter p of a box there is exactly one equilibrium u(p) in the box `alone`, and all lie in `unknowns`:
/// the expansion's right side maps a symmetric E into its interior, and contracts (Krawczyk 1969; Rump 1983).
struct Located {
  BalanceExpansion expansion;
  std::vector<verify::Interval> alone = {}, unknowns = {};
  IntervalMatrix rest = {};    ///< over `alone`
  IntervalMatrix slopes = {};  ///< dG/du over the unknowns
  IntervalVector errors = {};  ///< unknowns - u

  /// The components over the box: G(u, p_0) + sum of (dG/dp_k - dG/du R dF/dp_k) (p_k - p_0k) + dG/du (-R F + rest e).
  [[nodiscard]] IntervalVector ranges(const StandingProblem& problem, const Box& box) const;

  /// du/dp_k over the box; nothing where the contraction does not show.
  [[nodiscard]] std::optional<IntervalVector> posture_by(const StandingProblem& problem, const Box& box,
                                                         std::uint32_t parameter) const;
};

[[nodiscard]] std::optional<Located> locate(const StandingProblem& problem, const Box& box);

/// In plain floating point, by Newton's method from the file's posture.
[[nodiscard]] std::vector<double> approximate_equilibrium(const StandingProblem& problem,
                                                          const std::vector<double>& parameters);

[[nodiscard]] bool lies_within(const std::vector<verify::Interval>& inner, const std::vector<verify::Interval>& outer);

}  // namespace verisq::stance
