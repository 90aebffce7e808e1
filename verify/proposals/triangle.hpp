/// The point of a triangle closest to the origin, in plain floating point: proposes where a face comes closest.
#pragma once

#include <algorithm>
#include <array>

namespace verisq::verify {

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

/// Of the segment a b.
template <class Float>
[[nodiscard]] Coordinates<Float> closest_to_origin(const Coordinates<Float>& a, const Coordinates<Float>& b) {
  const auto edge = difference(b, a);
  const Float squared = dot(edge, edge);
  return squared > 0 ? along(a, edge, std::clamp<Float>(-dot(a, edge) / squared, 0, 1)) : a;
}

/// Of the triangle a b c, which may be degenerate.
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

}  // namespace verisq::verify
