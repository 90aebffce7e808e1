/// A convex arc in the plane, known by its ends and the tangents there: its length, its bulge, how fast its foot on the
/// chord lets it pass (docs/mathematics.md §20).
#pragma once

#include <array>
#include <optional>

#include "verify/numbers/interval.hpp"

namespace verisq::verify {

using PlaneVector = std::array<Interval, 2>;

/// Tangents of any length but 0, in the sense of the way.
struct PlaneArc {
  PlaneVector from;
  PlaneVector to;
  PlaneVector tangent_from;
  PlaneVector tangent_to;
};

struct ArcBounds {
  Interval chord;    ///< its length
  Interval stretch;  ///< of the arc over its chord, everywhere: from 1
  Interval lens;     ///< the area between arc and chord: from 0
  double bulge;      ///< no point of the arc is farther from its foot
  /// The derivative by the share u of the chord lies on the segment between these two: here its components' hulls.
  PlaneVector speed;
};

/// Nothing unless both tangents are proven to point forward along the chord.
[[nodiscard]] std::optional<ArcBounds> bounds_of(const PlaneArc& arc);

}  // namespace verisq::verify
