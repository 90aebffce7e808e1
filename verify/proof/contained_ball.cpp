/// Covers the ball by cones from its centre, each cut off by a face with corners in the solid.
#include "verify/proof/contained_ball.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "verify/proof/certificate.hpp"
#include "verify/proof/revolution.hpp"

// Let d1, d2, d3 >= 0 with q + d_i proven in the solid K, and c with c·d_i >= t |c|, c >= 0, not 0. A vector v of the
// cone of the d_i with |v| <= t is v = Σ l_i d_i, l_i >= 0, and t |c| Σ l_i <= c·v <= t |c|, so that q + v lies in the
// hull of q and the q + d_i, which lies in K. When cones cover the octant, the ball of radius t about q lies in K,
// because g is monotone in each |coordinate| and |q_k + v_k| <= |q_k| + |v_k|. The best c points at the point of the
// face d1 d2 d3 closest to q. A cone whose face comes too close is cut in two, so that two new faces come closer to
// the surface. Of a tapered solid g is monotone in |x| and |y| alone: there the cones cover z < 0, too.

namespace verisq::verify {

namespace {

using Float = long double;
using Vector = Proposal;

constexpr int kBudget = 50'000;     ///< points of the surface
constexpr int kDeepestLevel = 50;   ///< of bisections: directions stay exact
constexpr Float kMargin = 0x1p-62;  ///< of the gauge: what a proposal of the surface loses by rounding

Float squared_distance(const Vector& a, const Vector& b) {
  return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

/// q + d lies in the solid: proven.
struct Corner {
  Vector direction;  ///< exact: barycentric coordinates that are multiples of a power of two
  PreciseVector d;   ///< exact: the direction times a number of 64 bits
  Vector nearest_d;  ///< for proposals
};

struct Cone {
  std::array<std::size_t, 3> corners;  ///< in a plane two, one of them repeated
  int level;                           ///< bisections so far
};

class BallProof {
 public:
  BallProof(const RevolvedPoint& point, double radius)
      : solid_(point.solid), bounds_(point.solid), radius_(Real(radius)), planar_(point.planar), q_(point.q) {
    const std::array<Real, 3> q = magnitudes<Real>(point.q, Direction::up);
    const std::size_t folded = bounds_.is_tapered() ? 2 : 3;
    for (std::size_t k = 0; k < folded; ++k) q_[k] = q[k];  // by monotony enough for the whole box
    nearest_q_ = midpoint(q_);
  }

  [[nodiscard]] bool succeeds() {
    const std::size_t x = add_corner({1, 0, 0});
    const std::size_t z = add_corner({0, 0, 1});
    const std::size_t y = planar_ ? z : add_corner({0, 1, 0});
    std::vector<Cone> open{{{x, y, z}, 0}};
    if (bounds_.is_tapered()) {
      const std::size_t below = add_corner({0, 0, -1});
      open.push_back({{x, planar_ ? below : y, below}, 0});
    }
    while (!open.empty()) {
      const Cone cone = open.back();
      open.pop_back();
      if (proven(cone)) continue;
      if (cone.level == kDeepestLevel || corners_.size() >= kBudget) return false;
      for (const Cone& half : bisect(cone)) open.push_back(half);
    }
    return true;
  }

 private:
  [[nodiscard]] bool proven(const Cone& cone) const {
    const auto& [a, b, c] = cone.corners;
    const Vector foot =
        proposed::closest_to_origin({corners_[a].nearest_d, corners_[b].nearest_d, corners_[c].nearest_d});
    const Proposal axis{std::max<Float>(foot[0], 0), std::max<Float>(foot[1], 0),
                        bounds_.is_tapered() ? foot[2] : std::max<Float>(foot[2], 0)};
    if (!usable(axis)) return false;
    const PreciseVector normal = precise(axis);
    const Real least = (radius_ * length<Real>(normal)).upper();
    return std::ranges::all_of(cone.corners, [&](std::size_t i) { return normal.dot(corners_[i].d).lower() >= least; });
  }

  std::size_t add_corner(const Vector& direction) {
    corners_.push_back(proven_corner(direction));
    return corners_.size() - 1;
  }

  /// As far along the ray as can be proven; q itself at worst.
  [[nodiscard]] Corner proven_corner(const Vector& direction) const {
    for (Float margin = kMargin; margin < 1; margin *= 8) {
      const Float reach = proposed::exit(solid_, nearest_q_, direction, 1 - margin);
      const PreciseVector d = precise(direction) * PreciseInterval(Real(reach));
      // Corners behind q would span no cone about the direction: the lemma asks for reach >= 0.
      if (std::isfinite(reach) && reach >= 0 && inside(d)) return {direction, d, midpoint(d)};
    }
    return {direction, precise(Proposal{}), {}};
  }

  [[nodiscard]] bool inside(const PreciseVector& d) const { return bounds_.gauge_up(q_ + d) <= Real(1); }

  /// Cuts the longest edge of the face at the middle direction.
  [[nodiscard]] std::array<Cone, 2> bisect(const Cone& cone) {
    constexpr std::array<std::pair<std::size_t, std::size_t>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};
    std::pair<std::size_t, std::size_t> longest{};
    Float squared = -1;
    for (const auto& [i, j] : edges) {
      const Float length = squared_distance(corners_[cone.corners[i]].nearest_d, corners_[cone.corners[j]].nearest_d);
      if (length <= squared || cone.corners[i] == cone.corners[j]) continue;
      squared = length;
      longest = {cone.corners[i], cone.corners[j]};
    }
    const std::size_t middle = middle_of(longest.first, longest.second);
    Cone first{cone.corners, cone.level + 1};
    Cone second = first;
    std::ranges::replace(first.corners, longest.second, middle);
    std::ranges::replace(second.corners, longest.first, middle);
    return {first, second};
  }

  [[nodiscard]] std::size_t middle_of(std::size_t a, std::size_t b) {
    const auto [position, created] = middles_.try_emplace(std::minmax(a, b), 0);
    if (created) {
      const Vector& u = corners_[a].direction;
      const Vector& v = corners_[b].direction;
      position->second = add_corner({(u[0] + v[0]) / 2, (u[1] + v[1]) / 2, (u[2] + v[2]) / 2});
    }
    return position->second;
  }

  Superquadric solid_;
  SuperquadricBounds<Real> bounds_;
  PreciseInterval radius_;
  bool planar_;
  PreciseVector q_;
  Vector nearest_q_{};
  std::vector<Corner> corners_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles_;
};

}  // namespace

// Mixed norms with p >= 1 are at most the 1-norm, so the octahedron of the semi-axes lies inside; with p >= 2 at most
// the 2-norm, so the ellipsoid does. With a taper g(w) <= (1 + |k|) N(w) / (1 - k²) = N(w) / (1 - |k|).
PreciseInterval inner_radius(const Superquadric& solid) {
  const PreciseInterval share = PreciseInterval(1) - abs(TaperNumbers<Real>(solid.taper).k);
  if (std::ranges::max(solid.exponents) <= 1.0) return share * PreciseInterval(Real(std::ranges::min(solid.semi_axes)));
  PreciseInterval sum(0);
  for (const double a : solid.semi_axes) sum += PreciseInterval(1) / square(PreciseInterval(Real(a)));
  return share / sqrt(sum);
}

// g(q + y) <= g(q) + g(y) <= g(q) + |y| / radius, so the ball of radius (1 - g(q)) * radius about q lies inside.
double central_depth(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q) {
  const PreciseInterval depth = (PreciseInterval(1) - bounds.gauge(q)) * inner_radius(solid);
  return std::max(0.0, depth.lower().to_double(Direction::down));
}

bool contains_ball(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q,
                   double radius) {
  if (!(bounds.gauge(q).upper() <= Real(1)) || !std::isfinite(radius)) return false;
  if (radius <= central_depth(solid, bounds, q)) return true;
  return BallProof(revolved(solid, q), radius).succeeds();
}

}  // namespace verisq::verify
