/// The surface of a superquadric in plain floating point: where rays leave it and its normals. Proposes, proves
/// nothing.
#pragma once

#include <array>

#include "verisq/model.hpp"

namespace verisq::verify {

/// All points and directions lie in the octant of nonnegative coordinates, in the solid's frame.
class Boundary {
 public:
  using Vector = std::array<double, 3>;

  explicit Boundary(const Superquadric& solid);

  /// The gauge g of design 2, §1.
  [[nodiscard]] double gauge(const Vector& x) const;

  /// Unit outer normal of the level surface of g through x; at an edge or vertex one of the normals.
  [[nodiscard]] Vector normal(const Vector& x) const;

  /// The s >= 0 with g(q + s w) = level; zero when g(q) is not below it.
  [[nodiscard]] double exit(const Vector& q, const Vector& w, double level = 1.0) const;

 private:
  [[nodiscard]] Vector gradient(const Vector& x, double gauge) const;
  [[nodiscard]] double section(const Vector& x) const;

  Vector semi_axes_;
  double p1_, p2_;
};

}  // namespace verisq::verify
