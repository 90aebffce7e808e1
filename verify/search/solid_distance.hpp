/// Signed distances of points to models with bends or set operations, and to any model.
#pragma once

#include <functional>
#include <optional>

#include "verify/solids/cube.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/hidden.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Signed distance of a point to any model, by branch and bound over cubes (docs/mathematics.md §10, §11).

/// Throws Error(input), "tolerance = VALUE: must be at least 0", for every search; NaN is none.
void require_tolerance(double tolerance);

class SolidDistance {
 public:
  explicit SolidDistance(const Model& model);

  /// Encloses the exact signed distance. Works until the enclosure is at most `tolerance` wide, the budget of cubes is
  /// spent or `interrupted` (polled) returns true; in the last two cases it is valid, and wide. `known` is an enclosure
  /// that is proven already.
  [[nodiscard]] Enclosure operator()(const Point& x, double tolerance, const Enclosure& known,
                                     const std::function<bool()>& interrupted) const;

  /// A point proven to lie in the solid, or with Side::outside beyond it, hardly farther from x than the nearest such
  /// point. Nothing if none was found.
  [[nodiscard]] std::optional<Point> nearest(const Point& x, Side side, double tolerance,
                                             const std::function<bool()>& interrupted) const;
  [[nodiscard]] std::optional<Point> escape(const Point& x, double tolerance,
                                            const std::function<bool()>& interrupted) const {
    return nearest(x, Side::outside, tolerance, interrupted);
  }

  /// The colour of a point.
  [[nodiscard]] Colour colour(const Point& x) const;

 private:
  struct State;
  Hidden<State> state_;
};

// Signed distances to set operations, closest points, uncertain sizes.

/// Consider the ball about x that just contains the nearest surface point p of a primitive K. Let every other primitive
/// contain the ball, miss it, or not matter within it, whatever lies in K. Then the model is K in the ball, or the
/// complement of K, and p is its nearest surface point, too (docs/mathematics.md §25). Immutable: safe to call from
/// many threads.
class SetClosestPoint {
 public:
  explicit SetClosestPoint(const Model& model);

  /// Nothing if no primitive decides. `farthest` is an upper bound of the distance of x to the model's surface, which
  /// only saves time; infinite if none is known.
  [[nodiscard]] std::optional<ClosestPoint> operator()(const Point& x, double farthest) const;

 private:
  struct State;
  Hidden<State> state_;
};

}  // namespace verisq::verify
