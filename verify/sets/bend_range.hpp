/// What a bend asks of the primitive that it bends, and how far it takes its points.
#pragma once

#include "verify/numbers/vector.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Rotation about z that takes the bend's frame (r, s, z) to the primitive's: columns (cos a, sin a, 0), (-sin a, cos
/// a, 0), (0, 0, 1).
[[nodiscard]] PreciseMatrix turn(const Bend& bend);

/// The largest |r| of the solid: its support function towards the direction of the bend.
[[nodiscard]] PreciseInterval extent(const Bend& bend, const Superquadric& superquadric);

/// Whether |k| times that is proven to be below 1: no point reaches the centre of the arc.
[[nodiscard]] bool keeps_off_its_centre(const Bend& bend, const Superquadric& superquadric);

/// Whether |k| a3 is proven to be below pi: the ends of the axis do not meet.
[[nodiscard]] bool is_less_than_a_full_turn(const Bend& bend, const Superquadric& superquadric);

/// Whether the points of the bent solid that lie deeper in it than `depth` are proven to be connected
/// (docs/mathematics.md §22). Precondition: depth >= 0, and both of the above.
[[nodiscard]] bool is_connected_below(double depth, const Bend& bend, const Superquadric& superquadric);

/// Contains the bent solid, in the bend's frame (R, S, Z). Precondition: both of the above.
[[nodiscard]] PreciseVector bent_box(const Bend& bend, const Superquadric& superquadric);

}  // namespace verisq::verify
