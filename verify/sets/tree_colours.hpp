/// Colours of the primitives of a tree over cubes: what a tree does not hold costs nothing, however large the model.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "verify/sets/box_primitive.hpp"
#include "verify/sets/cube.hpp"
#include "verify/sets/set_tree.hpp"

namespace verisq::verify {

/// Works in its own memory: one for each thread.
class TreeColours {
 public:
  /// Keeps a reference to the primitives.
  explicit TreeColours(std::span<const BoxPrimitive> primitives)
      : primitives_(primitives), colours_(primitives.size(), Colour::gray), looked_at_(primitives.size(), 0) {}

  /// Of the primitives of the tree's leaves, each looked at once; of the others the result says nothing. Valid until
  /// the next call.
  [[nodiscard]] std::span<const Colour> operator()(const SetNode& tree, const Cube& cube) {
    ++cube_;
    any_decided_ = false;
    look_at(tree, cube);
    return colours_;
  }

  /// Whether one of those is not gray.
  [[nodiscard]] bool any_decided() const { return any_decided_; }

 private:
  void look_at(const SetNode& node, const Cube& cube) {
    if (node.kind == SetNode::Kind::leaf && looked_at_[node.primitive] != cube_) {
      looked_at_[node.primitive] = cube_;
      colours_[node.primitive] = primitives_[node.primitive].colour(cube);
      any_decided_ = any_decided_ || colours_[node.primitive] != Colour::gray;
    }
    for (const SetNode& operand : node.operands) look_at(operand, cube);
  }

  std::span<const BoxPrimitive> primitives_;
  std::vector<Colour> colours_;
  std::vector<std::uint64_t> looked_at_;  ///< the latest cube of each
  std::uint64_t cube_ = 0;
  bool any_decided_ = false;
};

}  // namespace verisq::verify
