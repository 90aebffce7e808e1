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
#include "verify/sets/solid_certificate.hpp"
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
  explicit ConvexUnion(const Model& model) : primitives(model.primitives.begin(), model.primitives.end()) {}

  /// Outside, and of a single primitive, certificates are tight; where primitives may overlap, their union is deeper
  /// than each of them, and the escape along a ray may be far from the shortest.
  [[nodiscard]] bool loose(const Enclosure& found, double tolerance) const {
    return primitives.size() > 1 && !(found.lo > 0.0) && !verified(found, tolerance);
  }

  std::vector<verify::ConvexPrimitive> primitives;
};

std::vector<verify::UnionPart> parts_of(const Model& model) {
  std::vector<verify::UnionPart> parts;
  for (const Primitive& primitive : model.primitives) parts.push_back(verify::part_of(primitive));
  return parts;
}

}  // namespace

struct SignedDistance::State {
  explicit State(const Model& model)
      : search(model),
        checker(model),
        parts(parts_of(model)),
        is_union(verify::is_union(model)),
        resolution(search_limit * bounding_radius(model)) {
    if (is_union_of_convex(model))
      convex.emplace(model);
    else if (!is_union)
      operations.emplace(model);
  }

  [[nodiscard]] Enclosure searched(const Point& point, double tolerance, const Enclosure& known,
                                   const std::function<bool()>& interrupted) const {
    return search(point, std::max(tolerance, resolution), known, interrupted);
  }

  /// `known`: contains the signed distance; only saves time.
  [[nodiscard]] std::optional<ClosestPoint> proven_closest_point(const Point& point, const Enclosure& known) const {
    if (convex) return verify::closest_point(convex->primitives, point);
    if (operations) return (*operations)(point, std::max(-known.lo, known.hi));
    return verify::closest_point(parts, point);
  }

  [[nodiscard]] ClosestPoint closest_point_within(const Enclosure& distance, const Point& point) const {
    ClosestPoint result = verisq::closest_point_within(distance, point);
    if (parts.size() == 1) result.primitive = 0;  // no other has a surface
    return result;
  }

  /// What single primitives prove of a union, without covers.
  [[nodiscard]] CertifiedEnclosure certified(const Point& point, double tolerance,
                                             const std::function<bool()>& interrupted) const {
    const double width = std::max(tolerance, resolution);
    if (!convex) {
      return verify::bent_union_certificate(parts, checker, point,
                                            [&] { return search.escape(point, share_of_escape * width, interrupted); });
    }
    const auto proven = [&](CertifiedEnclosure found) {
      found.distance = checker(point, found.distance, found.certificate);
      return found;
    };
    const CertifiedEnclosure found = proven(verify::signed_distance(convex->primitives, point, tolerance));
    if (!convex->loose(found.distance, width)) return found;
    CertifiedEnclosure nearer = found;
    nearer.certificate.escape = search.escape(point, std::max(share_of_escape * tolerance, resolution), interrupted);
    nearer = proven(nearer);
    return nearer.distance.lo > found.distance.lo ? nearer : found;
  }

  std::optional<ConvexUnion> convex;
  std::optional<verify::SetClosestPoint> operations;  ///< where there are others than the union
  verify::SolidDistance search;
  verify::ExactChecker checker;
  std::vector<verify::UnionPart> parts;
  bool is_union;
  double resolution;
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
                                             const std::function<bool()>& interrupted, bool covers) const {
  const State& state = *state_;
  if (!covers && !state.is_union) throw Error(ErrorKind::input, "certificates without covers: only for unions");
  const CertifiedEnclosure found =
      state.is_union ? state.certified(point, tolerance, interrupted) : CertifiedEnclosure{nothing_known, {}};
  if (!covers) return found;
  const double width = std::max(tolerance, state.resolution);
  return verify::covered({state.parts, state.search, state.checker}, point, found, width, interrupted);
}

}  // namespace verisq
