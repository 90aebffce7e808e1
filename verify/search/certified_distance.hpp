/// Distances with their certificates, and the order in which searches process candidates.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/checker.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Results of searches for a point, in the form of certificates.

/// An enclosure of the signed distance and the vectors that certify its ends, in the solid's frame.
struct PrimitiveDistance {
  Enclosure distance;
  Proposal direction;     ///< certifies the lower end
  Proposal witness = {};  ///< certifies the upper end outside: leads from a point near the solid's surface to the query
};

/// Rounded to nearest; zero, which proves nothing, if the result is not finite.
[[nodiscard]] inline std::array<double, 3> rounded(const Proposal& v) {
  const std::array result{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
  return std::ranges::all_of(result, [](double c) { return std::isfinite(c); }) ? result : std::array<double, 3>{};
}

// The order in which searches process primitives: the nearest bounding sphere first, so that far ones are never proven.

/// One of several queries that may decide a distance.
struct Candidate {
  double sphere_bound;  ///< lower bound of its distance
  std::size_t index;
};

/// The candidates with indices below `count`, with rising `sphere_bound(index)`.
template <class SphereBound>
[[nodiscard]] std::vector<Candidate> nearest_spheres_first(std::size_t count, const SphereBound& sphere_bound) {
  std::vector<Candidate> order;
  order.reserve(count);
  for (std::size_t i = 0; i < count; ++i) order.push_back({sphere_bound(i), i});
  std::ranges::sort(order, {}, &Candidate::sphere_bound);
  return order;
}

// Foresees in plain floating point which upper ends the checker can prove, at a hundredth of its price.

/// The kernels prove upper ends by a point b that they round; a certificate defines b exactly. If a solid is sharp or a
/// point is close to its surface, the two may differ by more than the kernels' bound allows.
class WitnessEstimate {
 public:
  explicit WitnessEstimate(const Model& model);

  using Vector = std::array<long double, 3>;

  /// |point - b| with b as Normal describes it, and some 2^-56 of the lengths at hand for rounding. Proves nothing.
  [[nodiscard]] long double operator()(const Vector& point, const Normal& normal) const;

 private:
  struct PosedBoundary {
    Boundary<long double> boundary;
    std::array<Vector, 3> rotation;  ///< model to own frame, row by row
    Vector origin;
    long double radius;
  };

  std::vector<PosedBoundary> primitives_;
};

// Models with tapered primitives.

/// Returns whether a primitive has a taper that changes anything.
[[nodiscard]] inline bool has_taper(const Model& model) {
  return std::ranges::any_of(model.primitives, [](const Primitive& p) { return is_tapered(p.superquadric); });
}

// Enclosures of the paper's method (§5.1) for one superquadric in its own frame: a point of the surface, the normal
// there, the support point of a direction. They use double-ended interval arithmetic, as the paper does with FILIB++.

class BisectedEnclosure {
 public:
  explicit BisectedEnclosure(const Superquadric& superquadric);

  /// A box that contains a point of the surface {F = 1}, F being the left side of Eq. (1). It contains the segment of
  /// the line p + t d between t1 <= 0 with F <= 1 and t2 >= 0 with F >= 1, both proven; bisection finds the ones
  /// closest to 0. Nothing if the line misses the solid.
  [[nodiscard]] std::optional<Vector3<double>> surface_point(const Coordinates<double>& p,
                                                             const Coordinates<double>& d) const;

  /// Contains, for each point of {F = 1} in the box, a positive multiple of a subgradient of F (of the gradient if
  /// there is one). Unbounded, or contains 0, if the formula divides by a coordinate that may vanish.
  [[nodiscard]] Vector3<double> normal(const Vector3<double>& x) const;

  /// Eqs. (14), (15), (5): contains, for each v of the bounded box but 0, a point of the solid where v·x is largest.
  [[nodiscard]] Vector3<double> support_point(const Vector3<double>& v) const;

  [[nodiscard]] const SuperquadricBounds<double>& bounds() const { return bounds_; }

 private:
  SuperquadricBounds<double> bounds_;
  Vector3<double> semi_axes_;
  Interval e1_, e2_;
  double reach_;  ///< at least the distance of any surface point from the centre
};

[[nodiscard]] bool bounded(const Vector3<double>& v);

/// The lower end of Eqs. (17) and (20), n·d / |n|, for some n of the box `normal` and some d of the box `to`. The
/// result is 0 if this is not positive, or not bounded.
[[nodiscard]] double plane_distance(const Vector3<double>& normal, const Vector3<double>& to);

}  // namespace verisq::verify
