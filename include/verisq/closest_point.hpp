/// More of a point than its signed distance: the closest point of the model's surface, the normal there, and with it
/// the derivatives of the distance by position and by pose.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// An interval for each coordinate of a point or a vector: x, y, z.
using EnclosedPoint = std::array<Enclosure, 3>;

/// What is proven of the points p of the model's surface that are closest to a point x, all in the model's frame
/// (docs/mathematics.md §25). sd is the signed distance of x.
struct ClosestPoint {
  Enclosure distance;    ///< contains sd
  EnclosedPoint point;   ///< contains every closest point p, whether there is one or many
  EnclosedPoint normal;  ///< contains (x - p)/sd for every p, and where `unique`, the gradient of sd at x
  /// Index in Model::primitives of the one whose surface has every p; nothing where that is not proven.
  std::optional<std::uint32_t> primitive;
  /// Proven: there is one closest point, and sd is differentiable at x. Its gradient is the outward unit normal of the
  /// surface at p. False says only that this is not proven: of points inside where primitives overlap it never is, nor
  /// on edges, nor of points that several closest points have.
  bool unique;
};

/// What the signed distance alone says: no closest point is farther. Not unique.
[[nodiscard]] ClosestPoint closest_point_within(const Enclosure& distance, const Point& x);

/// The derivatives of sd when x is moved by a small rigid motion: a translation, then a rotation about `centre` by the
/// vector w, x -> x + w × (x - centre). They are n and (x - centre) × n for the normal n, per model unit and per
/// radian. Where the model is moved instead, they are the negatives of these. Precondition: `closest` is what is proven
/// of `x`. Of use where `closest.unique`; elsewhere intervals of no great interest.
[[nodiscard]] std::array<Enclosure, 6> gradient_by_motion(const ClosestPoint& closest, const Point& x,
                                                          const Point& centre);

}  // namespace verisq
