/// The public entry: pairs nearest by their spheres first, each proposed and proven; uncertain models by the models
/// that bracket them.
#include "verisq/model_distance.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "verify/proof/bracketed.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/posed_pairs.hpp"
#include "verify/proof/uncertain_distance.hpp"
#include "verify/search/candidates.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/closest_points.hpp"
#include "verify/search/near_pairs.hpp"
#include "verify/search/pair_contact.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {

using namespace verify;

namespace {

/// Where the fast proposal leaves more than this, relative to the largest length at hand, a thorough one is worth it.
constexpr double kExpectedWidth = 1e-14;

struct PairResult {
  Separation separation;
  Enclosure distance;
  std::optional<Point> common;  ///< in the frame of model A; not yet proven
};

class PairQuery {
 public:
  PairQuery(const PosedPairs& pairs, std::uint32_t i, std::uint32_t j)
      : pairs_(&pairs), i_(i), j_(j), bounds_(pairs(i_, j_)) {}

  [[nodiscard]] PairResult fast() const { return result(fast_pair_contact(solid_a(), solid_b(), bounds_.relative())); }

  /// The better ends of both.
  [[nodiscard]] PairResult thorough(const PairResult& fast) const {
    PairResult found = result(thorough_pair_contact(solid_a(), solid_b(), bounds_.relative()));
    if (fast.distance.lo > found.distance.lo) {
      found.distance.lo = fast.distance.lo;
      found.separation.vector = fast.separation.vector;
    }
    if (fast.distance.hi < found.distance.hi) {
      found.distance.hi = fast.distance.hi;
      found.separation.on_a = fast.separation.on_a;
      found.separation.on_b = fast.separation.on_b;
    }
    return found;
  }

  /// What widths are measured against: no rounding is finer than that of the largest length.
  [[nodiscard]] double magnitude(const PairResult& found) const {
    return std::max({std::ranges::max(solid_a().semi_axes), std::ranges::max(solid_b().semi_axes), found.distance.hi});
  }

 private:
  [[nodiscard]] const Superquadric& solid_a() const { return bounds_.a().superquadric(); }
  [[nodiscard]] const Superquadric& solid_b() const { return bounds_.b().superquadric(); }

  [[nodiscard]] PairResult result(const PairContact& contact) const {
    PairResult r{{i_, j_, rounded(contact.vector), rounded(contact.on_a), rounded(contact.on_b)}, {}, std::nullopt};
    if (contact.common) {
      const PreciseVector x = verify::precise(*contact.common);
      r.common = rounded(midpoint(pairs_->motion_a(i_)(x)));
      // Where rounding keeps it from being proven, the nearest points of both are next to it.
      r.separation = {i_, j_, {}, rounded(*contact.common), rounded(midpoint(bounds_.relative().inverse()(x)))};
    }
    r.distance = bounds_.distance(r.separation);
    return r;
  }

  const PosedPairs* pairs_;
  std::uint32_t i_;
  std::uint32_t j_;
  PairBounds bounds_;
};

/// As PairDistance says, of exact models.
ModelDistance exact_distance(const PosedPairs& pairs, const std::function<bool()>& interrupted) {
  const NearPairs near = near_pairs(pairs);
  ModelDistance result{{near.others, infinity}, Proximity::undecided, {}};
  auto& [distance, proximity, certificate, complete] = result;
  const auto sphere_bound = [&](std::size_t k) { return pairs.lower_by_spheres(near.pairs[k].a, near.pairs[k].b); };
  for (const auto& [bound, k] : nearest_spheres_first(near.pairs.size(), sphere_bound)) {
    if (bound > distance.hi) break;  // neither this pair nor a later one can be the nearest
    if (interrupted && !certificate.separations.empty() && interrupted()) {
      distance.lo = std::min(distance.lo, std::max(0.0, bound));
      complete = false;
      break;
    }
    const PrimitivePair pair = near.pairs[k];
    const auto what = [pair] {
      return "the distance of primitives " + std::to_string(pair.a) + " and " + std::to_string(pair.b);
    };
    const PairQuery query(pairs, pair.a, pair.b);
    PairResult found = query.fast();
    if (found.common && pairs.share(*found.common)) {
      return {intersection({0.0, 0.0}, {bound, infinity}, what), Proximity::overlapping, {{}, found.common}, true};
    }
    if (!(found.distance.width() <= kExpectedWidth * query.magnitude(found))) found = query.thorough(found);
    found.distance = between(std::max({0.0, bound, found.distance.lo}), found.distance.hi, what);
    certificate.separations.push_back(found.separation);
    if (found.distance.hi < distance.hi) std::swap(certificate.separations.front(), certificate.separations.back());
    distance.lo = std::min(distance.lo, found.distance.lo);
    distance.hi = std::min(distance.hi, found.distance.hi);
  }
  proximity = distance.lo > 0.0 ? Proximity::separated : Proximity::undecided;
  return result;
}

/// The inflated model is for signed distances alone.
Bracketed<PosedPrimitives> posed_models(Bracket models) {
  require_union_of_convex(models.largest, "distances by certificates");
  models.inflated.reset();
  return bracketed(models, [](const Model& model) { return PosedPrimitives(model); });
}

}  // namespace

struct PairDistance::State {
  State(const Bracket& of_a, const Bracket& of_b) : bounds(of_a, of_b), a(posed_models(of_a)), b(posed_models(of_b)) {}

  MemberBounds bounds;
  Bracketed<PosedPrimitives> a;
  Bracketed<PosedPrimitives> b;
};

PairDistance::PairDistance(const UncertainModel& a, const UncertainModel& b)
    : state_(std::make_unique<State>(bracket(a), bracket(b))) {}

PairDistance::~PairDistance() = default;
PairDistance::PairDistance(PairDistance&&) noexcept = default;
PairDistance& PairDistance::operator=(PairDistance&&) noexcept = default;

ModelDistance PairDistance::operator()(const Pose& pose, const std::function<bool()>& interrupted) const {
  const MemberBounds& bounds = state_->bounds;
  const Bracketed<PosedPrimitives>& a = state_->a;
  const Bracketed<PosedPrimitives>& b = state_->b;
  const auto between_smallest = [&] { return exact_distance(PosedPairs(a.smallest, b.smallest, pose), interrupted); };
  if (bounds.exact()) return between_smallest();
  const ModelDistance largest = exact_distance(PosedPairs(a.of_largest(), b.of_largest(), pose), interrupted);
  const ModelDistance smallest = a.largest || b.largest ? between_smallest() : largest;
  const Enclosure distance = between(bounds.unsigned_lower(largest.distance.lo), bounds.upper(smallest.distance.hi),
                                     [] { return "the distance of the uncertain models"; });
  // Solids are closed: members at distance 0 have a common point.
  const Proximity proximity = distance.lo > 0.0    ? Proximity::separated
                              : distance.hi == 0.0 ? Proximity::overlapping
                                                   : Proximity::undecided;
  return {distance, proximity, {}, largest.complete && smallest.complete};
}

std::optional<ClosestPoints> PairDistance::closest_points(const ModelDistance& found, const Pose& pose,
                                                          const std::function<bool()>& interrupted) const {
  const auto& [bounds, a, b] = *state_;
  if (!bounds.exact() || found.proximity != Proximity::separated || !found.complete) return std::nullopt;
  return verify::closest_points(PosedPairs(a.smallest, b.smallest, pose), found, interrupted);
}

}  // namespace verisq
