/// Exact cubes of the root; colours by the tree of the undecided primitives alone.
#include "verify/sets/octree_cube.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "verify/numbers/rounding.hpp"
#include "verify/sets/bounding_box.hpp"
#include "verify/sets/cube_division.hpp"
#include "verify/sets/tree_colours.hpp"
#include "verisq/error.hpp"

namespace verisq {

double edge(const OctreeRoot& root, int level) {
  return std::ldexp(root.half_width, 1 - level);
}

Point lower_corner(const OctreeRoot& root, const OctreeCube& cube) {
  const double size = edge(root, cube.level);
  Point corner{};
  // Multiples of the deepest edge below 2^53 of them (root_cube): no operation rounds.
  for (std::size_t i = 0; i < 3; ++i) corner[i] = root.centre[i] - root.half_width + size * cube.position[i];
  return corner;
}

namespace verify {

OctreeRoot octree_root(const Model& model) {
  const Box box = bounding_box(model);
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, box.upper[i] - box.lower[i]);
  if (!std::isfinite(largest)) throw Error(ErrorKind::input, "octree: the size of the model overflows");
  // Corners at the deepest level are multiples of its half edge, below 2^53 of them.
  const std::optional<Cube> root = root_cube(box, {.farthest = 0x1p+30});
  // A cube far larger than the model would waste levels on what is empty.
  constexpr double most_sides = 8.0;
  const bool wasteful = root && root->half_width > most_sides * largest && root->half_width > smallest_root;
  if (!root || wasteful) throw Error(ErrorKind::input, "octree: the model is too far from the origin for its size");
  return {root->centre, root->half_width};
}

Cube cube_of(const OctreeRoot& root, const OctreeCube& cube) {
  const double half_width = std::ldexp(root.half_width, -cube.level);
  Point centre = lower_corner(root, cube);
  for (double& c : centre) c += half_width;
  return {centre, half_width};
}

OctreeCube child_of(const OctreeCube& parent, unsigned child) {
  OctreeCube result{{}, static_cast<std::uint8_t>(parent.level + 1), CubeColour::gray};
  for (std::size_t i = 0; i < 3; ++i) result.position[i] = 2 * parent.position[i] + ((child >> i) & 1U);
  return result;
}

Enclosure volume(const OctreeRoot& root, const std::vector<OctreeLevel>& levels) {
  // In cubes of the deepest level: at most 8^20, exact.
  std::uint64_t black = 0;
  std::uint64_t gray = 0;
  for (const OctreeLevel& level : levels) {
    black = 8 * black + level.black;
    gray = 8 * gray + level.gray;
  }
  const double size = edge(root, static_cast<int>(levels.size()) - 1);
  const auto cubes = [size](std::uint64_t count, Direction direction) {
    constexpr double high = 0x1p32;
    double product = multiply(static_cast<double>(count >> 32U), high, direction);
    product = add(product, static_cast<double>(count & 0xffffffffU), direction);
    for (int axis = 0; axis < 3; ++axis) product = multiply(product, size, direction);
    return product;
  };
  return {cubes(black, Direction::down), cubes(black + gray, Direction::up)};
}

SiblingColours::SiblingColours(const Model& model)
    : tree_(std::make_shared<const SetNode>(normal_form(model, Side::inside))) {
  for (const Primitive& primitive : model.primitives) primitives_.emplace_back(primitive);
}

UndecidedCube SiblingColours::root() const {
  return {{{0, 0, 0}, 0, CubeColour::gray}, tree_};
}

std::array<UndecidedCube, 8> SiblingColours::operator()(const OctreeRoot& root, const UndecidedCube& parent) const {
  TreeColours primitive_colours(primitives_);
  std::array<UndecidedCube, 8> children;
  for (unsigned child = 0; child < 8; ++child) {
    OctreeCube cube = child_of(parent.cube, child);
    const std::span<const Colour> colours = primitive_colours(*parent.tree, cube_of(root, cube));
    const Colour found = colour(*parent.tree, colours);
    if (found != Colour::gray) {
      cube.colour = found == Colour::black ? CubeColour::black : CubeColour::white;
      children[child] = {cube, nullptr};
      continue;
    }
    children[child] = {cube, primitive_colours.any_decided()
                                 ? std::make_shared<const SetNode>(simplified(*parent.tree, colours))
                                 : parent.tree};
  }
  return children;
}

}  // namespace verify

}  // namespace verisq
