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

namespace verisq::verify {

namespace {

/// Of a model.
using Primitives = std::span<const PosedSuperquadric>;

Proposal proposal(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// An upper end: `claimed` or less if it can be proven with v, else what can be.
double upper_end(const PosedSuperquadric& primitive, const Point& x, const Proposal& v, double claimed) {
  const double by_normal = claimed > 0.0 ? primitive.upper_by_normal(x, v) : infinity;
  if (by_normal <= claimed) return by_normal;
  if (!primitive.contains(x)) return primitive.upper_by_normal(x, v);
  return claimed < 0.0 && primitive.contains_ball_about(x, -claimed) ? claimed : 0.0;
}

/// Whether the exact signed distance is the least of the primitives': that of the union is where all are positive
/// (not where one is 0: a point on a face that two solids share lies inside), and a single primitive's always.
double lower_by_normals(Primitives primitives, const Point& x, std::span<const Normal> normals) {
  std::vector<double> lower;
  for (const PosedSuperquadric& primitive : primitives) lower.push_back(primitive.lower_by_sphere(x));
  for (const auto& [index, v] : normals) {
    lower[index] = std::max(lower[index], primitives[index].lower_by_normal(x, proposal(v)));
  }
  const double least = std::ranges::min(lower);
  return least > 0.0 || primitives.size() == 1 ? least : -infinity;
}

/// A point outside all primitives is no deeper inside than another outside of all is far.
double lower_by_escape(Primitives primitives, const Point& x, const Point& escape) {
  const auto excludes = [&](const PosedSuperquadric& primitive) { return primitive.excludes(escape); };
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

/// The distance to a union is the least of the distances to its primitives, 0 where one of them is met.
double lower(Primitives primitives, const Triangle& triangle, std::span<const Normal> normals) {
  std::vector<double> lower;
  for (const PosedSuperquadric& primitive : primitives) lower.push_back(lower_by_sphere(primitive, triangle));
  for (const auto& [index, v] : normals) {
    const PosedTriangle posed(triangle, primitives[index].motion());
    lower[index] = std::max(lower[index], lower_by_normal(primitives[index], posed, proposal(v)));
  }
  return std::max(0.0, std::ranges::min(lower));
}

/// By one point of the triangle; stops as soon as a normal proves `claimed` there.
double upper(Primitives primitives, const Triangle& triangle, double claimed, const std::optional<Weights>& weights,
             std::span<const Normal> normals) {
  double least = infinity;
  if (!weights || !in_triangle(*weights)) return least;
  for (const auto& [index, v] : normals) {
    const PreciseVector q = PosedTriangle(triangle, primitives[index].motion()).point(*weights);
    least = std::min(least, upper_by_point(primitives[index], q, proposal(v)));
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
  require_union_of_convex(model, "certificates");
  for (const Primitive& primitive : model.primitives) primitives_.emplace_back(primitive);
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
