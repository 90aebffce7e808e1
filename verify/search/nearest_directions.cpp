/// Depth first: a cone is cleared by the face between its corners, or lies in the box, or is cut in two.
#include "verify/search/nearest_directions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "verify/proof/certificate.hpp"
#include "verify/proposals/boundary.hpp"
#include "verify/proposals/triangle.hpp"
#include "verify/search/enclosing_box.hpp"

namespace verisq::verify {

namespace {

using Wide = long double;
using WideVector = Coordinates<Wide>;

constexpr std::size_t kMostExits = 4000;  ///< points of the surface
constexpr int kMostBisections = 50;       ///< directions stay exact
constexpr Wide kExitMargin = 0x1p-62;     ///< of the gauge: what a proposal of the surface loses by rounding

/// A ray from q and a point q + d of it that is proven to lie in the solid.
struct Exit {
  WideVector direction;  ///< exact: barycentric coordinates that are multiples of a power of two
  PreciseVector unit;
  PreciseVector d;
  WideVector nearest_d;  ///< for proposals
};

struct DirectionCone {
  std::array<std::size_t, 3> exits;
  int bisections;
};

class DirectionCover {
 public:
  DirectionCover(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q,
                 const PreciseInterval& depth, const PreciseVector& box)
      : boundary_(solid), bounds_(bounds), q_(q), nearest_q_(midpoint(q)), depth_(depth), box_(box) {
    for (std::size_t k = 0; k < 3; ++k) mirrored_[k] = q[k].upper() == Real(0) && (k < 2 || !bounds.is_tapered());
  }

  [[nodiscard]] bool succeeds() {
    const std::size_t x = add({1, 0, 0});
    const std::size_t y = add({0, 1, 0});
    std::vector<DirectionCone> open{{{x, y, add({0, 0, 1})}, 0}};
    if (bounds_.is_tapered()) open.push_back({{x, y, add({0, 0, -1})}, 0});
    while (!open.empty()) {
      const DirectionCone cone = open.back();
      open.pop_back();
      if (cleared(cone) || in_box(cone)) continue;
      if (cone.bisections == kMostBisections || exits_.size() >= kMostExits) return false;
      for (const DirectionCone& half : halves(cone)) open.push_back(half);
    }
    return true;
  }

 private:
  /// A vector about normal to the face of three points, towards it, with the signs that the lemma asks for.
  [[nodiscard]] PreciseVector axis_of(const WideVector& a, const WideVector& b, const WideVector& c) const {
    WideVector foot = closest_to_origin(a, b, c);
    const std::size_t folded = bounds_.is_tapered() ? 2 : 3;
    for (std::size_t k = 0; k < folded; ++k) foot[k] = std::max<Wide>(foot[k], 0);
    if (folded == 2)
      foot[2] = std::min({a[2], b[2], c[2]}) < 0 ? std::min<Wide>(foot[2], 0) : std::max<Wide>(foot[2], 0);
    return usable(foot) ? precise(foot) : PreciseVector();
  }

  [[nodiscard]] const Exit& exit_of(const DirectionCone& cone, std::size_t corner) const {
    return exits_[cone.exits[corner]];
  }

  [[nodiscard]] bool cleared(const DirectionCone& cone) const {
    const PreciseVector axis =
        axis_of(exit_of(cone, 0).nearest_d, exit_of(cone, 1).nearest_d, exit_of(cone, 2).nearest_d);
    const Real reach = (length<Real>(axis) * PreciseInterval(depth_.upper())).upper();
    return std::ranges::all_of(cone.exits, [&](std::size_t i) { return axis.dot(exits_[i].d).lower() > reach; });
  }

  [[nodiscard]] bool in_box(const DirectionCone& cone) const {
    const auto nearest = [&](std::size_t corner) { return midpoint(exit_of(cone, corner).unit); };
    const PreciseVector axis = axis_of(nearest(0), nearest(1), nearest(2));
    Real least = axis.dot(exit_of(cone, 0).unit).lower();
    for (std::size_t i = 1; i < 3; ++i) least = std::min(least, axis.dot(exit_of(cone, i).unit).lower());
    if (!(least > Real(0))) return false;
    const PreciseInterval longest = length<Real>(axis) / PreciseInterval(least);  // 1/m, from above
    const PreciseInterval factor = hull(PreciseInterval(depth_.lower()), PreciseInterval(depth_.upper()) * longest);
    for (std::size_t k = 0; k < 3; ++k) {
      const PreciseInterval u =
          hull(hull(exit_of(cone, 0).unit[k], exit_of(cone, 1).unit[k]), exit_of(cone, 2).unit[k]);
      const PreciseInterval p = q_[k] + u * factor;
      if (!subset(p, box_[k]) || (mirrored_[k] && !subset(-p, box_[k]))) return false;
    }
    return true;
  }

  std::size_t add(const WideVector& direction) {
    exits_.push_back(proven_exit(direction));
    return exits_.size() - 1;
  }

  /// As far along the ray as can be proven; q itself at worst.
  [[nodiscard]] Exit proven_exit(const WideVector& direction) const {
    const PreciseVector exact = precise(direction);
    const PreciseVector unit = exact / length<Real>(exact);
    for (Wide margin = kExitMargin; margin < 1; margin *= 8) {
      const Wide reach = boundary_.exit(nearest_q_, direction, 1 - margin);
      const PreciseVector d = exact * PreciseInterval(Real(reach));
      if (std::isfinite(reach) && bounds_.gauge_up(q_ + d) <= Real(1)) {
        return {direction, unit, d, along(WideVector{}, direction, reach)};
      }
    }
    return {direction, unit, PreciseVector(), {}};
  }

  /// Cuts the longest edge between the unit vectors at the middle direction.
  [[nodiscard]] std::array<DirectionCone, 2> halves(const DirectionCone& cone) {
    constexpr std::array<std::pair<std::size_t, std::size_t>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};
    std::pair<std::size_t, std::size_t> longest{};
    Wide squared = -1;
    for (const auto& [i, j] : edges) {
      const WideVector edge = difference(exit_of(cone, i).nearest_d, exit_of(cone, j).nearest_d);
      if (dot(edge, edge) <= squared) continue;
      squared = dot(edge, edge);
      longest = {cone.exits[i], cone.exits[j]};
    }
    const std::size_t middle = middle_of(longest.first, longest.second);
    DirectionCone first{cone.exits, cone.bisections + 1};
    DirectionCone second = first;
    std::ranges::replace(first.exits, longest.second, middle);
    std::ranges::replace(second.exits, longest.first, middle);
    return {first, second};
  }

  [[nodiscard]] std::size_t middle_of(std::size_t a, std::size_t b) {
    const auto [position, created] = middles_.try_emplace(std::minmax(a, b), 0);
    if (created) {
      const WideVector u = exits_[a].direction;
      const WideVector v = exits_[b].direction;
      position->second = add({(u[0] + v[0]) / 2, (u[1] + v[1]) / 2, (u[2] + v[2]) / 2});
    }
    return position->second;
  }

  Boundary<Wide> boundary_;
  const SuperquadricBounds<Real>& bounds_;
  const PreciseVector& q_;
  WideVector nearest_q_;
  const PreciseInterval& depth_;
  const PreciseVector& box_;
  std::array<bool, 3> mirrored_{};
  std::vector<Exit> exits_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles_;
};

}  // namespace

bool nearest_points_lie_in(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q,
                           const PreciseInterval& depth, const PreciseVector& box) {
  return DirectionCover(solid, bounds, q, depth, box).succeeds();
}

}  // namespace verisq::verify
