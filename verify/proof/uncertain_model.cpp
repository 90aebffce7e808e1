/// The bracketing models, each of their numbers rounded to the safe side.
#include "verisq/uncertain_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/proof/contained_ball.hpp"
#include "verify/proof/convex_union.hpp"
#include "verisq/error.hpp"

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

double low(const Enclosure& interval) {
  return interval.lo;
}

double high(const Enclosure& interval) {
  return interval.hi;
}

/// In the interval, because rounding is monotone.
double middle(const Enclosure& interval) {
  return std::midpoint(interval.lo, interval.hi);
}

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

/// Contains K + d for every |d| <= s. K is convex and contains the ball B(r) about its centre, hence
/// K + d ⊂ K + B(s) = K + (s/r) B(r) ⊂ K + (s/r) K = (1 + s/r) K; semi-axes rounded up only add to it.
Superquadric inflated(const Superquadric& solid, const PreciseInterval& shift) {
  const PreciseInterval factor = PreciseInterval(1) + shift / inner_radius(solid);
  Superquadric result = solid;
  for (double& axis : result.semi_axes) axis = (PreciseInterval(Real(axis)) * factor).upper().to_double(Direction::up);
  return result;
}

bool removes(const SetExpression& expression) {
  return (expression.operation == SetOperation::subtract && expression.operands.size() > 1) ||
         std::ranges::any_of(expression.operands, removes);
}

/// The primitives that a tree names, those that it removes apart from those that it keeps: a solid grows where what it
/// keeps grows, and shrinks where what it removes does (docs/mathematics.md §8).
class NamedPrimitives {
 public:
  struct Use {
    std::uint32_t primitive;
    bool removed;
    bool operator==(const Use&) const = default;
  };

  /// The same tree, with indices of uses(). What is removed from something that is removed is kept.
  [[nodiscard]] SetExpression renamed(const SetExpression& expression, bool removed = false) {
    SetExpression result{.operation = expression.operation};
    for (std::size_t i = 0; i < expression.operands.size(); ++i) {
      const bool turns = expression.operation == SetOperation::subtract && i > 0;
      result.operands.push_back(renamed(expression.operands[i], removed != turns));
    }
    if (expression.operands.empty()) result.primitive = index_of({expression.primitive, removed});
    return result;
  }
  [[nodiscard]] const std::vector<Use>& uses() const { return uses_; }

 private:
  [[nodiscard]] std::uint32_t index_of(const Use& use) {
    const auto found = std::ranges::find(uses_, use);
    const auto index = static_cast<std::uint32_t>(found - uses_.begin());
    if (found == uses_.end()) uses_.push_back(use);
    return index;
  }

  std::vector<Use> uses_;
};

/// Of what is removed the other model's: where the one has its smallest the other has its largest.
void exchange_what_is_removed(Bracket& models) {
  NamedPrimitives named;
  const SetExpression csg = named.renamed(*models.smallest.csg);
  Model smallest{models.smallest.units, {}, csg};
  Model largest{models.largest.units, {}, csg};
  for (const auto& [primitive, removed] : named.uses()) {
    smallest.primitives.push_back((removed ? models.largest : models.smallest).primitives[primitive]);
    largest.primitives.push_back((removed ? models.smallest : models.largest).primitives[primitive]);
  }
  models.smallest = std::move(smallest);
  models.largest = std::move(largest);
}

void check_finite(double shift, const Superquadric& solid, std::size_t index) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (finite(shift) && std::ranges::all_of(solid.semi_axes, finite)) return;
  throw Error(ErrorKind::input, "primitives[" + std::to_string(index) +
                                    "].pose.translation: its uncertainty makes the sizes of the solid overflow");
}

}  // namespace

UncertainModel::UncertainModel(const Model& exact) : units(exact.units), csg(exact.csg) {
  for (const auto& [name, superquadric, pose, bend] : exact.primitives) {
    primitives.push_back({name, exactly(superquadric.semi_axes), exactly(superquadric.exponents),
                          exactly(pose.translation), pose.quaternion, bend, superquadric.taper});
  }
}

bool is_exact(const UncertainModel& model) {
  return std::ranges::all_of(model.primitives, [](const UncertainPrimitive& primitive) {
    return all_exact(primitive.semi_axes) && all_exact(primitive.exponents) && all_exact(primitive.translation);
  });
}

Bracket bracket(const UncertainModel& model) {
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
    result.smallest.primitives.push_back({primitive.name, small, pose, primitive.bend});
    result.largest.primitives.push_back({primitive.name, large, pose, primitive.bend});
    everywhere.primitives.push_back({primitive.name, moves ? inflated(large, shift) : large, pose, primitive.bend});
    result.shift = std::max(result.shift, shift.upper().to_double(Direction::up));
    check_finite(result.shift, everywhere.primitives.back().superquadric, everywhere.primitives.size() - 1);
  }
  if (!is_exact(model)) {
    require_no_taper(result.largest, "intervals");
    if (result.shift > 0.0) require_union_of_convex(result.largest, "intervals of translations");
    if (model.csg && removes(*model.csg)) exchange_what_is_removed(result);
  }
  if (model.primitives.size() > 1 && result.shift > 0.0) result.inflated = std::move(everywhere);
  return result;
}

}  // namespace verisq
