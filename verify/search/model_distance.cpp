/// This file implements model_distance.hpp.
#include "verify/search/model_distance.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "verify/numbers/points.hpp"
#include "verify/proof/pair_checker.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

struct Sphere {
  Point centre;
  double radius;
  double size;   ///< magnitude of the numbers involved
  double width;  ///< width of the enclosure of the centre: more than rounding if large numbers cancel in it
};

Sphere sphere_of(const PreciseVector& centre, const PreciseInterval& radius) {
  Sphere sphere{{}, radius.upper().to_double(Direction::up), 0.0, 0.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval& c = centre[i];
    sphere.centre[i] = c.upper().to_double(Direction::up);
    sphere.size += std::fabs(sphere.centre[i]);
    sphere.width += (PreciseInterval(c.upper()) - PreciseInterval(c.lower())).upper().to_double(Direction::up);
  }
  sphere.size += sphere.radius;
  return sphere;
}

double between_centres(const Sphere& a, const Sphere& b) {
  return length(a.centre[0] - b.centre[0], a.centre[1] - b.centre[1], a.centre[2] - b.centre[2]);
}

/// The rounding error of lengths computed from two spheres. With u = 2^-53 and s the sum of both sizes: beyond the
/// widths of the enclosures, centres and radii are rounded by 2 u s in all, differences by u s. The length of three of
/// them is rounded by 8 u s (points.hpp), the sum with the radii by 2 u s, and this sum by less than the amount that it
/// adds: less than 2^5 u s. Subnormal numbers round by less than the last term.
double rounding_error(const Sphere& a, const Sphere& b) {
  return 0x1p-46 * (a.size + b.size) + 2.0 * (a.width + b.width) + 0x1p-1000;
}

/// The pairs whose bounding spheres are not farther apart than the nearest centres, which lie in their primitives.
NearPairs near_pairs(const PosedPairs& pairs) {
  std::vector<Sphere> of_a;
  std::vector<Sphere> of_b;
  for (std::size_t i = 0; i < pairs.size_a(); ++i)
    of_a.push_back(sphere_of(pairs.motion_a(i).translation, pairs.radius_a(i)));
  for (std::size_t j = 0; j < pairs.size_b(); ++j)
    of_b.push_back(sphere_of(pairs.motion_b(j).translation, pairs.radius_b(j)));
  double nearest_centres = infinity;
  for (const Sphere& a : of_a) {
    for (const Sphere& b : of_b)
      nearest_centres = std::min(nearest_centres, between_centres(a, b) + rounding_error(a, b));
  }
  NearPairs result{{}, infinity};
  for (std::uint32_t i = 0; i < of_a.size(); ++i) {
    for (std::uint32_t j = 0; j < of_b.size(); ++j) {
      const Sphere& a = of_a[i];
      const Sphere& b = of_b[j];
      const double lower = between_centres(a, b) - a.radius - b.radius - rounding_error(a, b);
      // Also taken if overflow leaves no number.
      if (!(lower > nearest_centres)) {
        result.pairs.push_back({i, j});
      } else {
        result.others = std::min(result.others, lower);
      }
    }
  }
  return result;
}

double width_up(const PreciseInterval& x) {
  return (PreciseInterval(x.upper()) - PreciseInterval(x.lower())).upper().to_double(Direction::up);
}

}  // namespace

Placement placement_of(const PosedPairs& pairs, std::size_t j) {
  const RigidMotion& motion = pairs.motion_b(j);
  Placement placement{{}, {}, pairs.radius_b(j).upper().to_double(Direction::up), 0.0, 0.0};
  placement.size = placement.radius;
  for (std::size_t i = 0; i < 3; ++i) {
    placement.centre[i] = motion.translation[i].upper().to_double(Direction::up);
    placement.size += std::fabs(placement.centre[i]);
    placement.width += width_up(motion.translation[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      const PreciseInterval& entry = motion.rotation(static_cast<int>(i), static_cast<int>(k));
      placement.rotation[3 * i + k] = entry.upper().to_double(Direction::up);
      placement.width += placement.radius * width_up(entry);
    }
  }
  return placement;
}

// A point of the primitive is c + R x, |x| <= r, and moves by at most |c' - c| + |R' - R| r. The largest singular value
// of R' - R is at most the root of the sum of its squared entries. With u = 2^-53, s = |c|_1 + r of either placement
// and S the sum of both: beyond the widths, coordinates and entries are rounded to binary64 by 2 u of themselves;
// entries are at most 1. So c' - c is off by 3 u S and each of the nine entries of R' - R by 6 u, their root by 18 u.
// length (points.hpp) adds 8 u S, and at most twice as much for the entries, whose three lengths have a length in turn:
// 32 u in all. Times r these are less than 2^6 u S. The factor of the widths covers their own rounding. Subnormal
// numbers round by less than the last term.
double displacement_up(const Placement& from, const Placement& to) {
  const Point& c = from.centre;
  const Point& d = to.centre;
  const auto row = [&](std::size_t i) {
    const auto apart = [&](std::size_t k) { return to.rotation[3 * i + k] - from.rotation[3 * i + k]; };
    return length(apart(0), apart(1), apart(2));
  };
  const double turned = length(row(0), row(1), row(2)) * std::max(from.radius, to.radius);
  const double error = 0x1p-45 * (from.size + to.size) + 2.0 * (from.width + to.width) + 0x1p-1000;
  return length(d[0] - c[0], d[1] - c[1], d[2] - c[2]) + turned + error;
}

void PairMemory::look_at(const PosedPairs& pairs) {
  if (now_.size() != pairs.size_b() || known_.size() != pairs.size_a() * pairs.size_b()) {
    now_.resize(pairs.size_b());
    known_.assign(pairs.size_a() * pairs.size_b(), {});
    nearest_.reset();
  }
  for (std::size_t j = 0; j < pairs.size_b(); ++j) now_[j] = placement_of(pairs, j);
}

double PairMemory::lower(PrimitivePair pair) const {
  const Known& known = known_[place(pair)];
  if (!(known.lower > 0.0)) return 0.0;
  // Rounded down; NaN, if numbers overflow, proves nothing.
  const double left = std::nextafter(known.lower - displacement_up(known.at, now_[pair.b]), -infinity);
  return left > 0.0 ? left : 0.0;
}

void PairMemory::keep(PrimitivePair pair, double lower) {
  known_[place(pair)] = {lower, now_[pair.b]};
}

}  // namespace verisq::verify

namespace verisq {

using namespace verify;

namespace {

/// If the fast proposal leaves more than this, relative to the largest length involved, a thorough one is worth it.
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

  /// The better ends of the fast and the thorough result.
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

  /// The reference length of widths: no rounding is finer than that of the largest length.
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
      // If rounding prevents its proof, the nearest points of both solids are next to it.
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

/// A pair that may be the nearest, and the result found for it.
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

/// Solids are closed: models at distance 0 have a common point.
Proximity proximity_of(const Enclosure& distance) {
  if (distance.lo > 0.0) return Proximity::separated;
  return distance.hi == 0.0 ? Proximity::overlapping : Proximity::undecided;
}

/// Rounds to multiples of a power of two: if solids touch at a point of few digits, rounding has hidden it.
Point snapped(const Point& x, double unit) {
  return {std::round(x[0] / unit) * unit, std::round(x[1] / unit) * unit, std::round(x[2] / unit) * unit};
}

/// A point of two solids that all but touch, if it is next to where they are closest.
std::optional<Point> touching_point(const PosedPairs& pairs, std::span<const LookedAt> all) {
  constexpr double nearly = 1e-9;  // of the size
  for (const auto& [query, found, bound] : all) {
    const double size = query.magnitude(found);
    if (found.distance.lo > 0.0 || !(found.distance.hi <= nearly * size)) continue;
    const Point x = rounded(midpoint(pairs.motion_a(found.separation.primitive_a)(precise(found.separation.on_a))));
    if (pairs.share(x)) return x;
    const Point plain = snapped(x, std::ldexp(1.0, std::ilogb(size) - 36));
    if (pairs.share(plain)) return plain;
  }
  return std::nullopt;
}

/// As defined by PairDistance, for exact models. The choice of the skipped pairs affects only the time: none of them is
/// nearer than the result.
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
  if (const auto common = distance.lo > 0.0 ? std::nullopt : touching_point(pairs, all)) {
    return {{0.0, 0.0}, Proximity::overlapping, {.common = common}, true};
  }
  proximity = proximity_of(distance);
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
    : state_(hidden<State>(bracket(a), bracket(b))) {}

PairDistance::Memory::Memory() : pairs_(hidden<PairMemory>()) {}

ModelDistance PairDistance::operator()(const Pose& pose, const std::function<bool()>& interrupted) const {
  require_valid(pose, "pose");
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
  return {distance, proximity_of(distance), {}, largest.complete && smallest.complete};
}

ModelDistance PairDistance::operator()(const Pose& pose, Memory& memory,
                                       const std::function<bool()>& interrupted) const {
  require_valid(pose, "pose");
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

struct CertifiedDistances::State {
  State(const Model& a, const Model& b, double width) : tolerance(width) {
    if (is_union_of_convex(a) && is_union_of_convex(b)) {
      convex.emplace(a, b);
    } else {
      search.emplace(a, b);
    }
  }

  [[nodiscard]] CertifiedDistance distance(const Pose& pose, const std::function<bool()>& interrupted) const {
    if (convex) {
      ModelDistance found = (*convex)(pose, interrupted);
      return {found.distance, std::move(found.certificate)};
    }
    const SearchOptions options{.tolerance = tolerance, .interrupted = interrupted};
    return search->certified(pose, (*search)(pose, options), options);
  }

  double tolerance;
  std::optional<PairDistance> convex;
  std::optional<ModelSearch> search;
};

CertifiedDistances::CertifiedDistances(const Model& a, const Model& b, double tolerance)
    : state_(hidden<State>(a, b, tolerance)) {}

CertifiedDistance CertifiedDistances::operator()(const Pose& pose, const std::function<bool()>& interrupted) const {
  return state_->distance(pose, interrupted);
}

}  // namespace verisq
