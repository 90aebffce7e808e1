/// The surface of a solid and its farthest point in a direction, in floating point.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The point of a triangle closest to the origin, in plain floating point: proposes where a face comes closest.

template <class Float>
using Coordinates = std::array<Float, 3>;

template <class Float>
[[nodiscard]] Coordinates<Float> difference(const Coordinates<Float>& a, const Coordinates<Float>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <class Float>
[[nodiscard]] Coordinates<Float> along(const Coordinates<Float>& a, const Coordinates<Float>& step, Float s) {
  return {a[0] + s * step[0], a[1] + s * step[1], a[2] + s * step[2]};
}

template <class Float>
[[nodiscard]] Float dot(const Coordinates<Float>& a, const Coordinates<Float>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Float>
[[nodiscard]] Coordinates<Float> cross(const Coordinates<Float>& a, const Coordinates<Float>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The vector divided by its length; nothing for zero.
template <class Float>
[[nodiscard]] std::optional<Coordinates<Float>> unit_of(const Coordinates<Float>& v) {
  const Float length = std::sqrt(dot(v, v));
  if (!(length > 0)) return std::nullopt;
  return Coordinates<Float>{v[0] / length, v[1] / length, v[2] / length};
}

/// A unit vector at a right angle to v, which is not zero.
template <class Float>
[[nodiscard]] Coordinates<Float> unit_across(const Coordinates<Float>& v) {
  std::size_t least = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::fabs(v[k]) < std::fabs(v[least])) least = k;
  Coordinates<Float> axis{};
  axis[least] = 1;
  return unit_of(cross(v, axis)).value_or(axis);
}

/// The point of the segment a b that is closest to the origin.
template <class Float>
[[nodiscard]] Coordinates<Float> closest_to_origin(const Coordinates<Float>& a, const Coordinates<Float>& b) {
  const auto edge = difference(b, a);
  const Float squared = dot(edge, edge);
  return squared > 0 ? along(a, edge, std::clamp<Float>(-dot(a, edge) / squared, 0, 1)) : a;
}

/// The point of the triangle a b c, which may be degenerate, that is closest to the origin.
template <class Float>
[[nodiscard]] Coordinates<Float> closest_to_origin(const Coordinates<Float>& a, const Coordinates<Float>& b,
                                                   const Coordinates<Float>& c) {
  const auto u = difference(b, a);
  const auto v = difference(c, a);
  const Float uu = dot(u, u);
  const Float uv = dot(u, v);
  const Float vv = dot(v, v);
  const Float determinant = uu * vv - uv * uv;
  const Float s = uv * dot(a, v) - vv * dot(a, u);
  const Float t = uv * dot(a, u) - uu * dot(a, v);
  if (determinant > 0 && s >= 0 && t >= 0 && s + t <= determinant) {
    return along(along(a, u, s / determinant), v, t / determinant);
  }
  return std::min({closest_to_origin(a, b), closest_to_origin(b, c), closest_to_origin(c, a)},
                  [](const auto& x, const auto& y) { return dot(x, x) < dot(y, y); });
}

// The surface of a superquadric in plain floating point: where rays leave it and its normals. Proposes, proves
// nothing.

/// All points and directions lie in the octant of nonnegative coordinates, in the solid's own frame; for a tapered
/// solid z may be negative, too. Float is double or long double.
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
  Float k_, fall_;  ///< numbers of the taper: 0 and 1 without one
};

extern template class Boundary<double>;
extern template class Boundary<long double>;

// Support mappings of convex sets in plain floating point: the only description of a set that GJK needs.

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
/// function). With a taper the origin of its own frame is the focus, and v is moved by the root of the support function
/// (docs/mathematics.md §18).
template <class Float>
class SuperquadricSet {
 public:
  explicit SuperquadricSet(const Superquadric& superquadric);

  /// For v = 0 the result is the origin. If the farthest points form a face (e = 2 and equal terms), it is one of them.
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
  /// By the rows of R and t.
  ApproximateMotion(const std::array<Coordinates<Float>, 3>& rows, const Coordinates<Float>& translation)
      : rows_(rows), translation_(translation) {}
  /// The motion from the primitive's own frame, whose origin is its focus.
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

// The farthest points of a primitive's section across its axis, bent or not, in plain floating point. Proposes, proves
// nothing (docs/mathematics.md §9).

/// All points are in the primitive's own frame, with its centre as origin. Immutable.
class SectionMapping {
 public:
  explicit SectionMapping(const Primitive& primitive);

  /// The bend's effect on the axis at a height z: the axis turns by kz.
  struct End {
    double height;
    double cosine, sine;  ///< of kz
    double along, up;     ///< R and Z of the axis point
  };

  /// Heights, before the bend, between which a section lies.
  struct Section {
    End lower, upper;
  };

  [[nodiscard]] Section section(double lower, double upper) const { return {end_at(lower), end_at(upper)}; }

  /// The number v with which the chords of §9 give about the least bound of the section towards `direction`; it may
  /// overflow. 0 without a bend.
  [[nodiscard]] double slope(const Coordinates<double>& direction, const Section& section) const;

  /// About a point of the section where direction·x is largest; without a bend of the whole primitive.
  [[nodiscard]] Coordinates<double> support_point(const Coordinates<double>& direction, const Section& section) const;

  /// About the point that the bend takes to x.
  [[nodiscard]] Coordinates<double> unbent(const Coordinates<double>& x) const;

  /// About the normal of the bent surface where the unbent one has that normal at that point.
  [[nodiscard]] Coordinates<double> bent_normal(const Coordinates<double>& normal,
                                                const Coordinates<double>& unbent_point) const;

 private:
  using Plain = Coordinates<double>;

  [[nodiscard]] End end_at(double height) const;
  [[nodiscard]] Plain turned(const Plain& v) const;
  [[nodiscard]] Plain turned_back(const Plain& v) const;
  [[nodiscard]] Plain bent(const Plain& unbent) const;
  [[nodiscard]] Plain farthest(double c, double across, double slope) const;
  [[nodiscard]] Plain farthest_at(double height, double c, double across) const;
  [[nodiscard]] double scale_at(double height) const;
  [[nodiscard]] double scale_slope_at(double height) const;

  Superquadric superquadric_;
  bool is_bent_;
  double curvature_ = 0.0;
  double cosine_ = 1.0, sine_ = 0.0;  ///< cosine and sine of the bend's direction
  double taper_;                      ///< k of docs/mathematics.md §18
  SuperquadricSet<double> unbent_;
  SuperquadricSet<double> untapered_;
};

}  // namespace verisq::verify
