/// The public entry: pairs nearest by their spheres first, each proposed and proven; uncertain models by the models
/// that bracket them.
#include "verisq/model_distance.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "verify/pairs/posed_pairs.hpp"
#include "verify/proof/bracketed.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/uncertain_distance.hpp"
#include "verify/search/candidates.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/closest_points.hpp"
#include "verify/search/near_pairs.hpp"
#include "verify/search/pair_contact.hpp"
#include "verify/search/pair_memory.hpp"
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

/// A pair that may be the nearest, and what is found of it.
struct LookedAt {
  PairQuery query;
  PairResult found;
  double sphere_bound;
};

std::string name_of(PrimitivePair pair) {
  return "the distance of primitives " + std::to_string(pair.a) + " and " + std::to_string(pair.b);
}

/// The pairs in `order`, but the one that decided the last distance first.
std::vector<Candidate> last_nearest_first(std::vector<Candidate> order, const NearPairs& near,
                                          const std::optional<PrimitivePair>& nearest) {
  if (!nearest) return order;
  const auto is_nearest = [&](const Candidate& candidate) {
    const PrimitivePair& pair = near.pairs[candidate.index];
    return pair.a == nearest->a && pair.b == nearest->b;
  };
  const auto at = std::ranges::find_if(order, is_nearest);
  if (at != order.end()) std::rotate(order.begin(), at, at + 1);
  return order;
}

/// As PairDistance says, of exact models. Which pairs are passed over changes nothing but the time: none of them is
/// nearer than what is found.
ModelDistance exact_distance(const PosedPairs& pairs, PairMemory& memory, const std::function<bool()>& interrupted) {
  memory.look_at(pairs);
  const NearPairs near = near_pairs(pairs);
  ModelDistance result{{near.others, infinity}, Proximity::undecided, {}};
  auto& [distance, proximity, certificate, complete] = result;
  const auto sphere_bound = [&](std::size_t k) { return pairs.lower_by_spheres(near.pairs[k].a, near.pairs[k].b); };
  std::vector<LookedAt> all;
  for (const auto& [bound, k] :
       last_nearest_first(nearest_spheres_first(near.pairs.size(), sphere_bound), near, memory.nearest())) {
    const PrimitivePair pair = near.pairs[k];
    if (bound > distance.hi || memory.lower(pair) > distance.hi) continue;  // this pair cannot be the nearest
    complete = complete && !(interrupted && !all.empty() && interrupted());
    if (!complete) {
      distance.lo = std::min(distance.lo, std::max(0.0, bound));
      continue;
    }
    const PairQuery query(pairs, pair.a, pair.b);
    const PairResult found = query.fast();
    if (found.common && pairs.share(*found.common)) {
      return {intersection({0.0, 0.0}, {bound, infinity}, [pair] { return name_of(pair); }),
              Proximity::overlapping,
              {.common = found.common},
              true};
    }
    distance.hi = std::min(distance.hi, found.distance.hi);
    all.push_back({query, found, bound});
  }
  for (auto& [query, found, bound] : all) {
    const bool may_be_nearest = !(found.distance.lo > distance.hi);
    const bool tight = found.distance.width() <= kExpectedWidth * query.magnitude(found);
    if (may_be_nearest && !tight && complete) found = query.thorough(found);
    const PrimitivePair pair{found.separation.primitive_a, found.separation.primitive_b};
    found.distance =
        between(std::max({0.0, bound, found.distance.lo}), found.distance.hi, [pair] { return name_of(pair); });
    memory.keep(pair, found.distance.lo);
    certificate.separations.push_back(found.separation);
    if (found.distance.hi <= distance.hi) {
      std::swap(certificate.separations.front(), certificate.separations.back());
      memory.keep_nearest(pair);
    }
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

PairDistance::Memory::Memory() : pairs_(std::make_unique<PairMemory>()) {}
PairDistance::Memory::~Memory() = default;
PairDistance::Memory::Memory(Memory&&) noexcept = default;
PairDistance::Memory& PairDistance::Memory::operator=(Memory&&) noexcept = default;

ModelDistance PairDistance::operator()(const Pose& pose, const std::function<bool()>& interrupted) const {
  const MemberBounds& bounds = state_->bounds;
  const Bracketed<PosedPrimitives>& a = state_->a;
  const Bracketed<PosedPrimitives>& b = state_->b;
  const auto exactly = [&](const PosedPrimitives& one, const PosedPrimitives& other) {
    PairMemory nothing;
    return exact_distance(PosedPairs(one, other, pose), nothing, interrupted);
  };
  const auto between_smallest = [&] { return exactly(a.smallest, b.smallest); };
  if (bounds.exact()) return between_smallest();
  const ModelDistance largest = exactly(a.of_largest(), b.of_largest());
  const ModelDistance smallest = a.largest || b.largest ? between_smallest() : largest;
  const Enclosure distance = between(bounds.unsigned_lower(largest.distance.lo), bounds.upper(smallest.distance.hi),
                                     [] { return "the distance of the uncertain models"; });
  // Solids are closed: members at distance 0 have a common point.
  const Proximity proximity = distance.lo > 0.0    ? Proximity::separated
                              : distance.hi == 0.0 ? Proximity::overlapping
                                                   : Proximity::undecided;
  return {distance, proximity, {}, largest.complete && smallest.complete};
}

ModelDistance PairDistance::operator()(const Pose& pose, Memory& memory,
                                       const std::function<bool()>& interrupted) const {
  if (!state_->bounds.exact()) return (*this)(pose, interrupted);
  const PosedPairs pairs(state_->a.smallest, state_->b.smallest, pose);
  ModelDistance found = exact_distance(pairs, *memory.pairs_, interrupted);
  found.certificate = {};
  return found;
}

std::optional<ClosestPoints> PairDistance::closest_points(const ModelDistance& found, const Pose& pose,
                                                          const std::function<bool()>& interrupted) const {
  const auto& [bounds, a, b] = *state_;
  if (!bounds.exact() || found.proximity != Proximity::separated || !found.complete) return std::nullopt;
  return verify::closest_points(PosedPairs(a.smallest, b.smallest, pose), found, interrupted);
}

}  // namespace verisq
