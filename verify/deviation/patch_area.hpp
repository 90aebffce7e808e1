/// How large a patch is, and how evenly its parameters cover it (docs/mathematics.md §20).
#pragma once

#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// With (u, t) in [0, 1]² the shares of both chords, a patch's point stands over its foot, and over the point of the
/// two triangles `Patch::halves` with the same shares. `density` is the patch's area by du dt.
struct PatchArea {
  Enclosure area;         ///< finite below sizes of 1e150; lower ends of patches that do not hold each other add up
  double unevenness;      ///< no less than (greatest density - least) / mean density; infinite where
                          ///< nothing is known
  double correspondence;  ///< how far a point is from that of the same shares on the triangles, at most
};

}  // namespace verisq::verify
