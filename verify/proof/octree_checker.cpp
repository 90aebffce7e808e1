/// Cubes by the places of their parts; what is left out by the gaps between cubes in Morton's order.
#include "verisq/octree_checker.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "verify/proof/exact_checker.hpp"
#include "verisq/error.hpp"

namespace verisq {

namespace {

using namespace verify;

/// Cubes of the deepest level in one of this level.
std::uint64_t size_of(int level) {
  return std::uint64_t{1} << static_cast<unsigned>(3 * (deepest_octree_level - level));
}

/// How many cubes of the deepest level come before it, eight siblings after each other.
std::uint64_t order_of(const OctreeCube& cube) {
  std::uint64_t order = 0;
  for (unsigned bit = 0; bit < 60; ++bit) order |= (cube.position[bit % 3] >> bit / 3 & std::uint64_t{1}) << bit;
  return order * size_of(cube.level);
}

ColouredCube coloured(std::uint64_t order, int level, CubeColour colour) {
  ColouredCube result{{}, std::ldexp(1.0, -level), colour};
  for (std::size_t i = 0; i < 3; ++i) {
    std::uint64_t position = 0;
    for (std::uint64_t bit = 0; bit < 20; ++bit) position |= (order / size_of(level) >> (3 * bit + i) & 1U) << bit;
    result.centre[i] = (2.0 * static_cast<double>(position) + 1.0) * result.half_width - 1.0;
  }
  return result;
}

}  // namespace

struct OctreeChecker::State {
  /// What is left white between one place in the order and another, in the largest cubes that fit.
  void leave_white(std::uint64_t at, std::uint64_t next) {
    for (int level = 0; at < next; at += size_of(level)) {
      for (level = 0; at % size_of(level) != 0 || size_of(level) > next - at;) ++level;
      cubes.push_back(coloured(at, level, CubeColour::white));
    }
  }

  /// Three times as large as the cube of this half-width about the root's centre, but for that cube.
  void add_shell(double half_width) {
    for (int n = 0; n < 27; ++n) {
      const auto beside = [&](int digit) { return 2.0 * half_width * (digit % 3 - 1); };
      if (n != 13) cubes.push_back({{beside(n), beside(n / 3), beside(n / 9)}, half_width, CubeColour::white});
    }
  }

  /// Whether all spheres about primitives lie in the ball of this radius about the root's centre.
  [[nodiscard]] bool reaches_no_farther(double radius) const {
    const auto is_near = [&](const auto& solid) {
      const PreciseInterval reach = length<Real>(PreciseVector(solid.motion().translation - centre)) + solid.radius();
      return reach.upper() <= (PreciseInterval(Real(radius)) * unit).lower();
    };
    return std::ranges::all_of(checker.primitives(), [&](const auto& p) { return std::visit(is_near, p); });
  }

  [[nodiscard]] PreciseInterval volume_of(std::uint64_t count) const {
    const PreciseInterval edge = unit * PreciseInterval(Real(0x1p-19));
    return edge * edge * edge * PreciseInterval(Real(static_cast<long double>(count)));  // exactly: below 2^61
  }

  ExactChecker checker;
  PreciseVector centre;
  PreciseInterval unit;  ///< the root's half-width
  std::vector<ColouredCube> cubes = {};
  Enclosure volume = {};
};

OctreeChecker::OctreeChecker(const Model& model, const OctreeRoot& root, std::span<const OctreeCube> cubes)
    : state_(std::make_unique<State>(State{ExactChecker(model), precise(root.centre), Real(root.half_width)})) {
  std::vector<OctreeCube> kept;
  for (const OctreeCube& cube : cubes) {
    const auto beyond = [&](std::uint32_t p) { return cube.level > deepest_octree_level || p >> cube.level != 0; };
    if (std::ranges::any_of(cube.position, beyond)) throw Error(ErrorKind::input, "octree: a cube beyond the root");
    if (cube.colour != CubeColour::white) kept.push_back(cube);
  }
  std::ranges::sort(kept, {}, order_of);
  std::uint64_t end = 0;
  std::array<std::uint64_t, 2> counts{};  // gray, black
  for (const OctreeCube& cube : kept) {
    const std::uint64_t begin = order_of(cube);
    if (begin < end) throw Error(ErrorKind::input, "octree: two cubes overlap");
    state_->leave_white(end, begin);
    const bool black = cube.colour == CubeColour::black;
    if (black) state_->cubes.push_back(coloured(begin, cube.level, cube.colour));
    counts[black ? 1 : 0] += size_of(cube.level);
    end = begin + size_of(cube.level);
  }
  state_->leave_white(end, size_of(0));
  // Solids may touch the root's faces: shells begin beside it, and (1 + 2^-40)^3 < 1 + 2^-60 (3 * 2^20 + 1).
  double reach = 1.0 + 0x1p-40;
  counts[0] += (3U << 20U) + 1;
  const auto three_times = [](double x) {
    return multiply(Real(x), Real(3), Direction::down).to_double(Direction::down);
  };
  for (; !state_->reaches_no_farther(reach) && reach < 0x1p50; reach = three_times(reach)) state_->add_shell(reach);
  // A power of 2, so that the halves of cubes are exact.
  int exponent = 0;
  if (!(std::frexp(root.half_width, &exponent) == 0.5 && reach < 0x1p50)) {
    throw Error(ErrorKind::input, "octree: no root of this model");
  }
  state_->volume = {state_->volume_of(counts[1]).lower().to_double(Direction::down),
                    state_->volume_of(counts[0] + counts[1]).upper().to_double(Direction::up)};
}

OctreeChecker::~OctreeChecker() = default;

const std::vector<ColouredCube>& OctreeChecker::cubes() const {
  return state_->cubes;
}

Enclosure OctreeChecker::volume() const {
  return state_->volume;
}

bool OctreeChecker::proves(const ColouredCube& cube) const {
  constexpr int most_looks = 4096;
  const PreciseVector from_centre(Real(cube.centre[0]), Real(cube.centre[1]), Real(cube.centre[2]));
  const EmptyNeighbourhood all(state_->checker.set(), state_->checker.primitives(),
                               state_->centre + from_centre * state_->unit,
                               (PreciseInterval(Real(cube.half_width)) * state_->unit).upper(),
                               cube.colour == CubeColour::black ? Place::inside : Place::outside);
  std::vector<EmptyNeighbourhood::Cell> open{all.whole()};
  for (int looks = 0; !open.empty(); ++looks) {
    const EmptyNeighbourhood::Cell cell = open.back();
    open.pop_back();
    if (all.is_empty(cell)) continue;
    const auto halves = all.halves(cell);
    if (looks == most_looks || !halves) return false;
    open.insert(open.end(), halves->begin(), halves->end());
  }
  return true;
}

}  // namespace verisq
