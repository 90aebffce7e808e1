/// Proves the first proposal, and more precise ones where it leaves a gap.
#include "verify/search/exterior.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "verify/proof/intersection.hpp"
#include "verify/proposals/boundary.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/proposals/triangle.hpp"
#include "verify/search/contact.hpp"

namespace verisq::verify {

namespace {

/// Where a proposal leaves more than this, in units of the largest length at hand, a better one is worth it.
constexpr double kExpectedWidth = 1e-14;

/// GJK's share of the tolerance. Its point is a chord's, below the surface: moved along the ray from the centre up to
/// the surface of a solid with axes 1:400 it is farther by 400 times its depth.
constexpr double kShareOfTolerance = 1e-4;

/// GJK is not trusted with distances below this, in units of the size.
constexpr double kNearest = 1e-3;
/// Points as far as the size take 5 to 20 steps, points beside the surface 60.
constexpr int kMostSteps = 24;

Coordinates<double> rounded(const Proposal& x) {
  return {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
}

Proposal widened(const Coordinates<double>& x) {
  return {x[0], x[1], x[2]};
}

/// Nothing where GJK does not separate q from the solid, or only just: beside the surface binary64 has no digits left
/// for its direction, the moved point is not where the certificate's vector leads, and `fast_contact` is faster.
std::optional<Contact> gjk_contact(const Superquadric& solid, const Proposal& q, double tolerance) {
  const Coordinates<double> point = rounded(q);
  const GjkResult<double> found = gjk<double>(SuperquadricSet<double>(solid), PointSet<double>{point}, point,
                                              {.absolute = kShareOfTolerance * tolerance, .most_steps = kMostSteps});
  if (!(found.lower > kNearest * std::ranges::max(solid.semi_axes))) return std::nullopt;
  // The direction that leads to the point, not the best one of the search: a certificate stores one vector for both.
  const Proposal x = widened(found.on_a);
  return Contact{x, {q[0] - x[0], q[1] - x[1], q[2] - x[2]}};
}

/// The foot of a contact with the gradient of the gauge there instead of what leads to q: hardly off a flat face of a
/// tapered solid the difference of both knows its direction to some digits alone, because the height has been rounded.
Contact with_own_normal(const Superquadric& solid, const Contact& contact) {
  const Proposal& x = contact.point;
  const auto n = Boundary<long double>(solid).normal({std::fabs(x[0]), std::fabs(x[1]), x[2]});
  return {x, {std::copysign(n[0], x[0]), std::copysign(n[1], x[1]), n[2]}};
}

CertifiedDistance certified(const SuperquadricBounds<Real>& bounds, const PreciseVector& q, const Contact& contact) {
  return {{lower_bound(bounds, q, contact.normal), upper_bound(bounds, q, contact.point)},
          contact.normal,
          difference(midpoint(q), contact.point)};
}

CertifiedDistance best_of(const CertifiedDistance& a, const CertifiedDistance& b, const PreciseVector& q) {
  const auto what = [&] {
    return "the distance of a superquadric to " + text_of(rounded(midpoint(q))) + " in its frame";
  };
  return {intersection(a.distance, b.distance, what), b.distance.lo > a.distance.lo ? b.direction : a.direction,
          b.distance.hi < a.distance.hi ? b.witness : a.witness};
}

}  // namespace

CertifiedDistance exterior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                    const PreciseVector& q, double tolerance) {
  const Proposal middle = midpoint(q);
  const double reach = length<Real>(q).upper().to_double(Direction::up);
  const double expected = kExpectedWidth * std::max(reach, std::ranges::max(solid.semi_axes));
  std::optional<CertifiedDistance> best;
  const auto prove = [&](const Contact& contact) {
    const CertifiedDistance proven = certified(bounds, q, contact);
    best = best ? best_of(*best, proven, q) : proven;
    return best->distance.width() <= std::max(tolerance, expected);
  };
  // Binary64 does for a tolerance; the tightest enclosure of a point beside the surface takes long double.
  if (tolerance > expected) {
    const std::optional<Contact> contact = gjk_contact(solid, middle, tolerance);
    if (contact && prove(*contact)) return *best;
  }
  const Contact fast = fast_contact(solid, middle);
  if (prove(fast) || bounds.gauge(q).lower() <= Real(1)) return *best;
  if (is_tapered(solid)) {
    const Contact own = with_own_normal(solid, fast);
    if (usable(own.normal) && prove(own)) return *best;
  }
  prove(thorough_contact(solid, middle));
  return *best;
}

}  // namespace verisq::verify
