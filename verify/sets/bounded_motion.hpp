/// The motion of the second model, precise for what is said last and in binary64 with an error bound for the search.
#pragma once

#include "verify/proof/pair_bounds.hpp"
#include "verify/sets/cube.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// From the frame of B to that of A: x -> R x + t.
class BoundedMotion {
 public:
  explicit BoundedMotion(const Pose& pose);

  // About: these prove nothing.
  [[nodiscard]] Point to_a(const Point& in_b) const;
  [[nodiscard]] Point to_b(const Point& in_a) const;

  /// R^T direction, but for an error of at most `rotation_error` |direction|_1 in each component.
  [[nodiscard]] Point direction_in_b(const Point& direction) const;
  static constexpr double rotation_error = 0x1p-50;

  /// t itself.
  [[nodiscard]] const Point& translation() const { return translation_; }

  /// |R b + t - a|, rounded up.
  [[nodiscard]] double distance_up(const Point& a, const Point& b) const;

  /// A cube of B's frame that contains R^T (x - t).
  [[nodiscard]] Cube enclosed_in_b(const Point& x) const;

 private:
  RigidMotion precise_;
  RigidMotion inverse_;
  std::array<Point, 3> rotation_;  ///< rows of R, to nearest
  Point translation_;
};

}  // namespace verisq::verify
