/// The root that a taper makes the support function of: of ‖(r, Z + k τ)‖_q = τ, in floating point and enclosed.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "verify/analysis/fifty_digits.hpp"
#include "verify/analysis/planar_norm.hpp"

namespace verisq::verify {

/// With r the norm of a direction's section, Z = a3 v_z and the excess q - 1 of the outer norm (docs/mathematics.md
/// §18). f(τ) = ‖(r, Z + k τ)‖ - τ is convex and falls, with a slope between -1 - |k| and -1 + |k|.
template <class Number>
struct RootEquation {
  Number section;
  Number height;
  Number k;
  Number excess;

  [[nodiscard]] Number moved(const Number& root) const { return height + k * root; }

  /// ‖(r, |Z + k τ|)‖; `dy` is its derivative by the second.
  [[nodiscard]] PlanarNorm<Number> norm(const Number& root) const {
    using std::abs;
    return ordered_planar_norm<Number>(section, Number(abs(moved(root))), excess);
  }
};

/// By Newton's method, which ascends from where f is not negative. Precondition: section > 0.
template <class Float>
[[nodiscard]] Float root_of(const RootEquation<Float>& equation) {
  const auto& [section, height, k, excess] = equation;
  Float root = std::max({section, Float(height / (1 - k)), Float(-height / (1 + k))});
  for (int i = 0; i < 100; ++i) {
    const PlanarNorm<Float> norm = equation.norm(root);
    const Float slope = (equation.moved(root) < 0 ? Float(-k) : k) * norm.dy - 1;
    const Float step = (root - norm.value) / slope;
    root += step;
    if (!(step > 4 * std::numeric_limits<Float>::epsilon() * root)) break;
  }
  return root;
}

/// The roots for all numbers of the intervals: about one of them, τ, by f(τ) and f's slopes, first any that it can
/// have, then those between τ and the roots that these leave (mean value theorem). Throws std::domain_error where
/// section may be 0.
[[nodiscard]] inline PreciseInterval root_of(const RootEquation<PreciseInterval>& equation) {
  const auto middle = [](const PreciseInterval& x) {
    return FiftyDigits((to_fifty_digits(x.lower()) + to_fifty_digits(x.upper())) / 2);
  };
  if (!(equation.section.lower() > Real(0))) throw std::domain_error("support function: a section may vanish");
  const PreciseInterval root(to_real(root_of<FiftyDigits>(
      {middle(equation.section), middle(equation.height), middle(equation.k), middle(equation.excess)})));
  const PreciseInterval one(1);
  const PreciseInterval f = equation.norm(root).value - root;
  const PreciseInterval most = abs(equation.k);
  const PreciseInterval any_slope = hull(one - most, one + most);  // but for the sign
  const PreciseInterval near_root = hull(root, root + f / any_slope);
  const PreciseInterval moved = equation.moved(near_root);
  const PreciseInterval dy = equation.norm(near_root).dy;
  const PreciseInterval share(std::max(Real(0), dy.lower()), std::min(Real(1), dy.upper()));
  const PreciseInterval slope = one - equation.k * sign_of<PreciseInterval>(moved) * share;
  const PreciseInterval found = root + f / slope;
  return {std::max(found.lower(), near_root.lower()), std::min(found.upper(), near_root.upper())};
}

}  // namespace verisq::verify
