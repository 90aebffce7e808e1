/// What holds of a union of convex primitives near a place, proven where it is asked for first: half-spaces that
/// contain a primitive each, and a ball inside.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Contains a primitive: normal·x <= normal·c - at_centre for all its points x, c the field's centre, and |normal|
/// <= 1. So where n·(x - c) + at_centre is positive, the distance from x to the primitive is no less.
struct ContainingHalfSpace {
  Point normal;
  double at_centre;
};

/// In the model: no signed distance of x is more than |x - centre| - radius.
struct ContainedBall {
  Point centre;
  double radius;
};

/// Cubes about the model, the smaller the nearer to it. What is proven of one holds everywhere, but is tight there. Any
/// number of threads may ask.
class SolidField {
 public:
  /// Precondition: a union of convex primitives, at least one.
  SolidField(const Model& model, const Point& centre);
  ~SolidField();
  SolidField(const SolidField&) = delete;
  SolidField& operator=(const SolidField&) = delete;

  class Cube;

  [[nodiscard]] const Point& centre() const;

  /// Of the place centre + `from_centre`.
  [[nodiscard]] Cube& near(const Point& from_centre) const;

  /// One a primitive, in their order; of those that nothing is proven of a normal 0 and `at_centre` minus infinity.
  [[nodiscard]] static std::span<const ContainingHalfSpace> half_spaces(const Cube& cube);
  /// That reaches farthest beyond the middle of the cube, or next to it; nothing far from the model.
  [[nodiscard]] const std::optional<ContainedBall>& ball(Cube& cube) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq::verify
