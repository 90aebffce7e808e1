/// Two roundings an end.
#include "verify/proof/uncertain_distance.hpp"

#include <algorithm>

#include "verify/numbers/real.hpp"
#include "verify/proof/bracketed.hpp"

namespace verisq::verify {

namespace {

/// Rounded twice to one side, which is rounded once.
double sum(double a, double b, Direction direction) {
  return add(Real(a), Real(b), direction).to_double(direction);
}

}  // namespace

// A shift is 0 only where all translations are exact: it is rounded up.
MemberBounds::MemberBounds(const Bracket& bracket, double point_radius)
    : shift_(bracket.shift),
      other_shift_(point_radius),
      exact_(same_solids(bracket) && bracket.shift == 0.0 && point_radius == 0.0) {}

MemberBounds::MemberBounds(const Bracket& a, const Bracket& b)
    : shift_(a.shift),
      other_shift_(b.shift),
      exact_(same_solids(a) && same_solids(b) && a.shift == 0.0 && b.shift == 0.0) {}

double MemberBounds::upper(double of_smallest) const {
  return sum(sum(of_smallest, shift_, Direction::up), other_shift_, Direction::up);
}

// The same steps backwards: y <= claimed - radius and x <= y - shift give x + shift <= y and y + radius <= claimed,
// and rounding up to binary64 does not pass the binary64 numbers y and claimed. In turn x is not below an upper end
// that `upper` made `claimed` from.
double MemberBounds::upper_asked_for(double claimed) const {
  return sum(sum(claimed, -other_shift_, Direction::down), -shift_, Direction::down);
}

double MemberBounds::signed_lower(double of_largest, std::optional<double> of_inflated) const {
  double lower = sum(of_largest, -shift_, Direction::down);
  if (of_inflated) lower = lower > 0.0 ? std::max(lower, *of_inflated) : *of_inflated;
  return sum(lower, -other_shift_, Direction::down);
}

double MemberBounds::unsigned_lower(double of_largest) const {
  return std::max(0.0, sum(sum(of_largest, -shift_, Direction::down), -other_shift_, Direction::down));
}

}  // namespace verisq::verify
