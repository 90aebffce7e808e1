/// The public entry: certificates where they are as good as any proof, the search over cubes elsewhere.
#include "verisq/signed_distance.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "verify/proof/convex_union.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/search/union_of_convex.hpp"
#include "verify/sets/bent_union_certificate.hpp"
#include "verify/sets/set_closest_point.hpp"
#include "verify/sets/solid_distance.hpp"
#include "verify/sets/union_closest_point.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq {

namespace {

constexpr Enclosure nothing_known{-infinity, infinity};

/// Narrower enclosures are not searched for, in parts of the model's radius.
constexpr double search_limit = 1e-10;

/// Of a tolerance inside. What one primitive alone proves of the upper end may be loose: most is left to that.
constexpr double share_of_escape = 1.0 / 16;

bool never() {
  return false;
}

/// What certificates of convex primitives need.
struct ConvexUnion {
  explicit ConvexUnion(const Model& model)
      : checker(model), primitives(model.primitives.begin(), model.primitives.end()) {}

  /// Outside, and of a single primitive, certificates are tight; where primitives may overlap, their union is deeper
  /// than each of them, and the escape along a ray may be far from the shortest.
  [[nodiscard]] bool loose(const Enclosure& found, double tolerance) const {
    return primitives.size() > 1 && !(found.lo > 0.0) && !verified(found, tolerance);
  }

  verify::ExactChecker checker;
  std::vector<verify::ConvexPrimitive> primitives;
};

/// Precondition: is_union.
std::vector<verify::UnionPart> parts_of_bent_union(const Model& model) {
  std::vector<verify::UnionPart> parts;
  for (const Primitive& primitive : model.primitives) parts.push_back(verify::part_of(primitive));
  return parts;
}

}  // namespace

struct SignedDistance::State {
  explicit State(const Model& model)
      : search(model), resolution(search_limit * bounding_radius(model)), primitives(model.primitives.size()) {
    if (is_union_of_convex(model)) {
      convex.emplace(model);
    } else if (verify::is_union(model)) {
      bent_union = parts_of_bent_union(model);
      bent_checker.emplace(model);
    } else {
      operations.emplace(model);
    }
  }

  [[nodiscard]] Enclosure searched(const Point& point, double tolerance, const Enclosure& known,
                                   const std::function<bool()>& interrupted) const {
    return search(point, std::max(tolerance, resolution), known, interrupted);
  }

  /// `known`: contains the signed distance; only saves time.
  [[nodiscard]] std::optional<ClosestPoint> proven_closest_point(const Point& point, const Enclosure& known) const {
    if (convex) return verify::closest_point(convex->primitives, point);
    if (operations) return (*operations)(point, std::max(-known.lo, known.hi));
    return verify::closest_point(bent_union, point);
  }

  [[nodiscard]] ClosestPoint closest_point_within(const Enclosure& distance, const Point& point) const {
    ClosestPoint result = verisq::closest_point_within(distance, point);
    if (primitives == 1) result.primitive = 0;  // no other has a surface
    return result;
  }

  std::optional<ConvexUnion> convex;
  std::vector<verify::UnionPart> bent_union;  ///< nothing where there is no bend
  std::optional<verify::ExactChecker> bent_checker;
  std::optional<verify::SetClosestPoint> operations;  ///< where there are others than the union
  verify::SolidDistance search;
  double resolution;
  std::size_t primitives;
};

SignedDistance::SignedDistance(const Model& model) : state_(std::make_unique<State>(model)) {}

SignedDistance::~SignedDistance() = default;
SignedDistance::SignedDistance(SignedDistance&&) noexcept = default;
SignedDistance& SignedDistance::operator=(SignedDistance&&) noexcept = default;

Enclosure SignedDistance::operator()(const Point& point, double tolerance) const {
  return (*this)(point, tolerance, never);
}

Enclosure SignedDistance::operator()(const Point& point, double tolerance,
                                     const std::function<bool()>& interrupted) const {
  if (!state_->convex) return state_->searched(point, tolerance, nothing_known, interrupted);
  const Enclosure known = verify::signed_distance(state_->convex->primitives, point, tolerance).distance;
  if (!state_->convex->loose(known, std::max(tolerance, state_->resolution))) return known;
  return state_->searched(point, tolerance, known, interrupted);
}

ClosestPoint SignedDistance::closest_point(const Point& point, double tolerance,
                                           const std::function<bool()>& interrupted) const {
  if (const std::optional<ClosestPoint> found = state_->proven_closest_point(point, nothing_known)) return *found;
  const std::function<bool()> uninterrupted = never;
  return state_->closest_point_within((*this)(point, tolerance, interrupted ? interrupted : uninterrupted), point);
}

ClosestPoint SignedDistance::closest_point(const Point& point, const Enclosure& known) const {
  const std::optional<ClosestPoint> found = state_->proven_closest_point(point, known);
  return found ? *found : state_->closest_point_within(known, point);
}

CertifiedEnclosure SignedDistance::certified(const Point& point, double tolerance) const {
  return certified(point, tolerance, never);
}

CertifiedEnclosure SignedDistance::certified(const Point& point, double tolerance,
                                             const std::function<bool()>& interrupted) const {
  if (state_->bent_checker) {
    const double resolution = std::max(tolerance, state_->resolution);
    return verify::bent_union_certificate(state_->bent_union, *state_->bent_checker, point, [&] {
      return state_->search.escape(point, share_of_escape * resolution, interrupted);
    });
  }
  if (!state_->convex) throw Error(ErrorKind::input, "certificates: only for unions of primitives");
  const auto proven = [&](CertifiedEnclosure found) {
    found.distance = state_->convex->checker(point, found.distance, found.certificate);
    return found;
  };
  const CertifiedEnclosure found = proven(verify::signed_distance(state_->convex->primitives, point, tolerance));
  if (!state_->convex->loose(found.distance, std::max(tolerance, state_->resolution))) return found;
  CertifiedEnclosure nearer = found;
  nearer.certificate.escape =
      state_->search.escape(point, std::max(share_of_escape * tolerance, state_->resolution), interrupted);
  nearer = proven(nearer);
  return nearer.distance.lo > found.distance.lo ? nearer : found;
}

}  // namespace verisq
