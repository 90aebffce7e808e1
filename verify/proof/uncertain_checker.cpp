/// Lower ends by the largest or the inflated model, upper ends by the smallest.
#include "verisq/uncertain_checker.hpp"

#include <limits>
#include <optional>

#include "verify/proof/intersection.hpp"
#include "verify/proof/uncertain_distance.hpp"

namespace verisq {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Claims nothing of the other end, so that no work is spent on it.
Enclosure at_least(double lo) {
  return {lo, kInfinity};
}

Enclosure at_most(double hi) {
  return {-kInfinity, hi};
}

Finding judge(const Enclosure& claimed, const Enclosure& proven, const Enclosure& some_member) {
  if (claimed.lo > claimed.hi || claimed.lo > some_member.hi || claimed.hi < some_member.lo) {
    return {Verdict::refuted, proven};
  }
  if (proven.lo >= claimed.lo && proven.hi <= claimed.hi) return {Verdict::proved, proven};
  return {Verdict::unproved, proven};
}

}  // namespace

struct UncertainChecker::State {
  State(const UncertainModel& model, double point_radius) : State(bracket(model), point_radius) {
    exact = is_exact(model) && point_radius == 0.0;
  }

  State(const Bracket& models, double point_radius)
      : bounds(models, point_radius), smallest(models.smallest), largest(models.largest) {
    if (models.inflated) inflated.emplace(*models.inflated);
  }

  [[nodiscard]] double lower(const Point& point, const Enclosure& claimed, const Finding& of_largest,
                             const Certificate& certificate) const {
    std::optional<double> of_inflated;
    if (inflated) of_inflated = (*inflated)(point, at_least(claimed.lo), certificate).proven.lo;
    return bounds.signed_lower(of_largest.proven.lo, of_inflated);
  }

  [[nodiscard]] double lower(const Triangle&, const Enclosure&, const Finding& of_largest, const Certificate&) const {
    return bounds.triangle_lower(of_largest.proven.lo);
  }

  template <class Query>
  [[nodiscard]] Finding check(const Query& query, const Enclosure& claimed, const Certificate& certificate) const {
    if (exact) return smallest(query, claimed, certificate);
    const Finding above = smallest(query, at_most(bounds.upper_asked_for(claimed.hi)), certificate);
    const Finding below = largest(query, at_least(claimed.lo), certificate);
    const Enclosure proven = verify::between(lower(query, claimed, below, certificate), bounds.upper(above.proven.hi),
                                             [] { return "a distance to the uncertain model"; });
    // Both models are members themselves: the midpoints of their translations lie in the intervals.
    return judge(claimed, proven, {above.proven.lo, below.proven.hi});
  }

  verify::MemberBounds bounds;
  Checker smallest;
  Checker largest;
  std::optional<Checker> inflated;
  bool exact = false;
};

UncertainChecker::UncertainChecker(const UncertainModel& model, double point_radius)
    : state_(std::make_unique<State>(model, point_radius)) {}
UncertainChecker::~UncertainChecker() = default;
UncertainChecker::UncertainChecker(UncertainChecker&&) noexcept = default;
UncertainChecker& UncertainChecker::operator=(UncertainChecker&&) noexcept = default;

Finding UncertainChecker::operator()(const Point& point, const Enclosure& claimed,
                                     const Certificate& certificate) const {
  return state_->check(point, claimed, certificate);
}

Finding UncertainChecker::operator()(const Triangle& triangle, const Enclosure& claimed,
                                     const Certificate& certificate) const {
  return state_->check(triangle, claimed, certificate);
}

}  // namespace verisq
