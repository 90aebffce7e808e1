/// What a piece of a triangle on a part of the way, seen by the resting implant, says of all of its distances.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "verify/placement/way_part.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"
#include "verisq/way_surface_certificate.hpp"

namespace verisq::verify {

/// A model's primitives. Precondition: a union of convex ones.
[[nodiscard]] std::vector<PosedSuperquadric> solids_of(const Model& model);

/// The ways of the piece's corners, all between the same times.
struct WayPrism {
  std::array<Chord, 3> corners;
  double off;  ///< how far the exact corners of the piece are from those whose ways these are, at most
};

/// Where the corners begin and where they end, each moved by the step, to nearest.
struct MovedPrism {
  Triangle begin, end;
};
[[nodiscard]] MovedPrism moved(const WayPrism& prism, const Point& step);

/// No point of the piece is farther, at any time of the part, from the convex hull of the moved corners; infinite for
/// what is not finite.
[[nodiscard]] double offset_of(const WayPrism& prism, const MovedPrism& hull);

/// From the middle of a solid to that of the hull, in the solid's own frame: a normal that may separate the two.
[[nodiscard]] Proposal outward_normal(const PosedSuperquadric& solid, const MovedPrism& hull);

/// No signed distance to the union of the solids in the cell is less; minus infinity where the certificate proves
/// nothing.
[[nodiscard]] double lower_end(std::span<const PosedSuperquadric> solids, const WayPrism& prism, const MovedCell& cell);

}  // namespace verisq::verify
