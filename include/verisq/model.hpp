/// Solids: posed convex superquadrics and their union, exactly as the user's binary64 numbers state them.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace verisq {

/// A point or vector in model units: x, y, z.
using Point = std::array<double, 3>;

/// The solid of the paper's Eq. (1), centred at the origin, convex:
/// ((x/a1)^(2/e2) + (y/a2)^(2/e2))^(e2/e1) + (z/a3)^(2/e1) <= 1.
/// Precondition everywhere: semi-axes positive and finite, exponents in (0, 2].
struct Superquadric {
  std::array<double, 3> semi_axes;  ///< a1, a2, a3 in model units
  std::array<double, 2> exponents;  ///< e1 (along z), e2 (in the x-y section)
};

/// Rigid motion from a primitive's own frame to the model's: x -> R x + t, where R is the rotation of the
/// quaternion [w, x, y, z] divided by its exact length. Precondition: finite, quaternion not zero.
struct Pose {
  Point translation{0.0, 0.0, 0.0};
  std::array<double, 4> quaternion{1.0, 0.0, 0.0, 0.0};
};

struct Primitive {
  std::string name;
  Superquadric superquadric;
  Pose pose;
};

/// The union of its primitives. Precondition: at least one.
struct Model {
  std::string units;  ///< free text, as in the file ("mm"); empty when not given
  std::vector<Primitive> primitives;
};

}  // namespace verisq
