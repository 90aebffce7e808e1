/// This file implements bend.hpp, and the refusal of bends that model.hpp declares.
#include "verify/solids/bend.hpp"

#include <algorithm>
#include <string>

#include "verify/numbers/functions.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

PreciseInterval quotient_of_angle(const PreciseInterval& a) {
  return arctangent_quotient(a);
}

Interval quotient_of_angle(const Interval& a) {
  const Interval magnitude = abs(a);
  if (magnitude.upper() > 1.0) return arctangent_quotient(a);
  // Falls with |a|.
  return {fast_arctangent_quotient(magnitude.upper(), Direction::down),
          fast_arctangent_quotient(magnitude.lower(), Direction::up)};
}

}  // namespace

/// A bent point in the plane of the bend, by its place relative to the centre of curvature.
template <class T>
struct BendMap<T>::Polar {
  BasicInterval<T> along, up;  // R, Z
  BasicInterval<T> m, rise;    // 1 - k R, k Z
  BasicInterval<T> distance;   // W = |(m, k Z)|
};

template <class T>
BendMap<T>::BendMap(const Bend& bend)
    : curvature_(T(bend.curvature)),
      cosine_(cos_of_degrees<T>(bend.angle_degrees)),
      sine_(sin_of_degrees<T>(bend.angle_degrees)) {}

template <class T>
Vector3<T> BendMap<T>::turned(const Vector3<T>& v) const {
  return {v[0] * cosine_ + v[1] * sine_, v[1] * cosine_ - v[0] * sine_, v[2]};
}

template <class T>
Vector3<T> BendMap<T>::turned_back(const Vector3<T>& v) const {
  return {v[0] * cosine_ - v[1] * sine_, v[0] * sine_ + v[1] * cosine_, v[2]};
}

template <class T>
Vector3<T> BendMap<T>::bent(const Vector3<T>& unbent) const {
  const BasicInterval<T> one(1);
  const Vector3<T> v = turned(unbent);
  const BasicInterval<T> angle = curvature_ * v[2];
  const BasicInterval<T> half = angle / BasicInterval<T>(2);
  // (1 - cos kz) / k = z sin(kz/2) sin(kz/2)/(kz/2)  and  sin(kz) / k = z sin(kz)/(kz)
  const BasicInterval<T> along = v[0] * cos(angle) + v[2] * sin(half) * sine_quotient(half);
  const BasicInterval<T> up = (one - curvature_ * v[0]) * v[2] * sine_quotient(angle);
  return turned_back({along, v[1], up});
}

/// A turn by γ = k z in the plane of the bend, that stretches z by 1 - k r.
template <class T>
Vector3<T> BendMap<T>::pulled_back(const Vector3<T>& v, const Vector3<T>& unbent) const {
  const Vector3<T> x = turned(unbent);
  const Vector3<T> w = turned(v);
  const BasicInterval<T> angle = curvature_ * x[2];
  const BasicInterval<T> c = cos(angle);
  const BasicInterval<T> s = sin(angle);
  const BasicInterval<T> stretch = BasicInterval<T>(1) - curvature_ * x[0];
  return turned_back({c * w[0] - s * w[2], w[1], stretch * (s * w[0] + c * w[2])});
}

template <class T>
typename BendMap<T>::Polar BendMap<T>::polar(const Vector3<T>& turned) const {
  const BasicInterval<T> m = BasicInterval<T>(1) - curvature_ * turned[0];
  const BasicInterval<T> rise = curvature_ * turned[2];
  return {turned[0], turned[2], m, rise, sqrt(square(m) + square(rise))};
}

/// r = (1 - W) / k = (2 R - k (R^2 + Z^2)) / (1 + W)
template <class T>
BasicInterval<T> BendMap<T>::radius(const Polar& polar) const {
  const BasicInterval<T> numerator =
      BasicInterval<T>(2) * polar.along - curvature_ * (square(polar.along) + square(polar.up));
  return numerator / (BasicInterval<T>(1) + polar.distance);
}

/// |z| = angle / |k|, by the angle itself: no difference of angles near the cut. For k = 0 there is no cut and m = 1.
template <class T>
BasicInterval<T> BendMap<T>::height_magnitude(const Polar& polar) const {
  return polar_angle(polar.m, abs(polar.rise)) / abs(curvature_);
}

/// z = 2 Z / (W + m) * atan(tau) / tau with tau = tan(gamma / 2) = k Z / (W + m), also for k = 0, where m = 1. Beyond a
/// quarter turn W + m cancels, but the angle does not.
template <class T>
BasicInterval<T> BendMap<T>::height(const Polar& polar) const {
  const BasicInterval<T> sum = polar.distance + polar.m;
  const bool one_sign = polar.up.lower() > T(0) || polar.up.upper() < T(0);
  if (polar.m.lower() > T(0) || (sum.lower() > T(0) && !one_sign)) {
    return BasicInterval<T>(2) * polar.up / sum * quotient_of_angle(BasicInterval<T>(polar.rise / sum));
  }
  const BasicInterval<T> magnitude = height_magnitude(polar);
  if (!one_sign) return hull(magnitude, -magnitude);
  return polar.up.lower() > T(0) ? magnitude : -magnitude;
}

template <class T>
Vector3<T> BendMap<T>::unbent(const Vector3<T>& bent) const {
  const Vector3<T> v = turned(bent);
  const Polar p = polar(v);
  return turned_back({radius(p), v[1], height(p)});
}

template <class T>
Vector3<T> BendMap<T>::unbent_up_to_sign(const Vector3<T>& bent) const {
  const Vector3<T> v = turned(bent);
  const Polar p = polar(v);
  return turned_back({radius(p), v[1], p.m.lower() > T(0) ? height(p) : height_magnitude(p)});
}

template <class T>
std::optional<typename BendMap<T>::Expansion> BendMap<T>::expansion(const Vector3<T>& bent,
                                                                    const T& radius_bound) const {
  if (!(radius_bound < T(infinity))) return std::nullopt;
  const BasicInterval<T> one(1);
  const Vector3<T> v = turned(bent);
  const Polar p = polar(v);
  // The largest distance that (m, k Z) moves, and its least possible distance from the centre of curvature.
  const BasicInterval<T> step = abs(curvature_) * BasicInterval<T>(radius_bound);
  const BasicInterval<T> nearest = p.distance - step;
  const bool meets_cut = (p.m - step).lower() <= T(0) && (abs(p.rise) - step).lower() <= T(0);
  if (meets_cut || !(nearest.lower() > T(0))) return std::nullopt;

  // dr = (cos, 0, -sin), dz = (sin, 0, cos) / W of gamma: a turn in the plane of the bend that stretches along z.
  const BasicInterval<T> c = p.m / p.distance;
  const BasicInterval<T> s = p.rise / p.distance;
  const BasicInterval<T> shift = c - one;
  const Matrix3<T> d{{one + shift * square(cosine_), shift * cosine_ * sine_, -s * cosine_},
                     {shift * cosine_ * sine_, one + shift * square(sine_), -s * sine_},
                     {s * cosine_ / p.distance, s * sine_ / p.distance, c / p.distance}};

  // The Hessian of r has norm |k| / W, that of z |k| / W^2.
  const BasicInterval<T> radial = step * BasicInterval<T>(radius_bound) / (BasicInterval<T>(2) * nearest);
  const BasicInterval<T> axial = radial / nearest;
  return Expansion{turned_back({radius(p), v[1], height(p)}), d, radial.upper(), axial.upper()};
}

template class BendMap<double>;
template class BendMap<Real>;

namespace {

PreciseInterval curvature_magnitude(const Bend& bend) {
  return abs(PreciseInterval(Real(bend.curvature)));
}

/// The angle by which the end of the bent axis is turned.
PreciseInterval angle(const Bend& bend, const Superquadric& superquadric) {
  return curvature_magnitude(bend) * PreciseInterval(Real(superquadric.semi_axes[2]));
}

/// The largest of the coordinate `axis` of the bend's frame: 0 for |r|, 1 for |s|.
PreciseInterval extent_of(const Bend& bend, const Superquadric& superquadric, std::size_t axis) {
  return SuperquadricBounds<Real>(superquadric).support(turn(bend).column(axis));
}

PreciseInterval symmetric(const PreciseInterval& half) {
  return {-half.upper(), half.upper()};
}

}  // namespace

PreciseMatrix turn(const Bend& bend) {
  const PreciseInterval c = cos_of_degrees<Real>(bend.angle_degrees);
  const PreciseInterval s = sin_of_degrees<Real>(bend.angle_degrees);
  return {{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
}

PreciseInterval extent(const Bend& bend, const Superquadric& superquadric) {
  return extent_of(bend, superquadric, 0);
}

bool is_connected_below(double depth, const Bend& bend, const Superquadric& superquadric) {
  const PreciseInterval k = curvature_magnitude(bend);
  const PreciseInterval nearest = PreciseInterval(1) - k * extent(bend, superquadric);  // W, of all points
  return (PreciseInterval(10) * k * PreciseInterval(Real(depth))).upper() <= (PreciseInterval(9) * nearest).lower();
}

/// The solid lies in |r| <= e, |s| <= f, |z| <= a3. With k > 0 (k < 0 mirrors R) and γ = kz:
/// R = 1/k - (1/k - r) cos γ is least, -e, at γ = 0; it is largest at the end of the axis, where with h = k a3 / 2 it
/// is at most |cos 2h| e + (2/k) sin² h. |Z| = (1/k - r) |sin γ| <= (1/k + e) max |sin γ|. Nothing cancels as k -> 0.
PreciseVector bent_box(const Bend& bend, const Superquadric& superquadric) {
  const PreciseInterval e = extent(bend, superquadric);
  const PreciseInterval f = extent_of(bend, superquadric, 1);
  const PreciseInterval a3 = Real(superquadric.semi_axes[2]);
  if (bend.curvature == 0.0) return {symmetric(e), symmetric(f), symmetric(a3)};
  const PreciseInterval k = curvature_magnitude(bend);
  const PreciseInterval sine_of_half = sin(angle(bend, superquadric) / PreciseInterval(2));
  const PreciseInterval cosine_of_whole = PreciseInterval(1) - PreciseInterval(2) * square(sine_of_half);
  const PreciseInterval sagitta = PreciseInterval(2) * square(sine_of_half) / k;
  const PreciseInterval cosine_of_half = sqrt(PreciseInterval(1) - square(sine_of_half));
  // Beyond a quarter of a turn the largest sine is 1, not that of the end.
  const PreciseInterval largest_sine =
      cosine_of_whole.lower() >= Real(0) ? PreciseInterval(2) * sine_of_half * cosine_of_half : PreciseInterval(1);
  const PreciseInterval along = hull(-e, abs(cosine_of_whole) * e + sagitta);
  return {bend.curvature > 0.0 ? along : -along, symmetric(f),
          symmetric((PreciseInterval(1) + k * e) * largest_sine / k)};
}

void require_union_of_convex(const Model& model, std::string_view what) {
  require_valid(model);
  const auto bent = std::ranges::find_if(model.primitives, is_bent);
  if (bent == model.primitives.end()) return require_union(model, what);
  throw Error(ErrorKind::input, std::string(what) + ": not supported for bent solids: primitives[" +
                                    std::to_string(bent - model.primitives.begin()) + "].bend");
}

}  // namespace verisq::verify
