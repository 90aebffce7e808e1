/// Proves the first proposal, and a more precise one where the first leaves a gap.
#include "verify/exterior.hpp"

#include <algorithm>

#include "verify/contact.hpp"

namespace verisq::verify {

namespace {

/// Where the first proposal leaves more than this, in units of the largest length at hand, a second one is worth it.
constexpr double kExpectedWidth = 1e-14;

CertifiedDistance certified(const SuperquadricBounds<Real>& bounds, const PreciseVector& q, const Contact& contact) {
  return {{lower_bound(bounds, q, contact.normal), upper_bound(bounds, q, contact.point)}, contact.normal};
}

}  // namespace

CertifiedDistance exterior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                    const PreciseVector& q) {
  const Proposal middle = midpoint(q);
  const CertifiedDistance first = certified(bounds, q, fast_contact(solid, middle));
  const double reach = length<Real>(q).upper().to_double(Direction::up);
  const double expected = kExpectedWidth * std::max(reach, std::ranges::max(solid.semi_axes));
  if (first.distance.width() <= expected || bounds.gauge(q).lower() <= Real(1)) return first;
  const CertifiedDistance second = certified(bounds, q, thorough_contact(solid, middle));
  const bool better = second.distance.lo > first.distance.lo;
  return {{std::max(first.distance.lo, second.distance.lo), std::min(first.distance.hi, second.distance.hi)},
          better ? second.direction : first.direction};
}

}  // namespace verisq::verify
