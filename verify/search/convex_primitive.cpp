/// Motion and proofs of one superquadric together.
#include "verify/search/convex_primitive.hpp"

#include "verify/proof/intersection.hpp"
#include "verify/search/contact.hpp"
#include "verify/search/exterior.hpp"
#include "verify/search/interior.hpp"

namespace verisq::verify {

CertifiedDistance ConvexPrimitive::signed_distance(const Point& x, double tolerance) const {
  const PreciseVector q = proof_.motion().local_point(x);
  CertifiedDistance result = exterior_distance(proof_.superquadric(), proof_.bounds(), q, tolerance);
  if (result.distance.lo <= 0.0 && proof_.bounds().gauge(q).upper() <= Real(1)) {
    const CertifiedDistance inside = interior_distance(proof_.superquadric(), proof_.bounds(), q, tolerance);
    result.distance.hi = inside.distance.hi;
    if (inside.distance.lo > result.distance.lo) result = inside;
  }
  result.distance = between(result.distance.lo, result.distance.hi,
                            [&] { return "the signed distance of a superquadric at " + text_of(x); });
  return result;
}

double ConvexPrimitive::ray_clearance(const Point& x, const Proposal& u) const {
  const PreciseVector q = proof_.motion().local_point(x);
  const PreciseVector v = proof_.motion().rotation.transpose() * precise(u);
  const PreciseInterval squared_length = square(v[0]) + square(v[1]) + square(v[2]);
  return ((proof_.bounds().support(v) - v.dot(q)) / squared_length).upper().to_double(Direction::up);
}

bool ConvexPrimitive::separated(const Point& x, const Proposal& u, double s) const {
  const PreciseVector q =
      proof_.motion().local_point(x) + proof_.motion().rotation.transpose() * precise(u) * PreciseInterval(Real(s));
  if ((length<Real>(q) - proof_.radius()).lower() > Real(0)) return true;
  return lower_bound(proof_.bounds(), q, fast_contact(proof_.superquadric(), midpoint(q)).normal) > 0.0;
}

PreciseVector ConvexPrimitive::bounding_box() const {
  return proof_.motion()(proof_.box());
}

}  // namespace verisq::verify
