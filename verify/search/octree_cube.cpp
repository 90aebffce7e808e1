/// This file implements octree_cube.hpp.
#include "verify/search/octree_cube.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/search/set_tree.hpp"
#include "verisq/checker.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

constexpr double centres_per_half_width = 1024.0;
constexpr int smallest_exponent = std::numeric_limits<double>::min_exponent + deepest_octree_level;
/// Above, corners overflow.
constexpr int largest_exponent = std::numeric_limits<double>::max_exponent - 3;

static_assert(smallest_exponent == -1001);  // smallest_root

bool keeps(const Cube& cube, const Box& box, const RootCubeRule& rule) {
  const double reach = (1.0 - rule.margin) * cube.half_width;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::fabs(cube.centre[i]) <= rule.farthest * cube.half_width)) return false;
    if (!(add(cube.centre[i], -reach, Direction::up) <= box.lower[i])) return false;
    if (!(add(cube.centre[i], reach, Direction::down) >= box.upper[i])) return false;
  }
  return true;
}

/// c + step where that is exact.
std::optional<double> exact_sum(double c, double step) {
  const double down = add(c, step, Direction::down);
  if (!std::isfinite(down) || down != add(c, step, Direction::up)) return std::nullopt;
  return down;
}

}  // namespace

std::optional<Cube> root_cube(const Box& box, const RootCubeRule& rule) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, box.upper[i] - box.lower[i]);
  if (!std::isfinite(largest)) return std::nullopt;
  // A half-width of less than half the largest side holds nothing.
  const int first = largest > 0.0 ? std::max(std::ilogb(largest) - 1, smallest_exponent) : smallest_exponent;
  for (int exponent = first; exponent <= largest_exponent; ++exponent) {
    Cube cube{{}, std::ldexp(1.0, exponent)};
    const double grid = cube.half_width / centres_per_half_width;
    for (std::size_t i = 0; i < 3; ++i) {
      const double middle = 0.5 * box.lower[i] + 0.5 * box.upper[i];
      cube.centre[i] = std::nearbyint(middle / grid) * grid;
    }
    if (keeps(cube, box, rule)) return cube;
  }
  return std::nullopt;
}

std::optional<std::array<Cube, 8>> halves(const Cube& cube) {
  const double half = cube.half_width / 2;
  std::array<std::array<double, 2>, 3> centres{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> low = exact_sum(cube.centre[i], -half);
    const std::optional<double> high = exact_sum(cube.centre[i], half);
    if (!low || !high || half + half != cube.half_width) return std::nullopt;
    centres[i] = {*low, *high};
  }
  std::array<Cube, 8> result{};
  for (std::size_t n = 0; n < 8; ++n) {
    result[n] = {{centres[0][n & 1U], centres[1][(n >> 1U) & 1U], centres[2][n >> 2U]}, half};
  }
  return result;
}

bool contains(const Cube& cube, const Point& x) {
  for (std::size_t i = 0; i < 3; ++i) {
    // Decides exactly: no binary64 number lies between the exact difference and the rounded one.
    const Interval offset = abs(Interval(x[i]) - Interval(cube.centre[i]));
    if (!(offset.upper() <= cube.half_width)) return false;
  }
  return true;
}

Enclosure distance(const Point& x, const Cube& cube) {
  // Precise: squares of binary64 numbers may overflow.
  PreciseVector outside;
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval beyond = abs(PreciseInterval(Real(x[i])) - PreciseInterval(Real(cube.centre[i]))) -
                                   PreciseInterval(Real(cube.half_width));
    outside[i] = {std::max(Real(0), beyond.lower()), std::max(Real(0), beyond.upper())};
  }
  const PreciseInterval length_outside = length<Real>(outside);
  return {length_outside.lower().to_double(Direction::down), length_outside.upper().to_double(Direction::up)};
}

Enclosure distance_to_faces(const Point& x, const Cube& cube) {
  Enclosure nearest{cube.half_width, cube.half_width};
  for (std::size_t i = 0; i < 3; ++i) {
    const Interval to_face = Interval(cube.half_width) - abs(Interval(x[i]) - Interval(cube.centre[i]));
    nearest = {std::min(nearest.lo, to_face.lower()), std::min(nearest.hi, to_face.upper())};
  }
  return {std::max(0.0, nearest.lo), std::max(0.0, nearest.hi)};
}

}  // namespace verisq::verify

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
  // A cube far larger than the model would waste levels on empty cubes.
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

namespace verisq::verify {

namespace {

constexpr Enclosure kNothing{-infinity, infinity};

PreciseInterval exactly(double x) {
  return PreciseInterval(Real(x));
}

PreciseInterval way(const Point& x, const Point& y) {
  PreciseVector between;
  for (std::size_t i = 0; i < 3; ++i) between[i] = exactly(x[i]) - exactly(y[i]);
  return length<Real>(between);
}

/// A lower end. Outside the box, the model is at least as far as the box; inside, no point beyond the nearest face
/// belongs to the model.
double lower_by_box(const Point& x, const Box& box) {
  PreciseVector outside;
  double depth = infinity;
  for (std::size_t i = 0; i < 3; ++i) {
    const double beyond = std::max(subtract(box.lower[i], x[i], Direction::down),  //
                                   subtract(x[i], box.upper[i], Direction::down));
    outside[i] = exactly(std::max(0.0, beyond));
    depth = std::min(depth, -beyond);
  }
  return depth >= 0.0 ? 0.0 - depth : rounded_outward(length<Real>(outside)).lo;
}

/// Far enough beyond the nearest face of the box that no rounding error brings it back.
Point beyond_nearest_face(const Point& x, const Box& box) {
  Point escape = x;
  double least = infinity;
  for (std::size_t i = 0; i < 3; ++i) {
    const double margin = 0x1p-40 * (box.upper[i] - box.lower[i]);
    for (const double face : {box.lower[i] - margin, box.upper[i] + margin}) {
      if (!(std::fabs(face - x[i]) < least)) continue;
      least = std::fabs(face - x[i]);
      escape = x;
      escape[i] = face;
    }
  }
  return escape;
}

}  // namespace

CoarseDistance::CoarseDistance(const Model& model, std::vector<KnownDistance> known)
    : box_(bounding_box(model)), known_(std::move(known)) {}

Enclosure CoarseDistance::operator()(const Point& x) const {
  Enclosure result{lower_by_box(x, box_), infinity};
  for (const auto& [at, distance] : known_) {
    const Enclosure far = rounded_outward(way(x, at));
    const Enclosure by_way{subtract(distance.lo, far.hi, Direction::down), add(distance.hi, far.hi, Direction::up)};
    result = intersection(result, by_way, [&] { return "the signed distance at " + text_of(x); });
  }
  return result;
}

CoarseProof::CoarseProof(const Model& model) : checker_(model), box_(bounding_box(model)) {
  for (const Primitive& primitive : model.primitives) centres_.push_back(primitive.pose.translation);
}

Normal CoarseProof::towards_nearest_centre(const Point& x) const {
  const auto apart = [&](const Point& c) { return std::hypot(c[0] - x[0], c[1] - x[1], c[2] - x[2]); };
  const auto nearest = std::ranges::min_element(centres_, {}, apart);
  // An upper end is that of the point on the ray from the centre through x - v: v may be next to nothing.
  return {static_cast<std::uint32_t>(nearest - centres_.begin()), {0x1p-900, 0.0, 0.0}};
}

CertifiedEnclosure CoarseProof::operator()(const Point& x) const {
  Certificate certificate{{towards_nearest_centre(x)}, beyond_nearest_face(x, box_)};
  const Enclosure proven = checker_(x, kNothing, certificate);
  if (proven.lo > 0.0) certificate.escape.reset();  // the spheres prove it
  return {proven, certificate};
}

CertifiedEnclosure CoarseProof::operator()(const Triangle& triangle) const {
  const Certificate certificate{{towards_nearest_centre(triangle[0])}, std::nullopt, {{0.0, 0.0}}};
  return {checker_(triangle, kNothing, certificate), certificate};
}

CertifiedEnclosure CoarseProof::by_spheres(const Point& x) const {
  return {checker_(x, kNothing, {}), {}};
}

}  // namespace verisq::verify
