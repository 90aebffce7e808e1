/// Proposes witnesses by the search over cubes, and covers by halving cells until the checker's own look settles each.
#include "verify/sets/solid_certificate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "verify/sets/bent_union_certificate.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t most_cells = 3000;

/// Of the tolerance, what the search for the witness leaves.
constexpr double share_of_witness = 1.0 / 512;

/// Nothing where it takes more cells than `most`.
std::optional<std::vector<bool>> cover_of(const EmptyBall& ball, std::size_t most,
                                          const std::function<bool()>& interrupted) {
  std::vector<bool> bits;
  std::vector<EmptyBall::Cell> open{ball.whole()};
  while (!open.empty()) {
    const EmptyBall::Cell cell = open.back();
    open.pop_back();
    const bool settled = ball.is_empty(cell);
    bits.push_back(!settled);
    if (settled) continue;
    if (bits.size() + open.size() + 2 > most || cell.depth == EmptyBall::deepest || interrupted()) return std::nullopt;
    const auto [first, second] = EmptyBall::halves(cell);
    open.push_back(second);
    open.push_back(first);
  }
  return bits;
}

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

class Covering {
 public:
  Covering(const CoveredSolid& solid, const Point& x, const std::function<bool()>& interrupted)
      : solid_(solid), x_(x), interrupted_(interrupted), parts_(solid.parts.size()) {}

  [[nodiscard]] std::optional<Point> witness(Side side, double tolerance) const {
    const auto found = solid_.search.nearest(x_, side, share_of_witness * tolerance, interrupted_);
    return found ? std::optional(nearer(solid_.search, x_, *found, side)) : std::nullopt;
  }

  /// A ball that holds nothing of the solid, or of its complement, a little smaller than `distance`, that of a witness.
  [[nodiscard]] bool find(Place wanted, double distance, double tolerance, const std::optional<Point>& near) {
    near_ = near;
    constexpr double first_share = 0x1p-45;
    if (alone(wanted, distance * (1.0 - first_share))) return true;
    if (alone(wanted, distance - tolerance / 64)) return true;
    for (double gap = 0.98 * tolerance; gap < distance; gap *= 16.0) {
      if (interrupted_()) return false;
      if (divided(wanted, distance - gap, most_cells)) return true;
    }
    return false;
  }

  double radius = 0.0;  ///< of the ball that was found
  Certificate certificate;

 private:
  bool alone(Place wanted, double r) { return divided(wanted, r, 1); }

  bool divided(Place wanted, double r, std::size_t most) {
    if (!(r > 0.0)) return false;
    const std::vector<Normal> normals = telling(r);
    const EmptyBall ball(solid_.checker.set(), solid_.checker.primitives(), x_, r, wanted, normals, near_);
    const auto cover = cover_of(ball, most, interrupted_);
    if (!cover) return false;
    radius = r;
    certificate.normals = normals;
    certificate.cover = *cover;
    return true;
  }

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
  std::optional<Point> near_;
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
  if (here == Colour::white && std::isfinite(distance.hi) && !verified(distance, tolerance) &&
      covering.find(Place::outside, distance.hi, tolerance, certificate.witness) && covering.radius > distance.lo) {
    distance.lo = covering.radius;
    certificate.escape.reset();
  } else if (here == Colour::black && std::isfinite(distance.lo) && !verified(distance, tolerance) &&
             covering.find(Place::inside, -distance.lo, tolerance, certificate.escape) &&
             -covering.radius < distance.hi) {
    distance.hi = -covering.radius;
  } else {
    covering.certificate = {};
  }
  if (!covering.certificate.cover.empty()) {
    const auto& normals = covering.certificate.normals;
    certificate.cover = covering.certificate.cover;
    certificate.normals.insert(certificate.normals.end(), normals.begin(), normals.end());
  }
  distance = solid.checker(x, distance, certificate);
  distance = {distance.lo + 0.0, distance.hi + 0.0};  // for readers of maps "-0" would look like a sign
  return result;
}

}  // namespace verisq::verify
