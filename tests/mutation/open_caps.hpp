/// Caps of directions in one of which a ball leaves the solid: kernels/interior.clh must not prove them.
#pragma once

#include <string>
#include <vector>

#include "tests/mutation/launch.hpp"
#include "tests/mutation/way_out.hpp"

namespace verisq::mutation {

/// The entry point `open_caps`, to be appended to the kernels' sources: of each cap whether it is proven, the cosine of
/// the largest about the same direction that is, and the bound of second derivatives.
extern const char* const open_caps_kernel;

struct OpenCap {
  Point q;
  Point n;       ///< the cap's centre; of length 1, or shorter
  double size;   ///< the cap's directions w, |w| = 1, have |w - n| <= size
  double t;      ///< the ball's radius
  Point escape;  ///< one of them, where the ball leaves the solid
  double bend;   ///< a second derivative of g^p1 somewhere on the ways to the cap, less the rounding of long double
};

[[nodiscard]] OpenCap open_cap(oracle::RandomCases& random, const Norm& norm);

/// Operands of `open_caps`.
[[nodiscard]] Columns columns_of(const std::vector<OpenCap>& caps);

/// Whether a cap with this cosine about n holds the direction in which the ball leaves.
[[nodiscard]] bool holds(double cosine, const OpenCap& cap);

[[nodiscard]] std::string described(const OpenCap& cap);

}  // namespace verisq::mutation
