/// Trees of set operations over cubes: three-valued logic of colours, and Duff's simplification
/// (docs/mathematics.md §11).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "verify/sets/cube.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Unions and intersections alone: differences and complements have moved to the leaves (De Morgan).
struct SetNode {
  enum class Kind : std::uint8_t { leaf, union_of, intersection_of };

  Kind kind;
  std::uint32_t primitive = 0;  ///< of a leaf
  Side side = Side::inside;     ///< of a leaf
  std::vector<SetNode> operands = {};
};

/// The model's solid, or with Side::outside the closure of its complement.
[[nodiscard]] SetNode normal_form(const Model& model, Side side);

/// Primitives that hold the solid together, ascending, once each: every point of it lies in one of them. All those of a
/// union; of an intersection those of the first operand that has some, so that what is removed is not among them.
[[nodiscard]] std::vector<std::uint32_t> covering_primitives(const Model& model);

/// Primitives, or leaves of the tree where these are more: what one cube may have to look at.
[[nodiscard]] std::size_t size_of_tree(const Model& model);

/// Colour of the set whose primitives K_i (not their complements) have these colours over a cube. A boundary that two
/// operands share may stay gray.
[[nodiscard]] Colour colour(const SetNode& node, std::span<const Colour> primitives);

/// The shorter tree that is the same set within the cube where the primitives have these colours. Precondition:
/// colour(node, primitives) is gray.
[[nodiscard]] SetNode simplified(const SetNode& node, std::span<const Colour> primitives);

}  // namespace verisq::verify
