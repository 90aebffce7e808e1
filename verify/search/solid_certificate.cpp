/// This file implements solid_certificate.hpp.
#include "verify/search/solid_certificate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/triangle_pieces.hpp"
#include "verify/search/union_of_convex.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

std::optional<std::vector<bool>> cover_of(const EmptyNeighbourhood& neighbourhood, std::size_t most,
                                          const std::function<bool()>& interrupted) {
  std::vector<bool> bits;
  std::vector<EmptyNeighbourhood::Cell> open{neighbourhood.whole()};
  while (!open.empty()) {
    if (interrupted()) return std::nullopt;
    const EmptyNeighbourhood::Cell cell = open.back();
    open.pop_back();
    const bool settled = neighbourhood.is_empty(cell);
    bits.push_back(!settled);
    if (settled) continue;
    const auto halves = neighbourhood.halves(cell);
    if (bits.size() + open.size() + 2 > most || !halves) return std::nullopt;
    open.push_back((*halves)[1]);
    open.push_back((*halves)[0]);
  }
  return bits;
}

namespace {

std::optional<EmptyRadius> empty_at(const CoverQuestion& question, double radius, std::size_t most,
                                    const std::function<bool()>& interrupted) {
  if (!(radius > 0.0)) return std::nullopt;
  const std::vector<Normal> normals = question.telling(radius);
  if (interrupted()) return std::nullopt;
  const auto cover = cover_of(question.neighbourhood(radius, normals), most, interrupted);
  if (!cover) return std::nullopt;
  return EmptyRadius{radius, normals, *cover};
}

}  // namespace

std::optional<EmptyRadius> empty_radius(const CoverQuestion& question, double distance, double tolerance,
                                        const std::function<bool()>& interrupted) {
  constexpr double first_share = 0x1p-45;
  constexpr double share_of_one_cell = 1.0 / 64;
  if (auto found = empty_at(question, distance * (1.0 - first_share), 1, interrupted)) return found;
  if (auto found = empty_at(question, distance - share_of_one_cell * tolerance, 1, interrupted)) return found;
  for (double gap = 0.98 * tolerance; gap < distance; gap *= 16.0) {
    if (interrupted()) return std::nullopt;
    if (auto found = empty_at(question, distance - gap, question.most_cells, interrupted)) return found;
  }
  return std::nullopt;
}

namespace {

/// The farthest of the points from `in`, which lies in the set, towards x, that is found to lie in it, too.
Point nearer(const SolidDistance& search, const Point& x, const Point& in, Side side) {
  const Colour wanted = side == Side::inside ? Colour::black : Colour::white;
  const auto at = [&](double t) {
    Point p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = in[i] + t * (x[i] - in[i]);
    return p;
  };
  double inside = 0.0;
  double outside = 1.0;
  Point best = in;
  for (int i = 0; i < 60 && outside - inside > 0x1p-54; ++i) {
    const double t = i == 0 ? 0x1p-20 : 0.5 * (inside + outside);
    const Point p = at(t);
    if (search.colour(p) == wanted) {
      inside = t;
      if (distance_up(x, p) < distance_up(x, best)) best = p;
    } else {
      outside = t;
    }
  }
  return best;
}

/// The witness is at most `tolerance` farther from x than the nearest point; nothing if none was found.
std::optional<Point> nearest_witness(const SolidDistance& search, const Point& x, Side side, double tolerance,
                                     const std::function<bool()>& interrupted) {
  const auto found = search.nearest(x, side, tolerance, interrupted);
  return found ? std::optional(nearer(search, x, *found, side)) : std::nullopt;
}

/// The share of the tolerance that the search for the witness may leave.
constexpr double share_of_witness = 1.0 / 512;

class Covering {
 public:
  Covering(const CoveredSolid& solid, const Point& x, const std::function<bool()>& interrupted)
      : solid_(solid), x_(x), interrupted_(interrupted), parts_(solid.parts.size()) {}

  [[nodiscard]] std::optional<Point> witness(Side side, double tolerance) const {
    return nearest_witness(solid_.search, x_, side, share_of_witness * tolerance, interrupted_);
  }

  /// A ball that holds nothing of the solid, or of its complement, a little smaller than `distance`, that of a witness.
  [[nodiscard]] std::optional<EmptyRadius> find(Place wanted, double distance, double tolerance,
                                                const std::optional<Point>& near) {
    const auto neighbourhood = [&](double r, const std::vector<Normal>& normals) {
      return EmptyNeighbourhood(solid_.checker.set(), solid_.checker.primitives(), x_, r, wanted, normals, near,
                                interrupted_);
    };
    return empty_radius({[&](double r) { return telling(r); }, neighbourhood}, distance, tolerance, interrupted_);
  }

 private:
  /// Normals of the primitives that have the whole ball on one side, unless spheres prove that.
  std::vector<Normal> telling(double r) {
    std::vector<Normal> result;
    for (std::size_t i = 0; i < solid_.parts.size() && !interrupted_(); ++i) {
      const auto sphere = [&](const auto& part) { return part.proof().lower_by_sphere(x_); };
      if (std::visit(sphere, solid_.parts[i]) >= r) continue;
      if (!parts_[i]) parts_[i] = certificate_of_part(solid_.parts[i], static_cast<std::uint32_t>(i), x_);
      const auto& [distance, proof] = *parts_[i];
      if (distance.lo >= r || -distance.hi >= r) {
        result.insert(result.end(), proof.normals.begin(), proof.normals.end());
      }
    }
    return result;
  }

  const CoveredSolid& solid_;
  Point x_;
  const std::function<bool()>& interrupted_;
  std::vector<std::optional<CertifiedEnclosure>> parts_;  ///< results for the parts processed so far
};

}  // namespace

CertifiedEnclosure covered(const CoveredSolid& solid, const Point& x, const CertifiedEnclosure& found, double tolerance,
                           const std::function<bool()>& interrupted) {
  if (verified(found.distance, tolerance)) return found;
  CertifiedEnclosure result = found;
  auto& [distance, certificate] = result;
  const Colour here = solid.search.colour(x);
  Covering covering(solid, x, interrupted);
  if (here != Colour::black) {
    if (const auto witness = covering.witness(Side::inside, tolerance)) {
      const double far = distance_up(x, *witness);
      if (far < distance.hi) {
        distance.hi = far;
        certificate.witness = witness;
      }
    }
  }
  if (here != Colour::white) {
    if (const auto escape = covering.witness(Side::outside, tolerance)) {
      const double far = distance_up(x, *escape);
      if (-far > distance.lo) {
        distance.lo = -far;
        certificate.escape = escape;
      }
    }
  } else if (!(distance.lo > 0.0)) {
    certificate.escape = x;  // proves that x does not lie inside
    distance.lo = std::max(distance.lo, 0.0);
  }
  std::optional<EmptyRadius> empty;
  if (here == Colour::white && std::isfinite(distance.hi) && !verified(distance, tolerance)) {
    empty = covering.find(Place::outside, distance.hi, tolerance, certificate.witness);
    if (empty && !(empty->radius > distance.lo)) empty.reset();
    if (empty) {
      distance.lo = empty->radius;
      certificate.escape.reset();
    }
  } else if (here == Colour::black && std::isfinite(distance.lo) && !verified(distance, tolerance)) {
    empty = covering.find(Place::inside, -distance.lo, tolerance, certificate.escape);
    if (empty && !(-empty->radius < distance.hi)) empty.reset();
    if (empty) distance.hi = -empty->radius;
  }
  if (empty) {
    certificate.cover = empty->cover;
    certificate.normals.insert(certificate.normals.end(), empty->normals.begin(), empty->normals.end());
  }
  if (interrupted()) return found;
  distance = solid.checker(x, distance, certificate, interrupted);
  distance = {distance.lo + 0.0, distance.hi + 0.0};  // for readers of maps "-0" would look like a sign
  return result;
}

namespace {

/// The weights of the triangle's point nearest to x, or of a point next to it.
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
  // For a degenerate triangle, along its longer edge from the corner.
  const bool along_u = uu >= vv;
  const long double share = std::max(uu, vv) > 0.0L ? dot(at, along_u ? u : v) / std::max(uu, vv) : 0.0L;
  return rounded_into_triangle(along_u ? Weights{static_cast<double>(share), 0.0}
                                       : Weights{0.0, static_cast<double>(share)});
}

/// Normals of the primitives that are as far as `radius`, unless spheres prove that.
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
                                                             r, Place::outside, normals, witness, interrupted);
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
