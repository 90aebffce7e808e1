/// Boxes that hold one equilibrium each.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verify/proof/body_at_rest.hpp"

namespace verisq::verify {

// Boxes of 127-bit intervals, one side a variable.

using PreciseBox = std::vector<PreciseInterval>;

[[nodiscard]] inline PreciseInterval exact(double number) {
  return PreciseInterval(Real(number));
}

[[nodiscard]] inline PreciseBox exact(std::span<const double> numbers) {
  PreciseBox result;
  for (const double number : numbers) result.push_back(exact(number));
  return result;
}

[[nodiscard]] inline bool lies_within(const PreciseBox& inner, const PreciseBox& outer) {
  return std::ranges::equal(
      inner, outer, [](const auto& a, const auto& b) { return a.lower() >= b.lower() && a.upper() <= b.upper(); });
}

/// Without a common end.
[[nodiscard]] inline bool lies_inside(const PreciseBox& inner, const PreciseBox& outer) {
  return std::ranges::equal(
      inner, outer, [](const auto& a, const auto& b) { return a.lower() > b.lower() && a.upper() < b.upper(); });
}

/// The intersection of both boxes. Throws std::domain_error if it is empty.
[[nodiscard]] inline PreciseBox common(const PreciseBox& a, const PreciseBox& b) {
  PreciseBox result;
  for (std::size_t i = 0; i < a.size(); ++i)
    result.emplace_back(std::max(a[i].lower(), b[i].lower()), std::min(a[i].upper(), b[i].upper()));
  return result;
}

/// A number of the side, where it holds one of binary64; else one next to it.
[[nodiscard]] inline double middle_of(const PreciseInterval& side) {
  const double lower = side.lower().to_double(Direction::up);
  const double upper = side.upper().to_double(Direction::down);
  return std::clamp(0.5 * lower + 0.5 * upper, std::min(lower, upper), std::max(lower, upper));
}

[[nodiscard]] inline std::vector<double> middles_of(std::span<const PreciseInterval> box) {
  std::vector<double> result;
  for (const PreciseInterval& side : box) result.push_back(middle_of(side));
  return result;
}

[[nodiscard]] inline PreciseInterval dot(std::span<const double> a, std::span<const PreciseInterval> b) {
  PreciseInterval sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != 0.0) sum += exact(a[i]) * b[i];
  }
  return sum;
}

[[nodiscard]] inline PreciseInterval dot(std::span<const PreciseInterval> a, std::span<const PreciseInterval> b) {
  PreciseInterval sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Solutions of x = z + C x, by intervals that are mapped into their inside.

/// Rows of a matrix in floating point.
using ApproximateMatrix = std::vector<std::vector<double>>;

/// The approximate inverse of a square matrix, by Gauss and Jordan. Proofs that use it are sound whatever its entries
/// are. Nothing if the matrix seems singular.
[[nodiscard]] std::optional<ApproximateMatrix> approximate_inverse(ApproximateMatrix m);

/// The solutions of x = z + C x for all matrices of `c`: exactly one for each, and a box that contains them (Rump 1999,
/// theorem 10.2: z + C W inside W proves that the spectral radius of |C| is below 1).
struct FixedPoints {
  PreciseBox tried;  ///< the operator maps this box into its interior
  PreciseBox found;
};

/// `c` is a square matrix by its rows. Nothing if the solutions are not proven.
[[nodiscard]] std::optional<FixedPoints> fixed_points(const PreciseBox& z, const std::vector<PreciseBox>& c);

// Equilibria for all parameters of a box, beside the line that they follow to first order (docs/stance.md §7).

/// All postures of `postures` that are equilibria for a parameter of the box: one for each. Let x be the middle of the
/// postures, p the middle of the box and S the slopes. Then the postures are x + S (q - p) + e for q in the box.
class LocatedEquilibria {
 public:
  static std::optional<LocatedEquilibria> in(const StandingBody& body, const PreciseBox& box,
                                             const PreciseBox& postures);

  [[nodiscard]] const std::vector<std::uint32_t>& variables() const { return variables_; }

  /// The ranges of all components, with the unknowns in place of the components of the balance; then all others.
  [[nodiscard]] PreciseBox ranges() const;

  /// Total derivatives by a variable, in the order of `ranges`. Nothing if they are not proven to be bounded.
  [[nodiscard]] std::optional<PreciseBox> derivatives_by(std::size_t k) const;

  /// About where the postures of a part of the box lie, widened by the width of the errors: to be tried.
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

  /// The derivative of a component by a parameter while the posture follows the line.
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
  PreciseBox at_;                         ///< components at p and x
  ApproximateMatrix inverse_;             ///< C, of the derivatives of the balance by the unknowns, about
  ApproximateMatrix slopes_;              ///< S, of each unknown
  std::vector<PreciseBox> rest_;          ///< 1 - C times those derivatives
  PreciseBox deviations_;                 ///< q - p
  PreciseBox line_;                       ///< x + S (q - p)
  PreciseBox errors_;                     ///< e
};

}  // namespace verisq::verify
