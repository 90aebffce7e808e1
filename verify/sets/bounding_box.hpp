/// Boxes of the model frame that contain models.
#pragma once

#include <cstdint>
#include <functional>

#include "verisq/model.hpp"

namespace verisq::verify {

/// {x : lower <= x <= upper}; an end that overflows is infinite.
struct Box {
  Point lower;
  Point upper;
};

/// The smallest box that contains both.
[[nodiscard]] Box hull(const Box& a, const Box& b);

using BoxOfPrimitive = std::function<Box(std::uint32_t primitive)>;

/// Contains the tree's set, from boxes that contain its leaves' primitives. Each leaf is asked for once at most: a
/// difference does not look at what it removes.
[[nodiscard]] Box bounding_box(const SetExpression& expression, const BoxOfPrimitive& box_of_primitive);

/// Contains the model's solid: the hull of its primitives' boxes in a union, what the boxes have in common in an
/// intersection (the first one's where they have nothing in common), the first operand's in a difference. A primitive's
/// box encloses that of its own frame, bent where the primitive is (of the plane of the bend only what the solid
/// reaches), and posed.
[[nodiscard]] Box bounding_box(const Model& model);

}  // namespace verisq::verify
