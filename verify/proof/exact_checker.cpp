/// The checker's whole logic: the bounds that normals, spheres, escapes, witnesses, contained balls, covers and weights
/// prove for one point or triangle.
#include "verify/proof/exact_checker.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "verify/proof/verdict.hpp"
#include "verify/solids/model.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// The primitives of a model.
using Primitives = std::span<const PosedPrimitive>;

Proposal proposal(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// An upper end: `claimed` or less if it can be proven with v, else an upper end that can be proven.
double upper_end(const PosedPrimitive& primitive, const Point& x, const Proposal& v, double claimed,
                 const Hook& interrupted) {
  return std::visit(
      [&](const auto& solid) {
        const double by_normal = claimed > 0.0 ? solid.upper_by_normal(x, v) : infinity;
        if (by_normal <= claimed) return by_normal;
        if (!solid.contains(x)) return solid.upper_by_normal(x, v);
        return claimed < 0.0 && solid.contains_ball_about(x, -claimed, v, interrupted) ? claimed : 0.0;
      },
      primitive);
}

/// The least of the distances to the primitives, by spheres and normals.
template <class Query>
double least(Primitives primitives, const Query& query, std::span<const Normal> normals, const Hook& interrupted) {
  std::vector<double> lower;
  for (const PosedPrimitive& p : primitives)
    lower.push_back(std::visit([&](const auto& solid) { return lower_by_sphere(solid, query); }, p));
  for (const auto& [index, v] : normals) {
    if (interrupted && interrupted()) break;
    lower[index] = std::max(lower[index], lower_by_normal(primitives[index], query, proposal(v)));
  }
  return std::ranges::min(lower);
}

/// The lower end by normals, if the exact signed distance is the least of the primitives' signed distances; else
/// -infinity. For a union it is the least if all are positive (not if one is 0: a point on a face that two solids share
/// lies inside). For a single primitive it always is.
double lower_by_normals(Primitives primitives, const Point& x, std::span<const Normal> normals, const Hook& ended) {
  const double of_primitives = least(primitives, x, normals, ended);
  return of_primitives > 0.0 || primitives.size() == 1 ? of_primitives : -infinity;
}

/// `claimed` or less as soon as a normal proves it, else the least upper end that a normal proves. Inside, a normal may
/// cost the proof of a ball, some seconds if it fails. So only the first few normals of a row are tried, and only one
/// of a convex primitive, whose ball no normal changes.
double upper(Primitives primitives, const Point& x, double claimed, std::span<const Normal> normals,
             const Hook& interrupted) {
  constexpr std::size_t most_balls = 4;
  std::vector<std::uint32_t> tried;
  double least = infinity;
  for (const auto& [index, v] : normals) {
    if (claimed < 0.0) {
      const bool again = std::holds_alternative<PosedSuperquadric>(primitives[index]) &&
                         std::ranges::find(tried, index) != tried.end();
      if (again) continue;
      if (tried.size() == most_balls) break;
      tried.push_back(index);
    }
    least = std::min(least, upper_end(primitives[index], x, proposal(v), claimed, interrupted));
    if (least <= claimed || (interrupted && interrupted())) break;
  }
  return least;
}

/// The upper end by one point of the triangle; stops as soon as a normal proves `claimed` there.
double upper(Primitives primitives, const Triangle& triangle, double claimed, const Weights& weights,
             std::span<const Normal> normals) {
  double least = infinity;
  for (const auto& [index, v] : normals) {
    const auto* const solid = std::get_if<PosedSuperquadric>(&primitives[index]);
    if (solid == nullptr) continue;
    const PreciseVector q = PosedTriangle(triangle, solid->motion()).point(weights);
    least = std::min(least, upper_by_point(*solid, q, proposal(v)));
    if (least <= claimed) break;
  }
  return least;
}

/// The usable parts of the certificate: normals of primitives that exist, finite points.
Certificate known(Primitives primitives, Certificate certificate) {
  std::erase_if(certificate.normals, [&](const Normal& normal) { return normal.primitive >= primitives.size(); });
  for (std::optional<Point>* const point : {&certificate.escape, &certificate.witness}) {
    if (*point && !std::ranges::all_of(**point, [](double c) { return std::isfinite(c); })) point->reset();
  }
  return certificate;
}

}  // namespace

SetExpression set_of(const Model& model) {
  if (model.csg) return *model.csg;
  SetExpression all;
  for (std::uint32_t i = 0; i < model.primitives.size(); ++i)
    all.operands.push_back({.operands = {}, .operation = SetOperation::unite, .primitive = i});
  return all;
}

PosedPrimitive posed(const Primitive& primitive) {
  if (is_bent(primitive)) return PosedBent(primitive);
  return PosedSuperquadric(primitive);
}

ExactChecker::ExactChecker(const Model& model) {
  require_valid(model);
  set_ = set_of(model);
  is_union_ = is_union(model);
  for (const Primitive& primitive : model.primitives) primitives_.push_back(posed(primitive));
}

/// True where the neighbourhood is proven to hold nothing of the solid, or of the closure of its complement.
template <class Query>
bool ExactChecker::is_covered(const Query& query, double radius, Place wanted, const Certificate& certificate,
                              const Hook& interrupted) const {
  if (!(radius > 0.0) || !std::isfinite(radius) || certificate.cover.empty()) return false;
  const std::optional<Point>& near = wanted == Place::outside ? certificate.witness : certificate.escape;
  return EmptyNeighbourhood(set_, primitives_, query, radius, wanted, certificate.normals, near, interrupted)
      .is_covered_by(certificate.cover, interrupted);
}

/// The distance of x from a point that is proven to have the place.
double ExactChecker::distance_of(const PreciseVector& x, const std::optional<Point>& p, Place place) const {
  if (!p || place_of(precise(*p), set_, primitives_) != place) return infinity;
  return length<Real>(PreciseVector(x - precise(*p))).upper().to_double(Direction::up);
}

/// A point outside cannot be deeper inside than its distance from another point outside.
double ExactChecker::proven_lower(const Point& x, double claimed, const Certificate& certificate,
                                  const Hook& interrupted) const {
  const double by_normals = is_union_ ? lower_by_normals(primitives_, x, certificate.normals, interrupted) : -infinity;
  if (by_normals > 0.0 && (by_normals >= claimed || certificate.cover.empty())) return by_normals;
  if (is_covered(x, claimed, Place::outside, certificate, interrupted)) return claimed;
  return std::max(by_normals, -distance_of(precise(x), certificate.escape, Place::outside));
}

double ExactChecker::proven_upper(const Point& x, double claimed, const Certificate& certificate,
                                  const Hook& interrupted) const {
  const double by_normals = is_union_ ? upper(primitives_, x, claimed, certificate.normals, interrupted) : infinity;
  if (by_normals <= claimed) return by_normals;
  if (is_covered(x, -claimed, Place::inside, certificate, interrupted)) return claimed;
  return std::min(by_normals, distance_of(precise(x), certificate.witness, Place::inside));
}

Enclosure ExactChecker::operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                                   const Hook& interrupted) const {
  const Certificate used = known(primitives_, certificate);
  return between(proven_lower(point, claimed.lo, used, interrupted), proven_upper(point, claimed.hi, used, interrupted),
                 [&] { return "the signed distance at " + text_of(point); });
}

double ExactChecker::proven_lower(const Triangle& triangle, double claimed, const Certificate& certificate,
                                  const Hook& interrupted) const {
  const double of_normals = is_union_ ? least(primitives_, triangle, certificate.normals, interrupted) : 0.0;
  const double by_normals = std::max(0.0, of_normals);
  if (by_normals >= claimed) return by_normals;
  return is_covered(triangle, claimed, Place::outside, certificate, interrupted) ? claimed : by_normals;
}

double ExactChecker::proven_upper(const Triangle& triangle, double claimed, const Certificate& certificate) const {
  if (!certificate.weights || !in_triangle(*certificate.weights)) return infinity;
  const auto& weights = *certificate.weights;
  const double by_normals = is_union_ ? upper(primitives_, triangle, claimed, weights, certificate.normals) : infinity;
  if (by_normals <= claimed || !certificate.witness) return by_normals;
  const PreciseVector x = point_of({precise(triangle[0]), precise(triangle[1]), precise(triangle[2])}, weights);
  if (place_of(x, set_, primitives_) == Place::inside) return 0.0;
  return std::min(by_normals, distance_of(x, certificate.witness, Place::inside));
}

Enclosure ExactChecker::operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                                   const Hook& interrupted) const {
  const Certificate used = known(primitives_, certificate);
  return between(proven_lower(triangle, claimed.lo, used, interrupted), proven_upper(triangle, claimed.hi, used),
                 [&] { return "the distance of the triangle from " + text_of(triangle[0]); });
}

}  // namespace verisq::verify
