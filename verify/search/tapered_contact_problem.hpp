/// The closest point of a tapered solid, section by section, for any floating-point type.
///
/// In the solid's own frame (docs/mathematics.md §18) a point of the surface is w = M u with N(u) = 1, M = (1 - k²) /
/// (1 - k u_z/a3). At the height of w the solid's section is {‖(x/a1, y/a2)‖_p2 <= R}, and half the squared distance of
/// q to it is convex in z, because it is the least over x and y of a convex function on a convex set. With ν the
/// multiplier of the projection of (q1, q2) on the section and dR/dz from N(w) = 1 - k² + k z/a3, its derivative is
///     F(z) = z - q3 + ν (±|u_z/a3|^(p1-1) - k) / (a3 r^(p1-1)),     r the norm of u's section,
/// which rises. The unknown is t = ln(r a3/|u_z|), which resolves the poles and the widest section alike.
#pragma once

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include "verify/proof/superquadric.hpp"
#include "verify/proposals/boundary.hpp"
#include "verify/search/contact_problem.hpp"

namespace verisq::verify::logarithmic {

using std::pow;

template <class Float>
class TaperedContactProblem {
 public:
  TaperedContactProblem(const Superquadric& solid, const Proposal& q, const Resolution& resolution)
      : solid_(solid),
        q_(q),
        resolution_(resolution),
        k_(taper_coefficient<Float>(solid.taper)),
        height_(solid.semi_axes[2]),
        excess_(excess(solid.exponents[0])),
        section_excess_(excess(solid.exponents[1])) {}

  [[nodiscard]] Contact solve() const {
    if (!outside()) return radial();
    const bool below = slope(equator(Float(1))) > 0;  // the widest section lies above the closest point
    const Float side = below ? -1 : 1;
    if (below && slope(equator(Float(-1))) < 0) return corner(equator(Float(1)));
    const auto rise = [&](const Float& t) { return Float(side * slope(place(t, side))); };  // falls with t
    Float low = -farthest();
    Float high = farthest();
    const Float at_low = rise(low);
    const Float at_high = rise(high);
    if (at_low <= 0) return excess_ == 0 ? corner(place(low, side)) : contact(place(low, side));
    if (at_high >= 0) return contact(place(high, side));
    if (!(at_low > 0 && at_high < 0)) return radial();  // numbers overflow
    std::uintmax_t most_steps = 100;
    // A few units in the last place of Float: nearer, the bracket's ends are rounding errors, and only bisected.
    const Float last_places = 4 * std::numeric_limits<Float>::epsilon();
    const Float wanted = std::max(Float(resolution_.step * resolution_.step), last_places);
    const auto close = [&](const Float& a, const Float& b) { return fabs(b - a) <= wanted * (1 + fabs(a)); };
    std::tie(low, high) = boost::math::tools::toms748_solve(rise, low, high, at_low, at_high, close, most_steps);
    return contact(place((low + high) / 2, side));
  }

 private:
  /// A point of the surface but for x and y: u's section and height, and the solid's at that height.
  struct Place {
    Float side;     ///< 1 above the widest section, -1 below
    Float section;  ///< r
    Float z_share;  ///< |u_z| / a3
    Float radius;   ///< R
    Float z;
  };

  /// The projection of (q1, q2) on a section.
  struct Foot {
    Contact contact;   ///< normal: (q1, q2) - foot
    Float multiplier;  ///< ν
  };

  /// p - 1, as ContactProblem takes it.
  [[nodiscard]] Float excess(double e) const {
    if (2.0 - e <= resolution_.below_two) return Float(0);
    return Float(2) / std::max(e, resolution_.above_zero) - 1;
  }

  [[nodiscard]] Float farthest() const { return -log(Float(resolution_.surface)) + 4; }

  /// So far that the height's rounding leaves digits of z - q3. Nearer, the normal at the radial projection is as good:
  /// a bound loses the square of the distance.
  [[nodiscard]] bool outside() const {
    const auto nearest = std::max<long double>(1e6 * resolution_.surface, 1e-18L);
    return Boundary<long double>(solid_).gauge({std::fabs(q_[0]), std::fabs(q_[1]), q_[2]}) > 1.0L + nearest;
  }

  [[nodiscard]] Contact radial() const {
    const auto normal = Boundary<long double>(solid_).normal({std::fabs(q_[0]), std::fabs(q_[1]), q_[2]});
    return {q_, {std::copysign(normal[0], q_[0]), std::copysign(normal[1], q_[1]), normal[2]}};
  }

  [[nodiscard]] Place at(const Float& section, const Float& z_share, const Float& side) const {
    const Float scale = (1 - k_ * k_) / (1 - k_ * side * z_share);
    return {side, section, z_share, scale * section, height_ * side * scale * z_share};
  }

  [[nodiscard]] Place equator(const Float& side) const { return at(Float(1), Float(0), side); }

  [[nodiscard]] Place place(const Float& t, const Float& side) const {
    const Float p = excess_ + 1;
    const Float smaller = exp(Float(-log1p(Float(exp(Float(-p * fabs(t))))) / p));  // of the larger of the two shares
    const Float larger_ratio = exp(Float(-fabs(t)));
    return t > 0 ? at(smaller, smaller * larger_ratio, side) : at(smaller * larger_ratio, smaller, side);
  }

  [[nodiscard]] Foot foot(const Place& place) const {
    const auto radius = static_cast<long double>(place.radius);
    // With q3 = 0 the exponent along z is any; this one lets a rhombus be solved by its radius.
    const Superquadric section{{solid_.semi_axes[0], solid_.semi_axes[1], solid_.semi_axes[0]},
                               {1.0, solid_.exponents[1]}};
    const Proposal q{q_[0] / radius, q_[1] / radius, 0.0L};  // the section has the radius 1
    const Boundary<long double> boundary(section);
    if (boundary.gauge({std::fabs(q[0]), std::fabs(q[1]), 0.0L}) <= 1)
      return {{{q_[0], q_[1], 0}, {0, 0, 0}}, Float(0)};
    Contact found = ContactProblem<Float>(section, q, resolution_).solve();
    std::array<Float, 2> logs;
    for (const std::size_t i : {0U, 1U}) {
      found.point[i] *= radius;
      found.normal[i] *= radius;
      logs[i] = log(Float(std::fabs(found.normal[i]) * solid_.semi_axes[i]));
    }
    // The normal is ν times the gradient of a norm, whose dual norm, of the conjugate exponent, is 1.
    const Float log_multiplier = section_excess_ == 0 ? Float(std::max(logs[0], logs[1]))
                                                      : log_norm<Float>(logs[0], logs[1], 1 / section_excess_);
    return {found, exp(log_multiplier)};
  }

  /// ν times how fast the constraint rises with z.
  [[nodiscard]] Float push(const Place& place, const Float& multiplier) const {
    if (multiplier == 0) return Float(0);
    const Float of_height = excess_ == 0 ? Float(1) : Float(pow(place.z_share, excess_));
    return multiplier * (place.side * of_height - k_) / (height_ * pow(place.section, excess_));
  }

  [[nodiscard]] Float slope(const Place& place) const {
    return place.z - Float(q_[2]) + push(place, foot(place).multiplier);
  }

  [[nodiscard]] Contact contact(const Place& place) const {
    Foot found = foot(place);
    const Float across = found.multiplier == 0 ? Float(Float(q_[2]) - place.z) : push(place, found.multiplier);
    found.contact.point[2] = static_cast<long double>(place.z);
    found.contact.normal[2] = static_cast<long double>(across);
    return found.contact;
  }

  /// On the widest section or at an end, for e1 = 2 an edge and a tip: between the normals about it.
  [[nodiscard]] Contact corner(const Place& place) const {
    Contact found = foot(place).contact;
    found.point[2] = static_cast<long double>(place.z);
    found.normal[2] = static_cast<long double>(Float(Float(q_[2]) - place.z));
    return found;
  }

  const Superquadric& solid_;
  Proposal q_;
  Resolution resolution_;
  Float k_;
  Float height_;          ///< a3
  Float excess_;          ///< p1 - 1
  Float section_excess_;  ///< p2 - 1
};

}  // namespace verisq::verify::logarithmic
