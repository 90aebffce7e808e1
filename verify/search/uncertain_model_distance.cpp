/// Two distances of ordinary models, each widened by how far primitives may move.
#include "verisq/uncertain_model_distance.hpp"

#include <algorithm>

#include "verify/numbers/rounding.hpp"
#include "verify/proof/intersection.hpp"

namespace verisq {

using namespace verify;

struct UncertainPairDistance::State {
  State(const Bracket& a, const Bracket& b)
      : smallest(a.smallest, b.smallest), largest(a.largest, b.largest), shift_a(a.shift), shift_b(b.shift) {}

  // The distance of unions is the least of their primitives', overlapping or not, and a rigid motion of B moves its
  // primitives' shifts along. Of two primitives K of A and L of B: smaller ones are at least as far apart, larger ones
  // at most; moving K by at most shift_a and L by at most shift_b changes their distance by at most the sum.
  PairDistance smallest;
  PairDistance largest;
  double shift_a;
  double shift_b;
};

UncertainPairDistance::UncertainPairDistance(const UncertainModel& a, const UncertainModel& b)
    : state_(std::make_unique<State>(bracket(a), bracket(b))) {}
UncertainPairDistance::~UncertainPairDistance() = default;
UncertainPairDistance::UncertainPairDistance(UncertainPairDistance&&) noexcept = default;
UncertainPairDistance& UncertainPairDistance::operator=(UncertainPairDistance&&) noexcept = default;

UncertainModelDistance UncertainPairDistance::operator()(const Pose& pose,
                                                         const std::function<bool()>& interrupted) const {
  const double shift_a = state_->shift_a;
  const double shift_b = state_->shift_b;
  const ModelDistance largest = state_->largest(pose, interrupted);
  const ModelDistance smallest = state_->smallest(pose, interrupted);
  const double of_largest = largest.distance.lo;
  const double of_smallest = smallest.distance.hi;
  const double lower = subtract(subtract(of_largest, shift_a, Direction::down), shift_b, Direction::down);
  const double upper = add(add(of_smallest, shift_a, Direction::up), shift_b, Direction::up);
  const Enclosure distance =
      between(std::max(0.0, lower), upper, [] { return "the distance of the uncertain models"; });
  // Solids are closed: members at distance 0 have a common point.
  const Proximity proximity = distance.lo > 0.0    ? Proximity::separated
                              : distance.hi == 0.0 ? Proximity::overlapping
                                                   : Proximity::undecided;
  return {distance, proximity, largest.complete && smallest.complete};
}

}  // namespace verisq
