/// Lower bounds of the distance of two convex sets, one of which is moved.
#pragma once

#include <concepts>

#include "verify/sets/bounded_motion.hpp"
#include "verify/sets/solid_pair_polytope.hpp"
#include "verify/sets/whole_primitive.hpp"

namespace verisq::verify {

/// n / |n|, about; zero where n is, or is no vector.
[[nodiscard]] Point unit(const Point& n);

/// What a bound asks of a set: a cube that contains it, at least the largest direction·(x - the cube's centre) over it,
/// and about its point nearest to x.
template <class T>
concept Separable = requires(const T& set, const Point& x) {
  { set.cube() } -> std::same_as<const Cube&>;
  { set.support(x) } -> std::same_as<double>;
  { set.nearest(x) } -> std::same_as<Point>;
};

/// At least 0: proven by the slab between the planes normal to n, which is in the frame of A like x, and about as long
/// as 1. Any n is valid.
template <Separable X, Separable Y>
[[nodiscard]] double lower_by_direction(const X& x, const Y& y, const BoundedMotion& motion, const Point& n);

/// What alternating projections find.
struct Approach {
  double lower;    ///< proven
  double between;  ///< |on_b moved - on_a|, about: what the sets leave to be gained
  Point on_a;      ///< in the frame of A; in the set, about
  Point on_b;      ///< in the frame of B
};

/// Stops as soon as `lower` is at least `enough`. `guess` is a direction from A to B; it may be poor, or zero.
template <Separable X, Separable Y>
[[nodiscard]] Approach approach(const X& x, const Y& y, const BoundedMotion& motion, const Point& guess, double enough);

// Here for two cut cubes, or one and a whole primitive.
extern template double lower_by_direction(const CutCube&, const CutCube&, const BoundedMotion&, const Point&);
extern template Approach approach(const CutCube&, const CutCube&, const BoundedMotion&, const Point&, double);
extern template Approach approach(const WholePrimitive&, const CutCube&, const BoundedMotion&, const Point&, double);
extern template Approach approach(const CutCube&, const WholePrimitive&, const BoundedMotion&, const Point&, double);

}  // namespace verisq::verify
