/// How much of a cube lies in a set that half-spaces enclose from within and from without (docs/mathematics.md §23).
#pragma once

#include <array>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// Values at the corners of a cube, of which the one k lies at the larger x, y, z where bit 0, 1, 2 of k is set. They
/// are those of a function that is linear on each of the six tetrahedra between the corner 0 and the corner 7 along the
/// edges; meant is the part of the cube where it is not positive.
using CornerHeights = std::array<Interval, 8>;

/// Of a function that is linear on the whole cube: its value at the centre, and by how much it rises from there to the
/// sides of larger x, y and z.
[[nodiscard]] CornerHeights linear_heights(const Interval& at_centre, const Vector3<double>& rise);

[[nodiscard]] CornerHeights negative(const CornerHeights& heights);

/// The union of such parts; of none it is empty.
using UnionOfParts = std::vector<CornerHeights>;

/// The intersection of such unions; of none it is the whole cube.
using PartOfCube = std::vector<UnionOfParts>;

/// A set of which the one is a part, and which is a part of the other.
struct BracketedPart {
  PartOfCube inner;
  PartOfCube outer;
};

/// Nothing of the cube, and nothing known.
void leave_nothing(BracketedPart& part);
void leave_unknown(BracketedPart& part);

/// Encloses the volume of the set in a cube of this half-width.
[[nodiscard]] Enclosure volume_in_cube(double half_width, const BracketedPart& part);

/// That of the whole cube.
[[nodiscard]] Interval volume_of_cube(double half_width);

}  // namespace verisq::verify
