/// A witness of the nearest point, the triangle's point nearest to that, and a cover of what is nearer.
#include "verify/sets/covered_triangle.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proof/triangle_certificate.hpp"
#include "verify/proposals/triangle.hpp"
#include "verify/sets/cover_search.hpp"
#include "verify/sets/nearest_witness.hpp"
#include "verify/sets/triangle_pieces.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// Of the tolerance, what the search for the witness leaves.
constexpr double share_of_witness = 1.0 / 512;

/// Of the triangle's point nearest to x, next to it.
Weights nearest_weights(const Triangle& triangle, const Point& x) {
  const auto wide = [&](std::size_t i) {
    return Coordinates<long double>{static_cast<long double>(triangle[i][0]) - x[0],
                                    static_cast<long double>(triangle[i][1]) - x[1],
                                    static_cast<long double>(triangle[i][2]) - x[2]};
  };
  const auto corner = wide(0);
  const auto at = difference(closest_to_origin(corner, wide(1), wide(2)), corner);
  const auto u = difference(wide(1), corner);
  const auto v = difference(wide(2), corner);
  const long double uu = dot(u, u);
  const long double uv = dot(u, v);
  const long double vv = dot(v, v);
  const long double determinant = uu * vv - uv * uv;
  const long double s = (vv * dot(at, u) - uv * dot(at, v)) / determinant;
  const long double t = (uu * dot(at, v) - uv * dot(at, u)) / determinant;
  if (std::isfinite(s) && std::isfinite(t)) {
    return rounded_into_triangle({static_cast<double>(s), static_cast<double>(t)});
  }
  // Of a degenerate triangle, along its longer edge from the corner.
  const bool along_u = uu >= vv;
  const long double share = std::max(uu, vv) > 0.0L ? dot(at, along_u ? u : v) / std::max(uu, vv) : 0.0L;
  return rounded_into_triangle(along_u ? Weights{static_cast<double>(share), 0.0}
                                       : Weights{0.0, static_cast<double>(share)});
}

/// Normals of the primitives that are as far as that, but for what spheres say.
std::vector<Normal> telling(const CoveredModel& model, const Triangle& triangle, double radius) {
  std::vector<Normal> result;
  for (std::size_t i = 0; i < model.convex.size(); ++i) {
    const auto sphere = [&](const auto& solid) { return lower_by_sphere(solid, triangle); };
    if (!model.convex[i] || std::visit(sphere, model.checker.primitives()[i]) >= radius) continue;
    const auto [distance, certificate] = model.convex[i]->certified(triangle);
    if (!(distance.lo >= radius)) continue;
    for (const Normal& normal : certificate.normals) {
      result.push_back({static_cast<std::uint32_t>(i), normal.vector});
    }
  }
  return result;
}

}  // namespace

CertifiedEnclosure covered(const CoveredModel& model, const Triangle& triangle, const Point& nearest, double tolerance,
                           const std::function<bool()>& interrupted) {
  CertifiedEnclosure result{{0.0, infinity}, {}};
  auto& [distance, certificate] = result;
  const auto witness = nearest_witness(model.search, nearest, Side::inside, share_of_witness * tolerance, interrupted);
  if (!witness) return result;
  certificate.witness = witness;
  certificate.weights = nearest_weights(triangle, *witness);
  distance.hi = model.checker(triangle, {0.0, 0.0}, certificate).hi;
  if (std::isfinite(distance.hi) && !verified({0.0, distance.hi}, tolerance)) {
    const CoverQuestion question{[&](double r) { return telling(model, triangle, r); },
                                 [&](double r, const std::vector<Normal>& normals) {
                                   return EmptyNeighbourhood(model.checker.set(), model.checker.primitives(), triangle,
                                                             r, normals, witness);
                                 }};
    if (const auto empty = empty_radius(question, distance.hi, tolerance, interrupted)) {
      distance.lo = empty->radius;
      certificate.cover = empty->cover;
      certificate.normals = empty->normals;
    }
  }
  distance = model.checker(triangle, distance, certificate);
  return result;
}

}  // namespace verisq::verify
