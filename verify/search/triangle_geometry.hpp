/// Bounds of the distance of a point from a triangle in binary64: of one, or of several at a time, one a lane.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>

#include "verify/proof/mesh_solid.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

// Vectors are handed only to functions that are inlined: no interface between them depends on the processor.
#pragma GCC diagnostic ignored "-Wpsabi"

// Where the compiler makes several versions of a function and the program takes the widest that its processor knows.
// All give the same numbers: no operation is fused (-ffp-contract=off).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define VERISQ_WIDEST_VECTORS [[gnu::target_clones("default", "avx2", "arch=x86-64-v4")]]
#else
#define VERISQ_WIDEST_VECTORS
#endif

namespace verisq::verify {

// Lanes: several numbers at a time.

template <class Number, std::size_t count>
struct LaneTypes;
template <>
struct LaneTypes<float, 8> {
  using Vector = float __attribute__((vector_size(32)));
  using Mask = std::int32_t __attribute__((vector_size(32)));
};
template <>
struct LaneTypes<double, 8> {
  using Vector = double __attribute__((vector_size(64)));
  using Mask = std::int64_t __attribute__((vector_size(64)));
};
template <>
struct LaneTypes<double, 4> {
  using Vector = double __attribute__((vector_size(32)));
  using Mask = std::int64_t __attribute__((vector_size(32)));
};
template <class Number, std::size_t count>
using Lanes = typename LaneTypes<Number, count>::Vector;
template <class Number, std::size_t count>
using LaneMask = typename LaneTypes<Number, count>::Mask;

template <class Number>
[[gnu::always_inline]] inline Lanes<Number, 8> load(const std::array<float, 8>& row) {
  Lanes<float, 8> narrow;
  std::memcpy(&narrow, row.data(), sizeof narrow);
  return __builtin_convertvector(narrow, Lanes<Number, 8>);
}

/// The greater of two numbers, lane by lane; the second where one is no number.
template <class Vector>
[[gnu::always_inline]] inline Vector greater(const Vector& a, const Vector& b) {
  return a > b ? a : b;
}

template <class Vector>
[[gnu::always_inline]] inline Vector lesser(const Vector& a, const Vector& b) {
  return a < b ? a : b;
}

template <class Vector>
[[gnu::always_inline]] inline Vector magnitude_of(const Vector& x) {
  return greater<Vector>(x, -x);
}

/// Into [0, 1]; 0 where it is no number.
template <class Vector>
[[gnu::always_inline]] inline Vector as_share(const Vector& x) {
  const Vector zero{};
  return lesser<Vector>(greater<Vector>(x, zero), zero + 1);
}

template <class Vector>
[[gnu::always_inline]] inline Vector inner(const std::array<Vector, 3>& a, const std::array<Vector, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

[[gnu::always_inline]] inline double root(double x) {
  return std::sqrt(x);
}
[[gnu::always_inline]] inline Lanes<double, 4> root(const Lanes<double, 4>& x) {
  return Lanes<double, 4>{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

/// One bit a lane.
[[gnu::always_inline]] inline unsigned bits_of(const LaneMask<float, 8>& mask) {
  const LaneMask<float, 8> bits = mask & LaneMask<float, 8>{1, 2, 4, 8, 16, 32, 64, 128};
  std::array<std::uint64_t, 4> words;
  std::memcpy(words.data(), &bits, sizeof words);
  const std::uint64_t both = (words[0] | words[1]) | (words[2] | words[3]);
  return static_cast<unsigned>(both | (both >> 32U));
}
[[gnu::always_inline]] inline unsigned bits_of(const LaneMask<double, 8>& mask) {
  return bits_of(__builtin_convertvector(mask, LaneMask<float, 8>));
}

// The bounds.

/// Squares below it may underflow: no vector so short is a normal.
constexpr double least_square = 0x1p-900;
/// More than what underflows anywhere in these sums may hide, whose roots are below 2^-530.
constexpr double underflow_of_length = 0x1p-500;
/// The rounding error is at most this share of the sums of magnitudes below: 10 u, u = 2^-53.
constexpr double share_of_magnitude = 10 * 0x1p-53;

/// A triangle as a point sees it. Differences of binary64 numbers round by u, relatively. `Number`: double, or lanes.
template <class Number>
struct SeenTriangle {
  using Vector = std::array<Number, 3>;

  Vector a, b, c;  ///< corners less the point
  Vector ab, ac;
  Number magnitude{};  ///< no |a_i| + |ab_i| + |ac_i| is larger, but for rounding

  [[gnu::always_inline]] SeenTriangle(const Vector& point, const std::array<Vector, 3>& triangle) {
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = triangle[0][i] - point[i];
      b[i] = triangle[1][i] - point[i];
      c[i] = triangle[2][i] - point[i];
      ab[i] = triangle[1][i] - triangle[0][i];
      ac[i] = triangle[2][i] - triangle[0][i];
      magnitude = greater<Number>(
          magnitude, magnitude_of<Number>(a[i]) + magnitude_of<Number>(ab[i]) + magnitude_of<Number>(ac[i]));
    }
  }
};

/// Shares of the second and the third corner: each in [0, 1], the sum at most 1 + u.
template <class Number>
struct Shares {
  Number b;
  Number c;
};

template <class Number>
[[gnu::always_inline]] inline Shares<Number> clamped(const Number& b, const Number& c) {
  const Number zero{};
  const Number one = zero + 1.0;
  const Number first = b > zero ? lesser<Number>(b, one) : zero;  // false for NaN
  return {first, c > zero ? lesser<Number>(c, one - first) : zero};
}

/// Bounds of the distance of a point from a closed triangle, which may be degenerate, and the way to a point of it that
/// is proposed as the nearest one.
template <class Number>
struct BoundsOfDistance {
  Number lower;
  Number upper;
  std::array<Number, 3> way;
};

/// The triangle lies in {x : n·(x - q) >= least n·(corner - q)}, for any n (docs/mathematics.md §29). Products of n
/// with rounded differences X and their sums round by 4.01 u |n| |X|, |X| <= √3 magnitude: by 7.1 u magnitude in units
/// of |n|. |n|, the root and the quotient round by 4.01 u, of what is at most √3 magnitude: with the product below 8 u
/// of it are taken off by its factor.
template <class Number>
[[gnu::always_inline]] inline Number lower_by(const SeenTriangle<Number>& seen, const std::array<Number, 3>& n,
                                              const Number& square, const Number& length) {
  const auto least = lesser<Number>(lesser<Number>(inner(n, seen.a), inner(n, seen.b)), inner(n, seen.c));
  const Number lower = least / length * (1.0 - 0x1p-50) - share_of_magnitude * seen.magnitude - underflow_of_length;
  return square >= Number{} + least_square ? greater<Number>(lower, Number{}) : Number{};
}

/// By the point a + b ab + c ac. Off it by at most u (3|a_i| + 4 b|ab_i| + 3 c|ac_i|) a coordinate, a little more for
/// products of errors, and by u|ac_i| for the sum of shares beyond 1: by 5.1 u √3 magnitude, which is below 9 u
/// magnitude. Its length rounds by 3 u, and each operation on it by one more: 8 u.
template <class Number>
[[gnu::always_inline]] inline BoundsOfDistance<Number> bounds_at(const SeenTriangle<Number>& seen,
                                                                 const Shares<Number>& shares) {
  std::array<Number, 3> way;
  for (std::size_t i = 0; i < 3; ++i) way[i] = seen.a[i] + shares.b * seen.ab[i] + shares.c * seen.ac[i];
  const Number square = inner(way, way);
  const Number length = root(square);
  const Number upper = length * (1.0 + 0x1p-50) + share_of_magnitude * seen.magnitude + underflow_of_length;
  return {lower_by(seen, way, square, length), upper, way};
}

/// Bounds so far apart leave something to gain.
template <class Number>
[[gnu::always_inline]] inline auto are_loose(const SeenTriangle<Number>& seen, const BoundsOfDistance<Number>& bounds) {
  return bounds.upper - bounds.lower > 64 * share_of_magnitude * seen.magnitude;
}

/// Proposes the shares of the nearest point without a choice of ways through it, in any kind of numbers: that of the
/// plane where it lies inside, else the nearest of three on the sides. Corners less the point.
template <class Number>
[[gnu::always_inline]] inline Shares<Number> nearest_shares(const std::array<Number, 3>& a,
                                                            const std::array<Number, 3>& b,
                                                            const std::array<Number, 3>& ab,
                                                            const std::array<Number, 3>& ac) {
  std::array<Number, 3> bc;
  for (std::size_t i = 0; i < 3; ++i) bc[i] = ac[i] - ab[i];
  const Number zero{};
  const Number one = zero + 1;
  const Number d00 = inner(ab, ab);
  const Number d01 = inner(ab, ac);
  const Number d11 = inner(ac, ac);
  const Number d20 = -inner(a, ab);
  const Number d21 = -inner(a, ac);
  const Number inverse = one / (d00 * d11 - d01 * d01);
  const Number v = (d11 * d20 - d01 * d21) * inverse;
  const Number w = (d00 * d21 - d01 * d20) * inverse;
  const auto inside = (v >= zero) & (w >= zero) & (v + w <= one);
  const auto on_ab = as_share<Number>(d20 / d00);
  const auto on_ac = as_share<Number>(d21 / d11);
  const auto on_bc = as_share<Number>(-inner(b, bc) / inner(bc, bc));
  std::array<Number, 3> to_ab;
  std::array<Number, 3> to_ac;
  std::array<Number, 3> to_bc;
  for (std::size_t i = 0; i < 3; ++i) {
    to_ab[i] = a[i] + on_ab * ab[i];
    to_ac[i] = a[i] + on_ac * ac[i];
    to_bc[i] = b[i] + on_bc * bc[i];
  }
  const Number e1 = inner(to_ab, to_ab);
  const Number e2 = inner(to_ac, to_ac);
  const Number e3 = inner(to_bc, to_bc);
  const auto second = e2 < e1;
  const auto third = e3 < (second ? e2 : e1);
  const Number side_b = third ? one - on_bc : (second ? zero : on_ab);
  const Number side_c = third ? on_bc : (second ? on_ac : zero);
  return {inside ? v : side_b, inside ? w : side_c};
}

/// Cross product 4.01 u, difference u, product u, two sums u each: 8.1 u of the magnitudes. What underflows is below
/// 2^-1073, times a coordinate below 2^301.
constexpr double rounding_of_volume = 0x1p-49;
constexpr double underflow_of_volume = 0x1p-700;

/// On which side of the triangle's plane the point lies: 1 where ab × ac points to, -1, or 0 where it is not proven.
/// Each component of the cross product of rounded differences is off by at most 4.01 u of the sum of its products'
/// magnitudes, as differences, products and their difference round by u.
template <class Number>
[[gnu::always_inline]] inline Number proven_side(const SeenTriangle<Number>& seen) {
  Number volume{};
  Number magnitude{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    const Number plus = seen.ab[j] * seen.ac[k];
    const Number less = seen.ab[k] * seen.ac[j];
    volume -= (plus - less) * seen.a[i];
    magnitude += (magnitude_of<Number>(plus) + magnitude_of<Number>(less)) * magnitude_of<Number>(seen.a[i]);
  }
  const Number error = rounding_of_volume * magnitude + underflow_of_volume;
  const Number zero{};
  return volume > error ? zero + 1.0 : (volume < -error ? zero - 1.0 : zero);
}

using DistanceBounds = BoundsOfDistance<double>;

/// Preconditions: finite; differences no larger than 2^300. What lies below 2^-500 is wide.
[[nodiscard]] DistanceBounds distance_bounds(const Point& point, const Triangle& triangle);

// Signs are -1, 0 or 1. Filters in binary64 decide nearly all, MPFR with as many bits as any result can have the
// others. Preconditions: coordinates are finite; no larger than 2^300 where a filter is asked alone.

/// On which side of the plane through a, b and c the point lies: 1 where (b - a) × (c - a) points to.
[[nodiscard]] int orientation(const Triangle& triangle, const Point& point);

/// The same, where binary64 is enough for it; never 0.
[[nodiscard]] std::optional<int> near_orientation(const Triangle& triangle, const Point& point);

/// True where the corners lie on a line.
[[nodiscard]] bool is_degenerate(const Triangle& triangle);

/// True where the point lies on the closed triangle, which may be degenerate.
[[nodiscard]] bool lies_on(const Point& point, const Triangle& triangle);

/// Returns what a triangle adds to the winding number of a point: a ray from it along the axis, upward or downward,
/// meets the triangle and leaves through it along its normal (1), or against it (-1), or does not meet it. The ray is
/// moved aside by the same infinitely small step for all triangles, so that it meets no side (docs/mathematics.md §29).
/// Precondition: the point does not lie on the triangle.
[[nodiscard]] int crossing(const Point& point, std::size_t axis, bool upward, const Triangle& triangle);

/// True proves that the two triangles have no point in common but the hull of their common corners, and that these are
/// at most two.
[[nodiscard]] bool meet_in_common_corners(const Triangle& first, const Corners& of_first, const Triangle& second,
                                          const Corners& of_second);

}  // namespace verisq::verify
