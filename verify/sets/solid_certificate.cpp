/// Proposes witnesses by the search over cubes.
#include "verify/sets/solid_certificate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "verify/analysis/distance_up.hpp"
#include "verify/sets/bent_union_certificate.hpp"
#include "verify/sets/cover_search.hpp"
#include "verify/sets/nearest_witness.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// Of the tolerance, what the search for the witness leaves.
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
      return EmptyNeighbourhood(solid_.checker.set(), solid_.checker.primitives(), x_, r, wanted, normals, near);
    };
    return empty_radius({[&](double r) { return telling(r); }, neighbourhood}, distance, tolerance, interrupted_);
  }

 private:
  /// Normals of the primitives that have the whole ball on one side, but for what spheres say.
  std::vector<Normal> telling(double r) {
    std::vector<Normal> result;
    for (std::size_t i = 0; i < solid_.parts.size(); ++i) {
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
  std::vector<std::optional<CertifiedEnclosure>> parts_;  ///< of those that were looked at
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
  distance = solid.checker(x, distance, certificate);
  distance = {distance.lo + 0.0, distance.hi + 0.0};  // for readers of maps "-0" would look like a sign
  return result;
}

}  // namespace verisq::verify
