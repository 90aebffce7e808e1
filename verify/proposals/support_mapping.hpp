/// Support mappings of convex sets in plain floating point: what GJK sees of a set.
#pragma once

#include <array>

#include "verify/proposals/triangle.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// A single point.
template <class Float>
struct PointSet {
  Coordinates<Float> point;

  [[nodiscard]] Coordinates<Float> operator()(const Coordinates<Float>&) const { return point; }
};

/// A triangle, which may be degenerate.
template <class Float>
struct TriangleSet {
  std::array<Coordinates<Float>, 3> corners;

  [[nodiscard]] Coordinates<Float> operator()(const Coordinates<Float>& v) const {
    const std::array values{dot(v, corners[0]), dot(v, corners[1]), dot(v, corners[2])};
    const std::size_t first = values[1] > values[0] ? 1 : 0;
    return corners[values[2] > values[first] ? 2 : first];
  }
};

/// A superquadric in its own frame: Eq. (5) of the paper at the angles of Eqs. (14) and (15), without the angles. With
/// X = a1 |v1|, Y = a2 |v2| and q = 2/(2 - e2) Eq. (14) says tan^2 ω = (Y/X)^q, so that
///     cos^2 ω = X^q / (X^q + Y^q),   x = a1 (cos^2 η)^(e1/2) (cos^2 ω)^(e2/2),
/// and alike for η with the norm r = ‖(X, Y)‖_q and Z = a3 |v3| (docs/mathematics.md §1: the gradient of the support
/// function). With a taper its own frame has the focus as origin, and v is moved by the root of the support function
/// (docs/mathematics.md §18).
template <class Float>
class SuperquadricSet {
 public:
  explicit SuperquadricSet(const Superquadric& superquadric);

  /// The origin for v = 0. Where the farthest points form a face (e = 2 and equal terms) one of them.
  [[nodiscard]] Coordinates<Float> operator()(const Coordinates<Float>& v) const;

 private:
  [[nodiscard]] Coordinates<Float> untapered(const Coordinates<Float>& v) const;
  [[nodiscard]] Coordinates<Float> tapered(const Coordinates<Float>& v) const;

  std::array<Float, 3> semi_axes_;
  std::array<Float, 2> exponents_;  // e1, e2
  Float k_;                         // of the taper
};

extern template class SuperquadricSet<double>;
extern template class SuperquadricSet<long double>;

/// x -> R x + t in floating point.
template <class Float>
class ApproximateMotion {
 public:
  explicit ApproximateMotion(const Pose& pose);
  /// Of the primitive's own frame, whose origin is its focus.
  [[nodiscard]] static ApproximateMotion of_own_frame(const Primitive& primitive);

  [[nodiscard]] Coordinates<Float> point(const Coordinates<Float>& x) const;              ///< R x + t
  [[nodiscard]] Coordinates<Float> direction(const Coordinates<Float>& v) const;          ///< R v
  [[nodiscard]] Coordinates<Float> inverse_point(const Coordinates<Float>& x) const;      ///< R^T (x - t)
  [[nodiscard]] Coordinates<Float> inverse_direction(const Coordinates<Float>& v) const;  ///< R^T v

 private:
  std::array<Coordinates<Float>, 3> rows_;
  Coordinates<Float> translation_;
};

extern template class ApproximateMotion<double>;
extern template class ApproximateMotion<long double>;

/// The image of a set under a rigid motion: s(v) = R s_0(R^T v) + t.
template <class Float, class Set>
class PosedSet {
 public:
  PosedSet(const Set& set, const ApproximateMotion<Float>& motion) : set_(set), motion_(motion) {}

  [[nodiscard]] Coordinates<Float> operator()(const Coordinates<Float>& v) const {
    return motion_.point(set_(motion_.inverse_direction(v)));
  }

  [[nodiscard]] const ApproximateMotion<Float>& motion() const { return motion_; }

 private:
  Set set_;
  ApproximateMotion<Float> motion_;
};

template <class Float>
[[nodiscard]] PosedSet<Float, SuperquadricSet<Float>> posed_set(const Primitive& primitive) {
  return {SuperquadricSet<Float>(primitive.superquadric), ApproximateMotion<Float>::of_own_frame(primitive)};
}

}  // namespace verisq::verify
