/// This file implements uncertain_model.hpp.
#include "verify/proof/uncertain_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "verify/numbers/real.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/solids/model.hpp"
#include "verisq/error.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {
namespace {

/// Rounded twice to one side, which is rounded once.
double sum(double a, double b, Direction direction) {
  return add(Real(a), Real(b), direction).to_double(direction);
}

}  // namespace

// A shift is 0 only where all translations are exact: it is rounded up.
MemberBounds::MemberBounds(const Bracket& bracket, double point_radius)
    : shift_(bracket.shift),
      other_shift_(point_radius),
      exact_(same_solids(bracket) && bracket.shift == 0.0 && point_radius == 0.0) {}

MemberBounds::MemberBounds(const Bracket& a, const Bracket& b)
    : shift_(a.shift),
      other_shift_(b.shift),
      exact_(same_solids(a) && same_solids(b) && a.shift == 0.0 && b.shift == 0.0) {}

double MemberBounds::upper(double of_smallest) const {
  return sum(sum(of_smallest, shift_, Direction::up), other_shift_, Direction::up);
}

// The same steps backwards: y <= claimed - radius and x <= y - shift give x + shift <= y and y + radius <= claimed, and
// rounding up to binary64 does not pass the binary64 numbers y and claimed. In turn x is not below an upper end that
// `upper` turned into `claimed`.
double MemberBounds::upper_asked_for(double claimed) const {
  return sum(sum(claimed, -other_shift_, Direction::down), -shift_, Direction::down);
}

double MemberBounds::signed_lower(double of_largest, std::optional<double> of_inflated) const {
  double lower = sum(of_largest, -shift_, Direction::down);
  if (of_inflated) lower = lower > 0.0 ? std::max(lower, *of_inflated) : *of_inflated;
  return sum(lower, -other_shift_, Direction::down);
}

double MemberBounds::unsigned_lower(double of_largest) const {
  return std::max(0.0, sum(sum(of_largest, -shift_, Direction::down), -other_shift_, Direction::down));
}

}  // namespace verisq::verify

namespace verisq {
namespace {

using namespace verify;

template <std::size_t N>
std::array<Enclosure, N> exactly(const std::array<double, N>& numbers) {
  std::array<Enclosure, N> intervals{};
  std::ranges::transform(numbers, intervals.begin(), [](double x) { return Enclosure{x, x}; });
  return intervals;
}

template <std::size_t N>
std::array<double, N> mapped(const std::array<Enclosure, N>& intervals, double (*choose)(const Enclosure&)) {
  std::array<double, N> numbers{};
  std::ranges::transform(intervals, numbers.begin(), choose);
  return numbers;
}

constexpr auto low = [](const Enclosure& interval) { return interval.lo; };
constexpr auto high = [](const Enclosure& interval) { return interval.hi; };
/// The middle lies in the interval, because rounding is monotone.
constexpr auto middle = [](const Enclosure& interval) { return std::midpoint(interval.lo, interval.hi); };

template <std::size_t N>
bool all_exact(const std::array<Enclosure, N>& intervals) {
  return std::ranges::all_of(intervals, [](const Enclosure& e) { return e.lo == e.hi; });
}

/// The farthest that the translation lies from the midpoint, which the rounding of the midpoint makes longer than half
/// the diagonal.
PreciseInterval shift_of(const UncertainPrimitive& primitive) {
  PreciseVector farthest;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [lo, hi] = primitive.translation[i];
    const PreciseInterval centre = Real(middle(primitive.translation[i]));
    const Real below = (centre - PreciseInterval(Real(lo))).upper();
    const Real above = (PreciseInterval(Real(hi)) - centre).upper();
    farthest[i] = std::max(below, above);
  }
  return length<Real>(farthest);
}

/// The result contains K + d for every |d| <= s. K is convex and contains the ball B(r) about its centre, hence K + d ⊂
/// K + B(s) = K + (s/r) B(r) ⊂ K + (s/r) K = (1 + s/r) K. Rounding the semi-axes up only enlarges it.
Superquadric inflated(const Superquadric& solid, const PreciseInterval& shift) {
  const PreciseInterval factor = PreciseInterval(1) + shift / inner_radius(solid);
  Superquadric result = solid;
  for (double& axis : result.semi_axes) axis = (PreciseInterval(Real(axis)) * factor).upper().to_double(Direction::up);
  return result;
}

void check_finite(double shift, const Superquadric& solid, std::size_t index) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (finite(shift) && std::ranges::all_of(solid.semi_axes, finite)) return;
  throw Error(ErrorKind::input, "primitives[" + std::to_string(index) +
                                    "].pose.translation: its uncertainty makes the sizes of the solid overflow");
}

}  // namespace

UncertainModel::UncertainModel(const Model& exact) : units(exact.units), csg(exact.csg) {
  for (const auto& [name, superquadric, pose, bend, mesh] : exact.primitives) {
    primitives.push_back({name, exactly(superquadric.semi_axes), exactly(superquadric.exponents),
                          exactly(pose.translation), pose.quaternion, bend, superquadric.taper, mesh});
  }
}

bool is_exact(const UncertainModel& model) {
  return std::ranges::all_of(model.primitives, [](const UncertainPrimitive& primitive) {
    return all_exact(primitive.semi_axes) && all_exact(primitive.exponents) && all_exact(primitive.translation);
  });
}

Bracket verify::bracket_of_primitives(const UncertainModel& model) {
  require_valid_with_meshes(model);
  const Model nothing_yet{model.units, {}, model.csg};
  Bracket result{nothing_yet, nothing_yet, std::nullopt, 0.0};
  Model everywhere = nothing_yet;
  for (const UncertainPrimitive& primitive : model.primitives) {
    // The gauge falls as a semi-axis rises and rises with an exponent, each on its own (docs/mathematics.md §8).
    const Superquadric small{mapped(primitive.semi_axes, low), mapped(primitive.exponents, high), primitive.taper};
    const Superquadric large{mapped(primitive.semi_axes, high), mapped(primitive.exponents, low), primitive.taper};
    const Pose pose{mapped(primitive.translation, middle), primitive.quaternion};
    const bool moves = !all_exact(primitive.translation);  // else spared: most models are exact
    const PreciseInterval shift = moves ? shift_of(primitive) : PreciseInterval(0);
    const auto add = [&](Model& to, const Superquadric& superquadric) {
      to.primitives.push_back({primitive.name, superquadric, pose, primitive.bend, primitive.mesh});
    };
    add(result.smallest, small);
    add(result.largest, large);
    add(everywhere, moves ? inflated(large, shift) : large);
    result.shift = std::max(result.shift, shift.upper().to_double(Direction::up));
    check_finite(result.shift, everywhere.primitives.back().superquadric, everywhere.primitives.size() - 1);
  }
  if (!is_exact(model)) require_no_taper(result.largest, "intervals");
  if (model.primitives.size() > 1 && result.shift > 0.0) result.inflated = std::move(everywhere);
  return result;
}

}  // namespace verisq
