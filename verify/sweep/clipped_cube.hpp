/// The volume that half-spaces leave of a cube.
#pragma once

#include <array>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// {e : normal·e <= offset}, e from the centre of a cube; what is meant is a set that contains it with the offset less
/// the error, and lies in it with the offset plus the error, in the same units.
struct CuttingPlane {
  Point normal;  ///< finite, not zero
  double offset;
  double error = 0.0;  ///< at least 0
};

[[nodiscard]] CuttingPlane opposite(const CuttingPlane& plane);

/// The largest value of normal·e over a cube, rounded up.
[[nodiscard]] double reach_up(const Point& normal, double half_width);

/// A cube, cut by one half-space after the other: tetrahedra in floating point, with a bound of what that loses
/// (docs/mathematics.md §23). Their coordinates are multiples of the half-width.
class ClippedCube {
 public:
  /// Precondition: a power of two, far from overflow and underflow of its cube.
  explicit ClippedCube(double half_width);

  void clip(const CuttingPlane& plane);

  /// Of what is meant; at least 0 and at most that of the cube.
  [[nodiscard]] Enclosure volume() const;

 private:
  using Tetrahedron = std::array<Point, 4>;

  double half_width_;
  double error_ = 0.0;  ///< of the volume so far, in cubic half-widths, rounded up
  std::vector<Tetrahedron> tetrahedra_;
};

}  // namespace verisq::verify
