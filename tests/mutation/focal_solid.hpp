/// Tapered solids as their kernels know them, about the focus, at 200 bits: points of the surface and normals that are
/// known by how they are made.
#pragma once

#include <utility>
#include <verisq/model.hpp>

#include "host/device/primitive_parameters.hpp"
#include "tests/mutation/examination.hpp"
#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/real.hpp"

namespace verisq::mutation {

struct TestedSolid {
  Superquadric superquadric;
  bool loose_constants;  ///< widened far beyond rounding, as a host might that computes with fewer digits: still bounds
};

/// Sharp, smooth and flat, wider at either end; the largest semi-axis in [1, 2), as the kernels have it.
inline constexpr TestedSolid tested_solids[] = {
    {{{1.0, 1.5, 0.7}, {1.0, 1.0}, 19.0}, false}, {{{1.1, 0.3, 0.6}, {0.3, 1.7}, 1.0 / 19.0}, false},
    {{{0.5, 1.2, 1.9}, {1.8, 0.4}, 2.0}, true},   {{{1.2, 1.0, 1.4}, {0.05, 0.9}, 0.02}, false},
    {{{1.3, 0.9, 1.0}, {1.2, 0.8}, 0.4}, true},   {{{1.0, 1.1, 1.7}, {0.7, 1.0}, 1.001}, false}};

/// With its constants widened.
[[nodiscard]] device::PrimitiveParameters loosened(device::PrimitiveParameters parameters);

/// What a host with few digits might make of a solid: bounds of 1 - k^2 that are wide.
[[nodiscard]] device::BoxPrimitiveParameters with_wide_bounds(const Primitive& primitive);
/// Likewise, a taper and a focus that are off, with the error that this is (set_taper in
/// host/device/primitive_parameters.cpp).
[[nodiscard]] device::BoxPrimitiveParameters with_other_taper(Primitive primitive);

/// The tapered solid as the kernels know it, or, with another k, as it is: about its focus, where it is the set of w
/// with N(w) <= 1 - k^2 + k w_z / a3. Its surface is M u, u on the untapered one, M = (1 - k^2) / (1 - k u_z / a3).
class FocalSolid {
 public:
  FocalSolid(const oracle::MixedNorm<oracle::Real>& norm, oracle::Real k) : norm_(norm), k_(std::move(k)) {}

  [[nodiscard]] const oracle::MixedNorm<oracle::Real>& norm() const { return norm_; }
  [[nodiscard]] const oracle::Real& k() const { return k_; }
  [[nodiscard]] const oracle::Real& height() const { return norm_.semi_axes()[2]; }
  [[nodiscard]] oracle::Real fall() const { return 1 - k_ * k_; }

  [[nodiscard]] oracle::Vector surface(const oracle::Vector& u) const {
    return oracle::scaled<oracle::Real>(u, fall() / (1 - k_ * u[2] / height()));
  }

  /// That of the surface where the untapered one has the normal n with n.u = 1.
  [[nodiscard]] oracle::Vector normal(const oracle::Vector& n) const { return {n[0], n[1], n[2] - k_ / height()}; }

  /// max v.w, or hardly less: (1 - k^2) t for the t with h_N(v + (0, 0, k t / a3)) = t. The difference is convex and
  /// falls: chords from the left stay there.
  [[nodiscard]] oracle::Real support(const oracle::Vector& v) const {
    const auto excess = [&](const oracle::Real& t) {
      return norm_.support({v[0], v[1], v[2] + k_ * t / height()}) - t;
    };
    oracle::Real t = 0;
    for (int round = 0; round < 16; ++round) {
      const oracle::Real at = excess(t);
      const oracle::Real back = oracle::Real(1e-25) * (t + 1);
      const oracle::Real slope = (at - excess(t - back)) / back;
      if (at <= 0 || slope >= 0) break;
      t -= at / slope;
    }
    return fall() * t * (1 - oracle::Real(1e-20));
  }

  /// How deep the focus lies at least: the ball lies in the octahedron of the semi-axes.
  [[nodiscard]] oracle::Real inradius() const {
    const auto& a = norm_.semi_axes();
    const oracle::Real steepness = sqrt(1 / (a[0] * a[0]) + 1 / (a[1] * a[1]) + 1 / (a[2] * a[2]));
    return fall() / (steepness + abs(k_) / height());
  }

 private:
  oracle::MixedNorm<oracle::Real> norm_;
  oracle::Real k_;
};

/// A point of the untapered surface and its normal n, n.u = 1.
struct SurfacePoint {
  oracle::Vector u, n;
};

[[nodiscard]] SurfacePoint at_direction(const Point& direction, const oracle::MixedNorm<oracle::Real>& norm);

/// Towards anywhere, one of the axes, or the widest section.
[[nodiscard]] Point direction_of(oracle::RandomCases& random);

/// `apart` from a point along v.
[[nodiscard]] oracle::Vector stepped(const oracle::Vector& from, const oracle::Vector& v, double apart);

/// Whether a direction proves the lower end that it comes with, as far as one point p of the solid tells, whose
/// distance from q is known too: h(v) >= v.p.
[[nodiscard]] bool proves(const Results& found, const oracle::Vector& q, const oracle::Vector& p);

/// Whether both ends are true of a query along the normal `v` at p, outside of the solid or inside.
[[nodiscard]] bool encloses(const Results& found, const oracle::Vector& q, const oracle::Vector& p,
                            const oracle::Vector& v);

}  // namespace verisq::mutation
