/// Lower ends by the largest or the inflated model, upper ends by the smallest.
#include "verisq/checker.hpp"

#include <optional>

#include "verify/proof/bracketed.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/judgement.hpp"
#include "verify/proof/uncertain_distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {

struct Checker::State {
  State(const Bracket& models, double point_radius)
      : bounds(models, point_radius),
        checkers(verify::bracketed(models, [](const Model& model) { return verify::ExactChecker(model); })) {}

  [[nodiscard]] double lower(const Point& point, const Enclosure& claimed, const Enclosure& of_largest,
                             const Certificate& certificate) const {
    std::optional<double> of_inflated;
    if (checkers.inflated) of_inflated = (*checkers.inflated)(point, {claimed.lo, infinity}, certificate).lo;
    return bounds.signed_lower(of_largest.lo, of_inflated);
  }

  [[nodiscard]] double lower(const Triangle&, const Enclosure&, const Enclosure& of_largest, const Certificate&) const {
    return bounds.unsigned_lower(of_largest.lo);
  }

  template <class Query>
  [[nodiscard]] Finding check(const Query& query, const Enclosure& claimed, const Certificate& certificate) const {
    if (bounds.exact()) {
      const Enclosure proven = checkers.smallest(query, claimed, certificate);
      return verify::judged(claimed, proven, proven);
    }
    // A cover, and a witness, are of several primitives together, between which small motions may open a gap (§8).
    Certificate one_by_one = certificate;
    one_by_one.witness.reset();
    one_by_one.cover.clear();
    // Each end for itself: the other is claimed to be infinite, so that no work is spent on it.
    const Enclosure above = checkers.smallest(query, {-infinity, bounds.upper_asked_for(claimed.hi)}, one_by_one);
    const Enclosure below = checkers.of_largest()(query, {claimed.lo, infinity}, one_by_one);
    const Enclosure proven = verify::between(lower(query, claimed, below, one_by_one), bounds.upper(above.hi),
                                             [] { return "a distance to the uncertain model"; });
    // Both models are members themselves: the midpoints of their translations lie in the intervals.
    return verify::judged(claimed, proven, {above.lo, below.hi});
  }

  verify::MemberBounds bounds;
  verify::Bracketed<verify::ExactChecker> checkers;
};

Checker::Checker(const UncertainModel& model, double point_radius)
    : state_(std::make_unique<State>(verify::bracket_of_primitives(model), point_radius)) {
  if (!state_->bounds.exact())
    verify::require_union(verify::bracket_of_primitives(model).largest, "certificates of intervals");
}
Checker::~Checker() = default;
Checker::Checker(Checker&&) noexcept = default;
Checker& Checker::operator=(Checker&&) noexcept = default;

Finding Checker::operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate) const {
  return state_->check(point, claimed, certificate);
}

Finding Checker::operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate) const {
  return state_->check(triangle, claimed, certificate);
}

}  // namespace verisq
