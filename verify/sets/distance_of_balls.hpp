/// The distance of a union of balls from any solid, from below: that of their centres less their radii. The head of a
/// joint is a ball, and all of its cup may be as far from it as the nearest point is.
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "verify/sets/bounded_motion.hpp"
#include "verify/sets/solid_distance.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

struct Ball {
  Point centre;
  double radius;
};

class BallUnion {
 public:
  /// Nothing unless the model is the union of balls, and of a few.
  [[nodiscard]] static std::optional<BallUnion> of(const Model& model);

  /// A lower bound of the distance of the balls of A's frame from B's solid, and of those of B's frame from A's; minus
  /// infinity where nothing is proven. Distances of centres are searched for to `tolerance`.
  [[nodiscard]] double lower_from_b(const SolidDistance& b, const BoundedMotion& motion, double tolerance,
                                    const std::function<bool()>& interrupted) const;
  [[nodiscard]] double lower_from_a(const SolidDistance& a, const BoundedMotion& motion, double tolerance,
                                    const std::function<bool()>& interrupted) const;

 private:
  /// A centre in the frame of the other solid, and a bound of how far it lies from there.
  struct Located {
    Point centre;
    double off;
  };

  [[nodiscard]] double lower_from(const SolidDistance& solid, const std::function<Located(const Point&)>& locate,
                                  double tolerance, const std::function<bool()>& interrupted) const;

  explicit BallUnion(std::vector<Ball> balls) : balls_(std::move(balls)) {}

  std::vector<Ball> balls_;
};

}  // namespace verisq::verify
