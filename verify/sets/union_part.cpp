/// This file implements what is asked of either kind of primitive.
#include "verify/sets/union_part.hpp"

#include <optional>
#include <utility>

namespace verisq::verify {
namespace {

double lower_by_sphere(const BentDistance& primitive, const Point& x) {
  return primitive.lower_by_sphere(x);
}

Enclosure rough_distance(const BentDistance& primitive, const Point& x) {
  return primitive(x).distance;
}

/// Where nothing is proven, anywhere: x may lie inside.
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

}  // namespace verisq::verify
