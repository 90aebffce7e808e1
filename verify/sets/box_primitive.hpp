/// One posed primitive, bent or not, over cubes of the model frame: inclusion functions of second order.
#pragma once

#include <memory>

#include "verify/sets/cube.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Every statement is proven by outward-rounded intervals with binary64 ends. Over a cube of half-width h the
/// coordinates in the primitive's own frame are an affine function of the position up to a remainder of order h^2 (0
/// without a bend), and the gauge is convex: half-spaces are loose by the order h^2 only.
class BoxPrimitive {
 public:
  explicit BoxPrimitive(const Primitive& primitive);
  ~BoxPrimitive();
  BoxPrimitive(BoxPrimitive&&) noexcept;
  BoxPrimitive& operator=(BoxPrimitive&&) noexcept;

  /// Colour of the primitive K itself. For a point: black where g < 1 is proven, white where g > 1 is.
  [[nodiscard]] Colour colour(const Cube& cube) const;

  /// A half-space that contains the part of K, or of the closure of its complement, in the cube.
  [[nodiscard]] HalfSpace half_space(const Cube& cube, Side side) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq::verify
