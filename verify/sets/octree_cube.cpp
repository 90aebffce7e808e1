/// The root by exact powers of two; colours by the tree of the undecided primitives alone.
#include "verify/sets/octree_cube.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "verify/numbers/rounding.hpp"
#include "verify/sets/bounding_box.hpp"
#include "verify/sets/tree_colours.hpp"
#include "verisq/error.hpp"

namespace verisq {

double edge(const OctreeRoot& root, int level) {
  return std::ldexp(root.half_width, 1 - level);
}

Point lower_corner(const OctreeRoot& root, const OctreeCube& cube) {
  const double size = edge(root, cube.level);
  Point corner{};
  // Multiples of the deepest edge below 2^53 of them (octree_root): no operation rounds.
  for (std::size_t i = 0; i < 3; ++i) corner[i] = root.centre[i] - root.half_width + size * cube.position[i];
  return corner;
}

namespace verify {

namespace {

constexpr double centres_per_half_width = 1024.0;  // the grid of centres
constexpr double farthest_centre = 0x1p30;  // in half-widths: corners are then multiples of the deepest half edge
                                            // below 2^53 of them

bool contains(const OctreeRoot& root, const Box& box) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::abs(root.centre[i]) <= farthest_centre * root.half_width)) return false;
    if (!(root.centre[i] - root.half_width <= box.lower[i] && box.upper[i] <= root.centre[i] + root.half_width))
      return false;
  }
  return true;
}

OctreeRoot centred_on(const Box& box, double half_width) {
  const double grid = half_width / centres_per_half_width;
  OctreeRoot root{{}, half_width};
  for (std::size_t i = 0; i < 3; ++i) {
    const double middle = 0.5 * box.lower[i] + 0.5 * box.upper[i];
    root.centre[i] = std::nearbyint(middle / grid) * grid;
  }
  return root;
}

}  // namespace

OctreeRoot octree_root(const Model& model) {
  const Box box = bounding_box(model);
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, box.upper[i] - box.lower[i]);
  if (!std::isfinite(largest)) throw Error(ErrorKind::input, "octree: the size of the model overflows");
  int exponent = std::ilogb(largest) - 1;
  // Half-widths below have cubes that underflow, those above corners that overflow.
  exponent = std::max(exponent, std::numeric_limits<double>::min_exponent + deepest_octree_level);
  for (; exponent < std::numeric_limits<double>::max_exponent - 2; ++exponent) {
    const double half_width = std::ldexp(1.0, exponent);
    const OctreeRoot root = centred_on(box, half_width);
    if (contains(root, box)) return root;
    if (half_width > 4.0 * largest) break;
  }
  throw Error(ErrorKind::input, "octree: the model is too far from the origin for its size");
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
