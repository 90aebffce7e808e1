/// The best of some normals, chosen in floating point; then what it proves.
#include "verify/search/half_space_bound.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "verify/proof/triangle_certificate.hpp"
#include "verify/proposals/best_normal.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Plain = Coordinates<double>;

Plain about(const PreciseVector& x) {
  const Proposal middle = midpoint(x);
  return {static_cast<double>(middle[0]), static_cast<double>(middle[1]), static_cast<double>(middle[2])};
}

}  // namespace

HalfSpaceBound::HalfSpaceBound(const Model& model) {
  for (const Primitive& primitive : model.primitives) {
    const Superquadric& solid = primitive.superquadric;
    solids_.push_back({PosedSuperquadric(primitive), NearestNormal(solid), SuperquadricSet<double>(solid)});
  }
}

/// The normal of the surface where it is nearest to the centroid, or that of the triangle.
double HalfSpaceBound::lower(const Solid& solid, const Triangle& triangle) {
  const PosedTriangle posed(triangle, solid.posed.motion());
  TriangleSet<double> set{};
  std::ranges::transform(posed.corners(), set.corners.begin(), about);
  const auto& [a, b, c] = set.corners;
  BestNormal best(solid.set, set);
  best.offer(
      solid.nearest({(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0}).normal);
  best.offer_normals_of(set.corners);
  const Plain& n = best.normal();
  return lower_by_normal(solid.posed, posed, {n[0], n[1], n[2]});
}

/// Let every point of the triangle lie at least m > 0 away from all primitives but K, and less than m deep in K. A ball
/// about it in the union, of a radius of at most m, lies in K. So the point lies in the union no deeper than in K.
double HalfSpaceBound::operator()(const Triangle& triangle) const {
  double least = infinity;        // of those that no point lies in
  std::optional<double> entered;  // of the one that some may lie in
  for (const Solid& solid : solids_) {
    const double by_sphere = lower_by_sphere(solid.posed, triangle);
    const bool far = PreciseInterval(Real(by_sphere)).lower() > solid.posed.radius().upper();
    const double bound = far ? by_sphere : lower(solid, triangle);
    if (bound > 0.0) {
      least = std::min(least, bound);
    } else {
      if (entered) return -infinity;
      entered = bound;
    }
  }
  if (!entered) return least;
  return -*entered < least ? *entered : -infinity;
}

}  // namespace verisq::verify
