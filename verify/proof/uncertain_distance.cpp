/// Two roundings an end.
#include "verify/proof/uncertain_distance.hpp"

#include <algorithm>

#include "verify/numbers/rounding.hpp"

namespace verisq::verify {

MemberBounds::MemberBounds(const Bracket& bracket, double point_radius)
    : shift_(bracket.shift), point_radius_(point_radius) {}

double MemberBounds::upper(double of_smallest) const {
  return add(add(of_smallest, shift_, Direction::up), point_radius_, Direction::up);
}

// The same steps backwards: y <= claimed - radius and x <= y - shift give x + shift <= y and y + radius <= claimed,
// and rounding up to binary64 does not pass the binary64 numbers y and claimed. In turn x is not below an upper end
// that `upper` made `claimed` from.
double MemberBounds::upper_asked_for(double claimed) const {
  return subtract(subtract(claimed, point_radius_, Direction::down), shift_, Direction::down);
}

double MemberBounds::signed_lower(double of_largest, std::optional<double> of_inflated) const {
  double lower = subtract(of_largest, shift_, Direction::down);
  if (of_inflated) lower = lower > 0.0 ? std::max(lower, *of_inflated) : *of_inflated;
  return subtract(lower, point_radius_, Direction::down);
}

double MemberBounds::triangle_lower(double of_largest) const {
  const double lower = subtract(subtract(of_largest, shift_, Direction::down), point_radius_, Direction::down);
  return std::max(0.0, lower);
}

}  // namespace verisq::verify
