/// The checker's whole logic: what normals, spheres, escapes, contained balls and weights prove about one point or
/// triangle.
#include "verify/proof/exact_checker.hpp"

#include <algorithm>
#include <limits>

#include "verify/proof/convex_union.hpp"
#include "verify/proof/intersection.hpp"

namespace verisq::verify {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Proposal proposal(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// An upper end: `claimed` or less if it can be proven with v, else what can be.
double upper_end(const PosedSuperquadric& primitive, const Point& x, const Proposal& v, double claimed) {
  const double by_normal = claimed > 0.0 ? primitive.upper_by_normal(x, v) : kInfinity;
  if (by_normal <= claimed) return by_normal;
  if (!primitive.contains(x)) return primitive.upper_by_normal(x, v);
  return claimed < 0.0 && primitive.contains_ball_about(x, -claimed) ? claimed : 0.0;
}

}  // namespace

ExactChecker::ExactChecker(const Model& model) {
  require_union_of_convex(model, "certificates");
  for (const Primitive& primitive : model.primitives) primitives_.emplace_back(primitive);
}

/// Whether the exact signed distance is the least of the primitives': that of the union is where all are positive
/// (not where one is 0: a point on a face that two solids share lies inside), and a single primitive's always.
double ExactChecker::lower_by_normals(const Point& x, std::span<const Normal> normals) const {
  std::vector<double> lower;
  for (const PosedSuperquadric& primitive : primitives_) lower.push_back(primitive.lower_by_sphere(x));
  for (const auto& [index, v] : normals) {
    lower[index] = std::max(lower[index], primitives_[index].lower_by_normal(x, proposal(v)));
  }
  const double least = std::ranges::min(lower);
  return least > 0.0 || primitives_.size() == 1 ? least : -kInfinity;
}

/// A point outside all primitives is no deeper inside than another outside of all is far.
double ExactChecker::lower_by_escape(const Point& x, const Point& escape) const {
  const auto excludes = [&](const PosedSuperquadric& primitive) { return primitive.excludes(escape); };
  const bool proven = usable(proposal(escape)) && std::ranges::all_of(primitives_, excludes);
  return proven ? -distance_up(x, escape) : -kInfinity;
}

double ExactChecker::lower(const Point& x, const Certificate& certificate) const {
  const double by_normals = lower_by_normals(x, certificate.normals);
  if (by_normals > 0.0 || !certificate.escape) return by_normals;
  return std::max(by_normals, lower_by_escape(x, *certificate.escape));
}

/// `claimed` or less as soon as a normal proves it, else the least that one proves.
double ExactChecker::upper(const Point& x, double claimed, std::span<const Normal> normals) const {
  double least = kInfinity;
  for (const auto& [index, v] : normals) {
    least = std::min(least, upper_end(primitives_[index], x, proposal(v), claimed));
    if (least <= claimed) break;
  }
  return least;
}

/// The distance to a union is the least of the distances to its primitives, 0 where one of them is met.
double ExactChecker::lower(const Triangle& triangle, std::span<const Normal> normals) const {
  std::vector<double> lower;
  for (const PosedSuperquadric& primitive : primitives_) lower.push_back(lower_by_sphere(primitive, triangle));
  for (const auto& [index, v] : normals) {
    const PosedTriangle posed(triangle, primitives_[index].frame());
    lower[index] = std::max(lower[index], lower_by_normal(primitives_[index], posed, proposal(v)));
  }
  return std::max(0.0, std::ranges::min(lower));
}

/// By one point of the triangle; stops as soon as a normal proves `claimed` there.
double ExactChecker::upper(const Triangle& triangle, double claimed, const std::optional<Weights>& weights,
                           std::span<const Normal> normals) const {
  double least = kInfinity;
  if (!weights || !in_triangle(*weights)) return least;
  for (const auto& [index, v] : normals) {
    const PreciseVector q = PosedTriangle(triangle, primitives_[index].frame()).point(*weights);
    least = std::min(least, upper_by_point(primitives_[index], q, proposal(v)));
    if (least <= claimed) break;
  }
  return least;
}

/// The normals of primitives that exist.
std::vector<Normal> ExactChecker::known(std::vector<Normal> normals) const {
  std::erase_if(normals, [&](const Normal& normal) { return normal.primitive >= primitives_.size(); });
  return normals;
}

Enclosure ExactChecker::operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate) const {
  Certificate used = certificate;
  used.normals = known(certificate.normals);
  return between(lower(point, used), upper(point, claimed.hi, used.normals),
                 [&] { return "the signed distance at " + text_of(point); });
}

Enclosure ExactChecker::operator()(const Triangle& triangle, const Enclosure& claimed,
                                   const Certificate& certificate) const {
  const std::vector<Normal> normals = known(certificate.normals);
  return between(lower(triangle, normals), upper(triangle, claimed.hi, certificate.weights, normals),
                 [&] { return "the distance of the triangle from " + text_of(triangle[0]); });
}

}  // namespace verisq::verify
