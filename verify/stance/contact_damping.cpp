/// Bisects for the damping of a restitution, with proven signs.
///
/// f(D) = ln(1 + D) - ln(1 - D e) - D (1 + e) has f(0) = 0 and f'(D) = (1 + e) D (e (1 + D) - 1) / ((1 + D)(1 - D e)):
/// it falls on (0, 1/e - 1], rises on [1/e - 1, 1/e) and tends to infinity. So it has one positive root, which lies in
/// (1/e - 1, 1/e), and its sign at any D > 0 tells on which side of D that is.
///
/// The root falls as e rises: without gravity, dw/dx = -x^n (1/w + D) for the velocity w over the penetration x, whose
/// right side falls with D at each (x, w), so that a greater D means a smaller rebound e.
#include "verify/stance/contact_damping.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "verify/analysis/exponential.hpp"

namespace verisq::stance {

namespace {

/// As e tends to 1, f near its root shrinks as D^3: next to the root by a rounding error of D, to 2^-212 for
/// e = 1 - 2^-53, while its terms are about 2^-53.
using Digits = verify::MpfrNumber<319>;
using DampingInterval = verify::BasicInterval<Digits>;

enum class Side { below_root, above_root, unknown };

/// Precondition: damping > 0, 0 < restitution < 1.
Side side_of_root(double damping, double restitution) {
  const DampingInterval d{Digits(damping)};
  const DampingInterval e{Digits(restitution)};
  const DampingInterval one(1);
  const DampingInterval product = d * e;  // exact: 106 of 319 bits
  if (product.lower() >= one.lower()) return Side::above_root;
  if ((e + product).upper() <= one.upper()) return Side::below_root;
  const DampingInterval f = log1p(d) - log1p(-product) - d * (one + e);
  if (f.lower() > Digits(0)) return Side::above_root;
  if (f.upper() < Digits(0)) return Side::below_root;
  return Side::unknown;
}

/// Adjacent numbers between which `holds` changes from true to false. The search trusts its two ends.
template <class Predicate>
double last_that_holds(double last, double first_that_fails, const Predicate& holds) {
  for (;;) {
    const double middle = last + 0.5 * (first_that_fails - last);
    if (middle == last || middle == first_that_fails) return last;
    (holds(middle) ? last : first_that_fails) = middle;
  }
}

/// For one number e. An unknown side stops neither end, as it would a common bisection.
Interval root(double restitution) {
  if (restitution == 1.0) return 0;
  const Interval pole = Interval(1) / Interval(restitution);
  const double below = std::max(0.0, (pole - Interval(1)).lower());
  const double above = pole.upper();
  if (above > std::numeric_limits<double>::max()) return {below, above};
  const auto on = [&](Side side) { return [=](double damping) { return side_of_root(damping, restitution) == side; }; };
  return {last_that_holds(below, above, on(Side::below_root)), last_that_holds(above, below, on(Side::above_root))};
}

}  // namespace

Interval damping_factor(const Interval& restitution) {
  if (!(restitution.lower() > 0.0 && restitution.upper() <= 1.0)) {
    throw std::domain_error("contact damping: restitution outside (0, 1]");
  }
  return {root(restitution.upper()).lower(), root(restitution.lower()).upper()};
}

double damping_factor(double restitution) {
  return damping_factor(Interval(restitution)).lower();
}

}  // namespace verisq::stance
