/// Proposes the point of a triangle that is closest to a superquadric.
///
/// Half the squared distance f of a point to the solid is convex with the continuous gradient q - x, x being the
/// point's closest point of the solid (verify/search/contact.hpp). Least over the triangle it is
///  - in the interior only where the gradient is normal to the plane: in closed form by the support point of the solid
///    towards the plane, or, where the plane cuts the solid, by the point of the plane with the least gauge, which is
///    the solid's support point along the plane's normal, scaled;
///  - else on an edge, where the derivative along the edge is monotone: a bracketed root. The edge is the right one if
///  f
///    does not fall from there towards the opposite corner;
///  - where the solid has flat facets (e = 2) parallel to the plane, at none of these, perhaps: then by nested roots.
#pragma once

#include <array>
#include <functional>

#include "verify/proof/triangle_certificate.hpp"

namespace verisq::verify {

/// Offers weights of points, the most promising first, until `enough` returns true. Corners and the normal of the
/// triangle's plane, of any length, in the solid's frame; a degenerate triangle may come with any normal.
void offer_closest_points(const Superquadric& solid, const std::array<Proposal, 3>& corners, const Proposal& normal,
                          const std::function<bool(const Weights&)>& enough);

}  // namespace verisq::verify
