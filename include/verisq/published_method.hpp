/// The paper's own verified distance (§5.1), as published: GJK, a bisected segment, one interval plane.
///
/// Here to be compared with: its enclosures are valid, but wider and slower than those of `SignedDistance` and
/// `PairDistance`, which rest on the duality certificate.
#pragma once

#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// How far GJK's floating-point answer may exceed the distance, relative to it, in the paper's tests.
inline constexpr double published_accuracy = 1e-6;

/// Eqs. (16) to (18): encloses the Euclidean distance of a point to one posed superquadric, [0, 0] where the point is
/// proven to lie in it. `accuracy` (0: the best that binary64 gives) changes the width, never the validity. Throws
/// Error(input) for a bent solid, like all here; otherwise never for finite points.
[[nodiscard]] Enclosure published_distance(const Primitive& solid, const Point& point,
                                           double accuracy = published_accuracy);

/// Eqs. (19) and (20): encloses the distance of two posed superquadrics, [0, 0] where they are proven to meet.
[[nodiscard]] Enclosure published_distance(const Primitive& a, const Primitive& b,
                                           double accuracy = published_accuracy);

/// What the method starts from: GJK alone, in floating point. Nothing proves it.
[[nodiscard]] double unverified_distance(const Primitive& solid, const Point& point,
                                         double accuracy = published_accuracy);
[[nodiscard]] double unverified_distance(const Primitive& a, const Primitive& b, double accuracy = published_accuracy);

}  // namespace verisq
