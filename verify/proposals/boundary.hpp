/// The surface of a superquadric in plain floating point: where rays leave it and its normals. Proposes, proves
/// nothing.
#pragma once

#include <array>

#include "verisq/model.hpp"

namespace verisq::verify {

/// All points and directions lie in the octant of nonnegative coordinates, in the solid's own frame; of a tapered solid
/// also below it, with z < 0. Float is double or long double.
template <class Float>
class Boundary {
 public:
  using Vector = std::array<Float, 3>;

  explicit Boundary(const Superquadric& solid);

  /// The gauge g of docs/mathematics.md §1 and §18.
  [[nodiscard]] Float gauge(const Vector& x) const;

  /// Unit outer normal of the level surface of g through x; at an edge or vertex one of the normals.
  [[nodiscard]] Vector normal(const Vector& x) const;

  /// The s >= 0 with g(q + s w) = level; zero when g(q) is not below it.
  [[nodiscard]] Float exit(const Vector& q, const Vector& w, Float level = 1) const;

 private:
  [[nodiscard]] Vector gradient(const Vector& x) const;
  [[nodiscard]] Float section(const Vector& x) const;
  [[nodiscard]] Float norm(const Vector& x) const;

  Vector semi_axes_;
  Float p1_, p2_;
  Float k_, fall_;  ///< of the taper: 0 and 1 without
};

extern template class Boundary<double>;
extern template class Boundary<long double>;

}  // namespace verisq::verify
