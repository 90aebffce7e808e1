/// The checker's whole logic: what normals, spheres, escapes, contained balls and weights prove about one point or
/// triangle.
#include "verify/proof/exact_checker.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "verify/proof/convex_union.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/triangle_certificate.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

/// Of a model.
using Primitives = std::span<const PosedPrimitive>;

Proposal proposal(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

bool contains_ball_at(const PosedSuperquadric& primitive, const Point& x, double radius, const Proposal& /*anywhere*/) {
  return primitive.contains_ball_about(x, radius);
}

bool contains_ball_at(const PosedBent& primitive, const Point& x, double radius, const Proposal& v) {
  return primitive.contains_ball_about(x, radius, v);
}

/// An upper end: `claimed` or less if it can be proven with v, else what can be.
double upper_end(const PosedPrimitive& primitive, const Point& x, const Proposal& v, double claimed) {
  return std::visit(
      [&](const auto& solid) {
        const double by_normal = claimed > 0.0 ? solid.upper_by_normal(x, v) : infinity;
        if (by_normal <= claimed) return by_normal;
        if (!solid.contains(x)) return solid.upper_by_normal(x, v);
        return claimed < 0.0 && contains_ball_at(solid, x, -claimed, v) ? claimed : 0.0;
      },
      primitive);
}

/// Whether the exact signed distance is the least of the primitives': that of the union is where all are positive
/// (not where one is 0: a point on a face that two solids share lies inside), and a single primitive's always.
double lower_by_normals(Primitives primitives, const Point& x, std::span<const Normal> normals) {
  std::vector<double> lower;
  for (const PosedPrimitive& primitive : primitives) {
    lower.push_back(std::visit([&](const auto& solid) { return solid.lower_by_sphere(x); }, primitive));
  }
  for (const auto& [index, v] : normals) {
    const Proposal direction = proposal(v);
    const auto by_normal = [&](const auto& solid) { return solid.lower_by_normal(x, direction); };
    lower[index] = std::max(lower[index], std::visit(by_normal, primitives[index]));
  }
  const double least = std::ranges::min(lower);
  return least > 0.0 || primitives.size() == 1 ? least : -infinity;
}

/// A point outside all primitives is no deeper inside than another outside of all is far.
double lower_by_escape(Primitives primitives, const Point& x, const Point& escape) {
  const auto excludes = [&](const PosedPrimitive& primitive) {
    return std::visit([&](const auto& solid) { return solid.excludes(escape); }, primitive);
  };
  const bool proven = usable(proposal(escape)) && std::ranges::all_of(primitives, excludes);
  return proven ? -distance_up(x, escape) : -infinity;
}

double lower(Primitives primitives, const Point& x, const Certificate& certificate) {
  const double by_normals = lower_by_normals(primitives, x, certificate.normals);
  if (by_normals > 0.0 || !certificate.escape) return by_normals;
  return std::max(by_normals, lower_by_escape(primitives, x, *certificate.escape));
}

/// `claimed` or less as soon as a normal proves it, else the least that one proves.
double upper(Primitives primitives, const Point& x, double claimed, std::span<const Normal> normals) {
  double least = infinity;
  for (const auto& [index, v] : normals) {
    least = std::min(least, upper_end(primitives[index], x, proposal(v), claimed));
    if (least <= claimed) break;
  }
  return least;
}

/// Of a triangle: bent solids have no support function.
const PosedSuperquadric& convex(const PosedPrimitive& primitive) {
  if (const auto* const solid = std::get_if<PosedSuperquadric>(&primitive)) return *solid;
  throw Error(ErrorKind::input, "certificates of triangles: not supported for bent solids");
}

/// The distance to a union is the least of the distances to its primitives, 0 where one of them is met.
double lower(Primitives primitives, const Triangle& triangle, std::span<const Normal> normals) {
  std::vector<double> lower;
  for (const PosedPrimitive& primitive : primitives) lower.push_back(lower_by_sphere(convex(primitive), triangle));
  for (const auto& [index, v] : normals) {
    const PosedSuperquadric& solid = convex(primitives[index]);
    const PosedTriangle posed(triangle, solid.motion());
    lower[index] = std::max(lower[index], lower_by_normal(solid, posed, proposal(v)));
  }
  return std::max(0.0, std::ranges::min(lower));
}

/// By one point of the triangle; stops as soon as a normal proves `claimed` there.
double upper(Primitives primitives, const Triangle& triangle, double claimed, const std::optional<Weights>& weights,
             std::span<const Normal> normals) {
  double least = infinity;
  if (!weights || !in_triangle(*weights)) return least;
  for (const auto& [index, v] : normals) {
    const PosedSuperquadric& solid = convex(primitives[index]);
    const PreciseVector q = PosedTriangle(triangle, solid.motion()).point(*weights);
    least = std::min(least, upper_by_point(solid, q, proposal(v)));
    if (least <= claimed) break;
  }
  return least;
}

/// The normals of primitives that exist.
std::vector<Normal> known(Primitives primitives, std::vector<Normal> normals) {
  std::erase_if(normals, [&](const Normal& normal) { return normal.primitive >= primitives.size(); });
  return normals;
}

}  // namespace

ExactChecker::ExactChecker(const Model& model) {
  require_union(model, "certificates");
  for (const Primitive& primitive : model.primitives) {
    if (is_bent(primitive)) {
      primitives_.emplace_back(std::in_place_type<PosedBent>, primitive);
    } else {
      primitives_.emplace_back(std::in_place_type<PosedSuperquadric>, primitive);
    }
  }
}

Enclosure ExactChecker::operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate) const {
  Certificate used = certificate;
  used.normals = known(primitives_, certificate.normals);
  return between(lower(primitives_, point, used), upper(primitives_, point, claimed.hi, used.normals),
                 [&] { return "the signed distance at " + text_of(point); });
}

Enclosure ExactChecker::operator()(const Triangle& triangle, const Enclosure& claimed,
                                   const Certificate& certificate) const {
  const std::vector<Normal> normals = known(primitives_, certificate.normals);
  return between(lower(primitives_, triangle, normals),
                 upper(primitives_, triangle, claimed.hi, certificate.weights, normals),
                 [&] { return "the distance of the triangle from " + text_of(triangle[0]); });
}

}  // namespace verisq::verify
