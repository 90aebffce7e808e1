/// Bends: where they take points, and how far.
#pragma once

#include <optional>

#include "verify/numbers/vector.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The bend of a primitive and its inverse, enclosed without cancellation for small curvatures
// (docs/mathematics.md §9).

/// In the plane of the bend let R lie along its direction, m = 1 - k R and W = |(m, k Z)|. The bent point (R, S, Z) has
/// the unbent coordinates r = (1 - W) / k, S, z = gamma / k, where gamma is the angle of (m, k Z). The half plane m <=
/// 0, Z = 0 is the cut, where z jumps between -pi/k and pi/k; no point of an admissible solid lies in it. T is double
/// or Real.
template <class T>
class BendMap {
 public:
  explicit BendMap(const Bend& bend);

  /// Inclusion function of the bend: x, y, z of the primitive's own frame before -> after.
  [[nodiscard]] Vector3<T> bent(const Vector3<T>& unbent) const;

  /// Inclusion function of the transposed derivative: (∂bent / ∂x)ᵀ v at x. If v is the gradient of a function of the
  /// bent point, the result is the function's gradient in x.
  [[nodiscard]] Vector3<T> pulled_back(const Vector3<T>& v, const Vector3<T>& unbent) const;

  /// Inclusion function of the inverse of the bend. At the cut both values of z are included.
  [[nodiscard]] Vector3<T> unbent(const Vector3<T>& bent) const;

  /// The same but for the sign of z: tight at the cut, where z changes its sign. It serves functions that are even in
  /// z.
  [[nodiscard]] Vector3<T> unbent_up_to_sign(const Vector3<T>& bent) const;

  /// The inverse about a bent point x: for every d whose part in the plane of the bend is at most `radius` long,
  ///   unbent(x + d) = centre + derivative d + a direction + b (0, 0, 1),  |a| <= radial, |b| <= axial.
  struct Expansion {
    Vector3<T> centre;
    Matrix3<T> derivative;
    T radial, axial;
  };

  /// Nothing if these points may meet the cut. Precondition: radius >= 0.
  [[nodiscard]] std::optional<Expansion> expansion(const Vector3<T>& bent, const T& radius) const;

  /// The unit vector along which R is measured.
  [[nodiscard]] Vector3<T> direction() const { return {cosine_, sine_, BasicInterval<T>(0)}; }

  /// (x, y, z) of the frame -> (R, S, Z)
  [[nodiscard]] Vector3<T> turned(const Vector3<T>& v) const;

 private:
  struct Polar;

  [[nodiscard]] Vector3<T> turned_back(const Vector3<T>& v) const;
  [[nodiscard]] Polar polar(const Vector3<T>& turned) const;
  [[nodiscard]] BasicInterval<T> radius(const Polar& polar) const;
  [[nodiscard]] BasicInterval<T> height_magnitude(const Polar& polar) const;
  [[nodiscard]] BasicInterval<T> height(const Polar& polar) const;

  BasicInterval<T> curvature_;
  BasicInterval<T> cosine_, sine_;  // of the direction's angle from x to y
};

extern template class BendMap<double>;
extern template class BendMap<Real>;

// The requirements of a bend on its primitive, and the distances by which it moves the primitive's points.

/// Rotation about z that takes the bend's frame (r, s, z) to the primitive's: columns (cos a, sin a, 0), (-sin a, cos
/// a, 0), (0, 0, 1).
[[nodiscard]] PreciseMatrix turn(const Bend& bend);

/// The largest |r| of the solid: its support function towards the direction of the bend.
[[nodiscard]] PreciseInterval extent(const Bend& bend, const Superquadric& superquadric);

/// Returns whether the points of the bent solid that lie deeper in it than `depth` are proven to be connected
/// (docs/mathematics.md §22). Preconditions: depth >= 0, and the precondition of Bend.
[[nodiscard]] bool is_connected_below(double depth, const Bend& bend, const Superquadric& superquadric);

/// A box, in the bend's frame (R, S, Z), that contains the bent solid. Precondition: the precondition of Bend.
[[nodiscard]] PreciseVector bent_box(const Bend& bend, const Superquadric& superquadric);

}  // namespace verisq::verify
