/// Cubes of the model frame, and statements about a set within one of them (docs/mathematics.md §10).
#pragma once

#include <cstdint>

#include "verisq/model.hpp"

namespace verisq::verify {

/// {x : |x_i - centre_i| <= half_width}. A half-width of 0 makes it a point.
struct Cube {
  Point centre;
  double half_width;
};

/// The proven colour of a closed set in a cube. Both proofs are strict: a set and the closure of its complement, which
/// share their boundary, then have opposite colours.
enum class Colour : std::uint8_t {
  white,  ///< no point of the cube lies in the set
  gray,   ///< nothing
  black,  ///< the cube lies in the interior of the set
};

/// A primitive K, or the closure of its complement.
enum class Side : std::uint8_t { inside, outside };

/// {x : normal . (x - centre of the cube) <= offset}, the numbers taken as exact. An infinite offset proves nothing.
struct HalfSpace {
  Point normal;
  double offset;
};

}  // namespace verisq::verify
