/// Frame and proofs of one superquadric together.
#include "verify/search/solid.hpp"

#include "verify/proof/intersection.hpp"
#include "verify/search/contact.hpp"
#include "verify/search/exterior.hpp"
#include "verify/search/interior.hpp"

namespace verisq::verify {

CertifiedDistance Solid::signed_distance(const Point& x, double tolerance) const {
  const PreciseVector q = posed_.frame().local_point(x);
  CertifiedDistance result = exterior_distance(posed_.superquadric(), posed_.bounds(), q, tolerance);
  if (result.distance.lo <= 0.0 && posed_.bounds().gauge(q).upper() <= Real(1)) {
    const CertifiedDistance inside = interior_distance(posed_.superquadric(), posed_.bounds(), q, tolerance);
    result.distance.hi = inside.distance.hi;
    if (inside.distance.lo > result.distance.lo) result = inside;
  }
  result.distance = between(result.distance.lo, result.distance.hi,
                            [&] { return "the signed distance of a superquadric at " + text_of(x); });
  return result;
}

double Solid::ray_clearance(const Point& x, const Proposal& u) const {
  const PreciseVector q = posed_.frame().local_point(x);
  const PreciseVector v = posed_.frame().local_direction(u);
  const PreciseInterval squared_length = square(v[0]) + square(v[1]) + square(v[2]);
  return ((posed_.bounds().support(v) - v.dot(q)) / squared_length).upper().to_double(Direction::up);
}

bool Solid::separated(const Point& x, const Proposal& u, double s) const {
  const PreciseVector q = posed_.frame().local_point(x) + posed_.frame().local_direction(u) * PreciseInterval(Real(s));
  if ((length<Real>(q) - posed_.radius()).lower() > Real(0)) return true;
  return lower_bound(posed_.bounds(), q, fast_contact(posed_.superquadric(), midpoint(q)).normal) > 0.0;
}

PreciseVector Solid::bounding_box() const {
  PreciseVector box;
  for (std::size_t i = 0; i < 3; ++i) {
    PreciseInterval half(0);
    for (std::size_t j = 0; j < 3; ++j) {
      half += abs(posed_.frame().rotation()(i, j)) * PreciseInterval(Real(posed_.superquadric().semi_axes[j]));
    }
    box[i] = posed_.frame().origin()[i] + PreciseInterval(-half.upper(), half.upper());
  }
  return box;
}

}  // namespace verisq::verify
