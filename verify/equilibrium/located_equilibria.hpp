/// Equilibria for all parameters of a box, beside the line that they follow to first order (docs/stance.md §7).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/equilibrium/differentiated.hpp"
#include "verify/equilibrium/fixed_points.hpp"
#include "verify/equilibrium/precise_box.hpp"
#include "verify/equilibrium/standing_body.hpp"

namespace verisq::verify {

/// All postures of `postures` that are equilibria for a parameter of the box: one for each. With x the middle of the
/// postures and p that of the box, they are x + S (q - p) + e for q in the box, S being the slopes.
class LocatedEquilibria {
 public:
  static std::optional<LocatedEquilibria> in(const StandingBody& body, const PreciseBox& box,
                                             const PreciseBox& postures);

  [[nodiscard]] const std::vector<std::uint32_t>& variables() const { return variables_; }

  /// The unknowns, in place of what is missing for the balance; then all others.
  [[nodiscard]] PreciseBox ranges() const;

  /// Total derivatives by a variable, as `ranges`: nothing where they are not proven to be bounded.
  [[nodiscard]] std::optional<PreciseBox> derivatives_by(std::size_t k) const;

  /// Where the postures of a part of the box lie, and the width of the errors about them: to be tried.
  [[nodiscard]] PreciseBox about(const PreciseBox& part) const;

 private:
  LocatedEquilibria(const StandingBody& body, const PreciseBox& box, const PreciseBox& postures);

  [[nodiscard]] std::size_t unknowns() const { return middle_.size(); }
  [[nodiscard]] std::span<const PreciseInterval> by_unknowns(std::size_t c) const {
    return std::span(over_[c].by).first(unknowns());
  }
  [[nodiscard]] const PreciseInterval& by_variable(std::size_t c, std::size_t k) const {
    return over_[c].by[unknowns() + k];
  }

  [[nodiscard]] PreciseBox middle_parameters() const;

  /// Of a component by a parameter while the posture follows the line.
  [[nodiscard]] PreciseInterval along_line(std::size_t c, std::size_t k) const;

  /// -C v
  [[nodiscard]] PreciseBox preconditioned(const PreciseBox& v) const;

  bool locate(const PreciseBox& postures);

  /// -C times the derivatives by the parameters, about.
  void set_slopes();

  PreciseBox box_;
  std::vector<double> middle_;            ///< x
  std::vector<std::uint32_t> variables_;  ///< uncertain parameters that are no points
  std::vector<Differentiated> over_;      ///< all components, over the box and the postures
  PreciseBox at_;                         ///< of p and x
  ApproximateMatrix inverse_;             ///< C, of the derivatives of the balance by the unknowns, about
  ApproximateMatrix slopes_;              ///< S, of each unknown
  std::vector<PreciseBox> rest_;          ///< 1 - C times those derivatives
  PreciseBox deviations_;                 ///< q - p
  PreciseBox line_;                       ///< x + S (q - p)
  PreciseBox errors_;                     ///< e
};

}  // namespace verisq::verify
