/// Checks rows of maps, and defines the report of a check when two proofs contradict each other.
#include "verisq/checker.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "verify/proof/model_checker.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/solids/model.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq {

struct Checker::State {
  State(const Bracket& models, double point_radius)
      : bounds(models, point_radius),
        checkers(verify::bracketed(models, [](const Model& model) { return verify::ModelChecker(model); })) {}

  template <class Query>
  [[nodiscard]] Finding check(const Query& query, const Enclosure& claimed, const Certificate& certificate,
                              const verify::Hook& interrupted) const {
    if (bounds.exact()) {
      const Enclosure proven = checkers.smallest(query, claimed, certificate, interrupted);
      return verify::judged(claimed, proven, proven);
    }
    // A cover, and a witness, are of several primitives together, between which small motions may open a gap (§8).
    Certificate one_by_one = certificate;
    one_by_one.witness.reset();
    one_by_one.cover.clear();
    // Each end for itself: the other is claimed to be infinite, so that no work is spent on it.
    const auto prove = [&](const verify::ModelChecker& checker, const Enclosure& end) {
      return checker(query, end, one_by_one, interrupted);
    };
    const Enclosure above = prove(checkers.smallest, {-infinity, bounds.upper_asked_for(claimed.hi)});
    const Enclosure below = prove(checkers.of_largest(), {claimed.lo, infinity});
    double lower = bounds.unsigned_lower(below.lo);
    if constexpr (std::is_same_v<Query, Point>) {
      std::optional<double> of_inflated;
      if (checkers.inflated) of_inflated = prove(*checkers.inflated, {claimed.lo, infinity}).lo;
      lower = bounds.signed_lower(below.lo, of_inflated);
    }
    const Enclosure proven =
        verify::between(lower, bounds.upper(above.hi), [] { return "a distance to the uncertain model"; });
    // Both models are members themselves: the midpoints of their translations lie in the intervals.
    return verify::judged(claimed, proven, {above.lo, below.hi});
  }

  verify::MemberBounds bounds;
  verify::Bracketed<verify::ModelChecker> checkers;
};

Checker::Checker(const UncertainModel& model, double point_radius)
    : state_(std::make_unique<State>(verify::bracket_of_primitives(model), point_radius)) {
  if (state_->bounds.exact()) return;
  const Model largest = verify::bracket_of_primitives(model).largest;
  if (!has_mesh(largest)) {
    verify::require_union(largest, "certificates of intervals");
  } else if (!is_exact(model)) {
    throw Error(ErrorKind::input, "a model with meshes is checked only if all of its numbers are exact");
  }
}
Checker::~Checker() = default;
Checker::Checker(Checker&&) noexcept = default;
Checker& Checker::operator=(Checker&&) noexcept = default;

Finding Checker::operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                            const std::function<bool()>& interrupted) const {
  verify::require_finite(point, "point");
  return state_->check(point, claimed, certificate, interrupted);
}

Finding Checker::operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                            const std::function<bool()>& interrupted) const {
  for (const Point& corner : triangle) verify::require_finite(corner, "corner");
  return state_->check(triangle, claimed, certificate, interrupted);
}

namespace {

using namespace verify;

/// Cubes of the deepest level in one of this level.
std::uint64_t size_of(int level) {
  return std::uint64_t{1} << static_cast<unsigned>(3 * (deepest_octree_level - level));
}

/// The number of cubes of the deepest level before this one; eight siblings follow each other.
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

bool is_binary64(const PreciseInterval& x) {
  const double nearest = x.lower().to_double(Direction::down);
  return Real(nearest) == x.lower() && x.lower() == x.upper() && std::isfinite(nearest);
}

/// A file draws corners as binary64 numbers, which must be the corners of the cubes that are proven. The root's lower
/// corner comes first: the others are drawn from it.
void require_exact_corners(const OctreeRoot& root, std::span<const OctreeCube> cubes) {
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval half(Real(root.half_width));
    const PreciseInterval lowest = PreciseInterval(Real(root.centre[i])) - half;
    const auto exact = [&](const OctreeCube& cube) {
      const PreciseInterval edge = half * PreciseInterval(Real(std::ldexp(2.0, -cube.level)));
      const PreciseInterval lower = lowest + edge * PreciseInterval(Real(static_cast<double>(cube.position[i])));
      return is_binary64(lower) && is_binary64(lower + edge);
    };
    if (!is_binary64(lowest) || !std::ranges::all_of(cubes, exact))
      throw Error(ErrorKind::input, "octree: a corner is no binary64 number: what is drawn is not what is proven");
  }
}

}  // namespace

struct OctreeChecker::State {
  /// Adds white cubes between two places in the order: the largest cubes that fit.
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

  /// Returns whether all spheres about primitives are proven to lie in the ball of this radius about the root's centre.
  [[nodiscard]] bool reaches_no_farther(double radius) const {
    return places.reach(centre) <= (PreciseInterval(Real(radius)) * unit).lower();
  }

  [[nodiscard]] PreciseInterval volume_of(std::uint64_t count) const {
    const PreciseInterval edge = unit * PreciseInterval(Real(0x1p-19));
    return edge * edge * edge * PreciseInterval(Real(static_cast<long double>(count)));  // exactly: below 2^61
  }

  std::optional<ExactChecker> checker;  ///< of a model without meshes
  CubePlaces places;
  PreciseVector centre;
  PreciseInterval unit;  ///< the root's half-width
  std::vector<ColouredCube> cubes = {};
  Enclosure volume = {};
};

OctreeChecker::OctreeChecker(const Model& model, const OctreeRoot& root, std::span<const OctreeCube> cubes)
    : state_(std::make_unique<State>(State{{}, CubePlaces(model), precise(root.centre), Real(root.half_width)})) {
  if (!has_mesh(model)) state_->checker.emplace(model);
  std::vector<OctreeCube> kept;
  for (const OctreeCube& cube : cubes) {
    const auto beyond = [&](std::uint32_t p) { return cube.level > deepest_octree_level || p >> cube.level != 0; };
    if (std::ranges::any_of(cube.position, beyond)) throw Error(ErrorKind::input, "octree: a cube beyond the root");
    if (cube.colour != CubeColour::white) kept.push_back(cube);
  }
  require_exact_corners(root, cubes);
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

bool OctreeChecker::proves(const ColouredCube& cube, const std::function<bool()>& interrupted) const {
  constexpr int most_looks = 4096;
  const PreciseVector from_centre(Real(cube.centre[0]), Real(cube.centre[1]), Real(cube.centre[2]));
  const PreciseVector centre = state_->centre + from_centre * state_->unit;
  const Real half_width = (PreciseInterval(Real(cube.half_width)) * state_->unit).upper();
  const Place wanted = cube.colour == CubeColour::black ? Place::inside : Place::outside;
  if (!state_->checker) return state_->places.lies(wanted, centre, half_width, interrupted);
  const EmptyNeighbourhood all(state_->checker->set(), state_->checker->primitives(), centre, half_width, wanted);
  std::vector<EmptyNeighbourhood::Cell> open{all.whole()};
  for (int looks = 0; !open.empty(); ++looks) {
    if (interrupted && interrupted()) return false;
    const EmptyNeighbourhood::Cell cell = open.back();
    open.pop_back();
    if (all.is_empty(cell)) continue;
    const auto halves = all.halves(cell);
    if (looks == most_looks || !halves || all.is_refuted_at_middle(cell)) return false;
    open.insert(open.end(), halves->begin(), halves->end());
  }
  return true;
}

}  // namespace verisq

namespace verisq::verify {

namespace {

/// The shortest digits that give the same number again.
std::string digits(double x) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), x).ptr};
}

std::string text_of(const Enclosure& e) {
  return std::string("[").append(digits(e.lo)).append(", ").append(digits(e.hi)).append("]");
}

}  // namespace

std::string text_of(const Point& x) {
  std::string text("(");
  return text.append(digits(x[0])).append(", ").append(digits(x[1])).append(", ").append(digits(x[2])).append(")");
}

void report_contradiction(const Enclosure& a, const Enclosure& b, const std::string& what) {
  throw Error(ErrorKind::failure, "two proofs contradict each other: " + what + " lies in " + text_of(a) + " and in " +
                                      text_of(b) + "; one of them is wrong, please report it");
}

}  // namespace verisq::verify
