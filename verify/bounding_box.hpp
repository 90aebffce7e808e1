/// Boxes of the model frame that contain models.
#pragma once

#include "verisq/model.hpp"

namespace verisq::verify {

/// {x : lower <= x <= upper}; an end that overflows is infinite.
struct Box {
  Point lower;
  Point upper;
};

/// The smallest box that contains both.
[[nodiscard]] Box hull(const Box& a, const Box& b);

/// Contains the model's solid: the hull of its primitives' boxes in a union, what the boxes have in common in an
/// intersection (the first one's where they have nothing in common), the first operand's in a difference. A primitive's
/// box encloses that of its own frame, bent where the primitive is (of the plane of the bend only what the solid
/// reaches), and posed.
[[nodiscard]] Box bounding_box(const Model& model);

}  // namespace verisq::verify
