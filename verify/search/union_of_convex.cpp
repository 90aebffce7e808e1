/// This file implements union_of_convex.hpp.
#include "verify/search/union_of_convex.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "verify/proof/verdict.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// The direction as long as the distance (docs/mathematics.md §3: the closest point is x - v).
Proposal normal_vector(const PrimitiveDistance& found) {
  constexpr double shortest = 0x1p-900;  // its components stay normal numbers, unless they do not matter
  const Proposal& u = found.direction;
  const long double length = std::hypot(std::hypot(u[0], u[1]), u[2]);
  const long double scale = std::max(std::fabs(found.distance.hi), shortest) / length;
  return {scale * u[0], scale * u[1], scale * u[2]};
}

/// The normals that prove the ends of one primitive's enclosure: a single vector if it proves both. `resolution` is the
/// rounding error of the lengths involved.
std::vector<Normal> normals_of(std::uint32_t primitive, const PrimitiveDistance& found, double resolution) {
  const Proposal normal = normal_vector(found);
  const Proposal apart = difference(normal, found.witness);
  const bool same = std::sqrt(dot(apart, apart)) <= resolution;
  if (same || found.distance.hi <= 0.0 || !usable(found.witness)) return {{primitive, rounded(normal)}};
  return {{primitive, rounded(found.witness)}, {primitive, rounded(normal)}};
}

/// The distance from x along u beyond which a walk has left every primitive. Beyond its supporting plane of normal u a
/// primitive never meets the ray again. So each advance clears one primitive, and with it those whose planes lie
/// before: one evaluation of each, in the order of their planes, is enough. Infinite if the plane of a primitive is out
/// of reach.
double escape_length(std::span<const ConvexPrimitive> primitives, const Point& x, const Proposal& u) {
  std::vector<std::pair<double, const ConvexPrimitive*>> planes;  // the distances of the planes
  for (const ConvexPrimitive& primitive : primitives) planes.emplace_back(primitive.ray_clearance(x, u), &primitive);
  if (!std::ranges::all_of(planes, [](const auto& plane) { return std::isfinite(plane.first); })) return infinity;
  std::ranges::sort(planes);
  double reached = 0.0;
  for (const auto& [clearance, primitive] : planes) {
    // Strictly beyond the plane: primitives that touch must not hide the union's interior between them.
    if (reached <= clearance && !primitive->separated(x, u, reached)) reached = std::nextafter(clearance, infinity);
  }
  return reached;
}

/// A point outside every primitive and how far it lies from x, rounded up.
struct Escape {
  Point point;
  double distance;
};

/// The end of a walk along u, in binary64: the margin that makes up for its rounding grows until the proof succeeds.
std::optional<Escape> escape(std::span<const ConvexPrimitive> primitives, const Point& x, const Proposal& u) {
  if (!usable(u)) return std::nullopt;
  const double walk = escape_length(primitives, x, u);
  const long double length = std::hypot(std::hypot(u[0], u[1]), u[2]);
  const long double size = std::fabs(x[0]) + std::fabs(x[1]) + std::fabs(x[2]) + walk * length;
  if (!std::isfinite(walk)) return std::nullopt;
  for (long double margin = 0.0L; margin < size; margin = std::max(2.0L * margin, 0x1p-54L * size)) {
    const long double s = walk + margin / length;
    const Point w{static_cast<double>(x[0] + s * u[0]), static_cast<double>(x[1] + s * u[1]),
                  static_cast<double>(x[2] + s * u[2])};
    if (!std::ranges::all_of(w, [](double c) { return std::isfinite(c); })) return std::nullopt;
    if (std::ranges::all_of(primitives, [&](const ConvexPrimitive& primitive) { return primitive.excludes(w); })) {
      return Escape{w, distance_up(x, w)};
    }
  }
  return std::nullopt;
}

/// For readers of maps: "-0" would look like a sign.
Enclosure without_negative_zero(const Enclosure& e) {
  return {e.lo + 0.0, e.hi + 0.0};
}

}  // namespace

CertifiedEnclosure signed_distance(std::span<const ConvexPrimitive> primitives, const Point& x, double tolerance) {
  CertifiedEnclosure result{{infinity, infinity}, {}};
  auto& [distance, certificate] = result;
  // A certificate's normals are rounded: where that may hide on which side of a surface x lies, an escape is added.
  const double touching = 0x1p-50 * (std::fabs(x[0]) + std::fabs(x[1]) + std::fabs(x[2]));
  std::vector<Proposal> directions;  // of the primitives that may touch x
  const auto sphere_bound = [&](std::size_t i) { return primitives[i].proof().lower_by_sphere(x); };
  for (const auto& [bound, i] : nearest_spheres_first(primitives.size(), sphere_bound)) {
    const auto index = static_cast<std::uint32_t>(i);
    if (bound > distance.hi) break;  // neither this primitive nor a later one can be the nearest
    const PrimitiveDistance nearest = primitives[index].signed_distance(x, tolerance);
    const std::vector<Normal> normals = normals_of(index, nearest, touching);
    const bool decides = nearest.distance.hi < distance.hi;
    certificate.normals.insert(decides ? certificate.normals.begin() : certificate.normals.end(), normals.begin(),
                               normals.end());
    distance.lo = std::min(distance.lo, nearest.distance.lo);
    distance.hi = std::min(distance.hi, nearest.distance.hi);  // a ball inside one primitive lies inside the union
    // Also at zero: a point on two surfaces that share a face is inside the union.
    if (nearest.distance.lo <= touching) directions.push_back(primitives[index].model_direction(nearest.direction));
  }
  if (!directions.empty() && primitives.size() > 1) {
    double depth = infinity;
    for (const Proposal& u : directions) {
      const std::optional<Escape> found = escape(primitives, x, u);
      if (!found || found->distance >= depth) continue;
      depth = found->distance;
      certificate.escape = found->point;
    }
    if (!(distance.lo > 0.0)) distance.lo = -depth;
  }
  distance = between(distance.lo, distance.hi, [&] { return "the signed distance at " + text_of(x); });
  distance = without_negative_zero(distance);
  return result;
}

namespace {

double lower_by_sphere(const BentDistance& primitive, const Point& x) {
  return primitive.lower_by_sphere(x);
}

Enclosure rough_distance(const BentDistance& primitive, const Point& x) {
  return primitive(x).distance;
}

/// If nothing is proven, the point may be anywhere: x may lie inside.
ClosestSurfacePoint closest_surface_point(const BentDistance& primitive, const Point& x) {
  if (const std::optional<ClosestSurfacePoint> found = primitive.closest_point(x)) return *found;
  const PreciseInterval anything(Real(-infinity), Real(infinity));
  const PreciseVector anywhere{anything, anything, anything};
  return {anything, anywhere, anywhere, false};
}

bool excludes(const BentDistance& primitive, const PreciseVector& box) {
  return primitive.excludes(box);
}

}  // namespace

UnionPart part_of(const Primitive& primitive) {
  if (is_bent(primitive)) return UnionPart(std::in_place_type<BentDistance>, primitive);
  return UnionPart(std::in_place_type<ConvexPrimitive>, primitive);
}

double lower_by_sphere(const ConvexPrimitive& part, const Point& x) {
  return part.proof().lower_by_sphere(x);
}

Enclosure rough_distance(const ConvexPrimitive& part, const Point& x) {
  constexpr double roughness = 1e-3;
  const double radius = part.proof().radius().upper().to_double(Direction::up);
  return part.signed_distance(x, roughness * radius).distance;
}

ClosestSurfacePoint closest_surface_point(const ConvexPrimitive& part, const Point& x) {
  return closest_surface_point(part.proof(), x);
}

bool excludes(const ConvexPrimitive& part, const PreciseVector& box) {
  const RigidMotion& motion = part.proof().motion();
  return part.proof().bounds().gauge(motion.rotation.transpose() * (box - motion.translation)).lower() > Real(1);
}

double lower_by_sphere(const UnionPart& part, const Point& x) {
  return std::visit([&](const auto& primitive) { return lower_by_sphere(primitive, x); }, part);
}

Enclosure rough_distance(const UnionPart& part, const Point& x) {
  return std::visit([&](const auto& primitive) { return rough_distance(primitive, x); }, part);
}

ClosestSurfacePoint closest_surface_point(const UnionPart& part, const Point& x) {
  return std::visit([&](const auto& primitive) { return closest_surface_point(primitive, x); }, part);
}

bool excludes(const UnionPart& part, const PreciseVector& box) {
  return std::visit([&](const auto& primitive) { return excludes(primitive, box); }, part);
}

namespace {

/// A primitive that may be the nearest.
struct SurfaceCandidate {
  std::uint32_t primitive;
  ClosestSurfacePoint closest;
};

ClosestPoint answer_of(const SurfaceCandidate& candidate) {
  const auto& [distance, point, normal, unique] = candidate.closest;
  return {rounded_outward(distance), rounded_outward(point), rounded_outward(normal), candidate.primitive, unique};
}

/// The primitives that rough bounds do not prove to be farther than another one.
template <class Part>
std::vector<std::uint32_t> nearly_nearest(std::span<const Part> parts, const Point& x) {
  std::vector<std::pair<double, std::uint32_t>> lower_bounds;
  double upper = infinity;
  const auto sphere_bound = [&](std::size_t i) { return lower_by_sphere(parts[i], x); };
  for (const auto& [bound, i] : nearest_spheres_first(parts.size(), sphere_bound)) {
    if (bound > std::max(upper, 0.0)) break;
    const Enclosure distance = rough_distance(parts[i], x);
    lower_bounds.emplace_back(distance.lo, static_cast<std::uint32_t>(i));
    upper = std::min(upper, distance.hi);
  }
  std::vector<std::uint32_t> nearest;
  for (const auto& [lower, i] : lower_bounds) {
    if (!(lower > std::max(upper, 0.0))) nearest.push_back(i);
  }
  return nearest;
}

/// The primitives for which no other is proven to be nearer.
template <class Part>
std::vector<SurfaceCandidate> candidates_at(std::span<const Part> parts, const Point& x) {
  const std::vector<std::uint32_t> nearest =
      parts.size() == 1 ? std::vector<std::uint32_t>{0} : nearly_nearest(parts, x);
  std::vector<SurfaceCandidate> candidates;
  Real upper(infinity);
  for (const std::uint32_t i : nearest) {
    candidates.push_back({i, closest_surface_point(parts[i], x)});
    upper = std::min(upper, candidates.back().closest.distance.upper());
  }
  std::erase_if(candidates, [&](const SurfaceCandidate& candidate) {
    return candidate.closest.distance.lower() > std::max(upper, Real(0));
  });
  return candidates;
}

PreciseVector hull_of(const PreciseVector& a, const PreciseVector& b) {
  return {hull(a[0], b[0]), hull(a[1], b[1]), hull(a[2], b[2])};
}

/// Outside all: the boxes of all candidates. Precondition: at least one.
ClosestPoint nearest_of(std::span<const SurfaceCandidate> candidates) {
  if (candidates.size() == 1) return answer_of(candidates.front());
  ClosestSurfacePoint all = candidates.front().closest;
  Real upper = all.distance.upper();
  for (const SurfaceCandidate& candidate : candidates.subspan(1)) {
    all.distance = hull(all.distance, candidate.closest.distance);
    all.point = hull_of(all.point, candidate.closest.point);
    all.normal = hull_of(all.normal, candidate.closest.normal);
    upper = std::min(upper, candidate.closest.distance.upper());
  }
  return {rounded_outward(PreciseInterval(all.distance.lower(), upper)), rounded_outward(all.point),
          rounded_outward(all.normal), std::nullopt, false};
}

/// Returns whether this primitive's closest point is proven to be that of the union, for x in the primitive or on its
/// surface.
template <class Part>
bool decides(const SurfaceCandidate& candidate, std::span<const Part> parts) {
  if (!candidate.closest.unique) return false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i != candidate.primitive && !excludes(parts[i], candidate.closest.point)) return false;
  }
  return true;
}

template <class Part>
std::optional<ClosestPoint> closest_point_of(std::span<const Part> parts, const Point& x) {
  const std::vector<SurfaceCandidate> candidates = candidates_at(parts, x);
  const bool outside = std::ranges::all_of(
      candidates, [](const SurfaceCandidate& candidate) { return candidate.closest.distance.lower() > Real(0); });
  if (outside) return nearest_of(candidates);
  for (const SurfaceCandidate& candidate : candidates) {
    const bool inside = candidate.closest.distance.upper() <= Real(0);
    // If x is on the surface but for rounding, it may lie outside: then the others must be farther away.
    const bool alone = candidates.size() == 1;
    if ((inside || alone) && decides(candidate, parts)) return answer_of(candidate);
  }
  return std::nullopt;
}

}  // namespace

std::optional<ClosestPoint> closest_point(std::span<const ConvexPrimitive> primitives, const Point& x) {
  return closest_point_of(primitives, x);
}

std::optional<ClosestPoint> closest_point(std::span<const UnionPart> parts, const Point& x) {
  return closest_point_of(parts, x);
}

namespace {

double sphere_bound_of(const UnionPart& part, const Point& x) {
  return std::visit([&](const auto& solid) { return solid.proof().lower_by_sphere(x); }, part);
}

bool contains(const UnionPart& part, const Point& x) {
  return std::visit([&](const auto& solid) { return solid.proof().contains(x); }, part);
}

/// The ends and the normals of all parts that may be the nearest, that of the upper end first.
/// Interrupted, of some.
CertifiedEnclosure of_parts(std::span<const UnionPart> parts, const Point& x,
                            const std::function<bool()>& interrupted) {
  CertifiedEnclosure result{{infinity, infinity}, {}};
  auto& [distance, certificate] = result;
  const auto bound_of = [&](std::size_t i) { return sphere_bound_of(parts[i], x); };
  for (const auto& [bound, i] : nearest_spheres_first(parts.size(), bound_of)) {
    if (bound > distance.hi) break;  // neither this part nor a later one can be the nearest
    if (interrupted()) break;
    const CertifiedEnclosure found = certificate_of_part(parts[i], static_cast<std::uint32_t>(i), x);
    const auto& normals = found.certificate.normals;
    const bool decides = found.distance.hi < distance.hi;
    if (decides) {
      certificate.normals.insert(certificate.normals.begin(), normals.begin(), normals.end());
    } else {
      certificate.normals.push_back(normals.back());  // that of the lower end
    }
    distance = {std::min(distance.lo, found.distance.lo), std::min(distance.hi, found.distance.hi)};
  }
  return result;
}

/// A bent part's ball about x, as large as can be proven; nothing if none can. Its radius is a little below the
/// distance to an `escape`, by a margin that grows until the proof succeeds.
std::optional<CertifiedEnclosure> deeper(std::span<const UnionPart> parts, const ExactChecker& checker, const Point& x,
                                         const Certificate& certificate, const Point& escape,
                                         const std::function<bool()>& interrupted) {
  constexpr double first_margin = 0x1p-50;
  constexpr double last_margin = 0x1p-4;
  constexpr double growth = 64.0;
  const double distance = distance_up(x, escape);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto* const bent = std::get_if<BentDistance>(&parts[i]);
    if (bent == nullptr || !contains(parts[i], x)) continue;
    Certificate more = certificate;
    more.normals.insert(more.normals.begin(), {static_cast<std::uint32_t>(i), rounded(bent->way(escape, x))});
    for (double margin = first_margin; margin <= last_margin && !interrupted(); margin *= growth) {
      const Enclosure claimed{-infinity, -distance * (1.0 - margin)};
      if (checker(x, claimed, more, interrupted).hi <= claimed.hi) return CertifiedEnclosure{claimed, more};
    }
  }
  return std::nullopt;
}

}  // namespace

CertifiedEnclosure certificate_of_part(const UnionPart& part, std::uint32_t index, const Point& x) {
  if (const auto* const convex = std::get_if<ConvexPrimitive>(&part)) {
    constexpr double tightest = 0.0;  // one vector then proves both ends, as a rule
    CertifiedEnclosure found = signed_distance({convex, 1}, x, tightest);
    for (Normal& normal : found.certificate.normals) normal.primitive = index;
    return found;
  }
  const auto [distance, normal] = std::get<BentDistance>(part).foot(x);
  return {distance, {{{index, rounded(normal)}}, std::nullopt}};
}

CertifiedEnclosure bent_union_certificate(std::span<const UnionPart> parts, const ExactChecker& checker, const Point& x,
                                          const FindEscape& find_escape, const std::function<bool()>& interrupted) {
  CertifiedEnclosure found = of_parts(parts, x, interrupted);
  auto& [distance, certificate] = found;
  const bool inside = std::ranges::any_of(parts, [&](const UnionPart& part) { return contains(part, x); });
  if (inside) {
    certificate.escape = find_escape();
    if (certificate.escape) {
      const auto ball = deeper(parts, checker, x, certificate, *certificate.escape, interrupted);
      if (ball && ball->distance.hi < distance.hi) {
        distance.hi = ball->distance.hi;
        certificate = ball->certificate;
      }
    }
  } else if (!(distance.lo > 0.0)) {
    certificate.escape = x;  // proves that x does not lie inside
    if (std::isinf(checker(x, distance, certificate).lo)) certificate.escape = find_escape();
  }
  distance = checker(x, distance, certificate);
  distance = {distance.lo + 0.0, distance.hi + 0.0};  // for readers of maps "-0" would look like a sign
  return found;
}

}  // namespace verisq::verify
