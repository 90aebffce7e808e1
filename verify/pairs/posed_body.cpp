/// By the support function, turned and moved.
#include "verify/pairs/posed_body.hpp"

#include "verify/proof/certificate.hpp"

namespace verisq::verify {
namespace {

Coordinates<double> about(const PreciseVector& v) {
  const Proposal m = midpoint(v);
  return {static_cast<double>(m[0]), static_cast<double>(m[1]), static_cast<double>(m[2])};
}

}  // namespace

PosedBody::PosedBody(const PosedSuperquadric& solid, const ShortMotion& motion)
    : solid_(&solid),
      motion_(motion),
      place_(motion.pose().after(solid.motion())),
      centre_(about(place_.translation)),
      plain_(solid.superquadric()),
      rows_{about(place_.rotation.row(0)), about(place_.rotation.row(1)), about(place_.rotation.row(2))} {}

// v·x is at most minus the least of -v·x.
Real PosedBody::reach(const PreciseVector& v) const {
  const auto at_moment = [this](const PreciseVector& m) {
    return solid_->bounds().support_up(place_.rotation.transpose() * m);
  };
  const EnclosingSphere sphere{place_.translation, solid_->radius()};
  const PreciseInterval least = motion_.least_along(-v, sphere, place_.translation, at_moment);
  return (-PreciseInterval(least.lower()) - v.dot(precise(centre_))).upper();
}

Coordinates<double> PosedBody::farthest(const Coordinates<double>& v) const {
  Plain own{};
  for (std::size_t j = 0; j < 3; ++j) own[j] = rows_[0][j] * v[0] + rows_[1][j] * v[1] + rows_[2][j] * v[2];
  const Plain x = plain_(own);
  const Plain from_centre{dot(rows_[0], x), dot(rows_[1], x), dot(rows_[2], x)};
  const Plain way = about(motion_.first_way_of(precise(along(centre_, from_centre, 1.0))));
  return along(from_centre, way, dot(way, v) < 0.0 ? -1.0 : 1.0);
}

}  // namespace verisq::verify
