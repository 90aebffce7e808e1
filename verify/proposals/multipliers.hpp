/// Multipliers that prove bounds: of linear programs over boxes, and how they are found.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "verify/proposals/support_mapping.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

// Multipliers of half-spaces, points on and in a superquadric, in floating point.

// The root that a tapered solid's support function takes, in plain floating point (docs/mathematics.md §18).

/// About the root τ of ‖(r, Z + k τ)‖_q = τ, as `proposed::support_root` states it.
template <class Float>
[[nodiscard]] Float near_root_of_support(Float section, Float height, Float k, Float q) {
  // ‖(r, Z + k τ)‖ - τ is convex and not negative at the start, from where Newton ascends to the root: with the maximum
  // norm it is there.
  Float root = std::max({section, height / (1 - k), -height / (1 + k)});
  for (int i = 0; i < 60 && q < infinity && root > 0; ++i) {
    const Float moved = height + k * root;
    const Float large = std::max(section, std::fabs(moved));
    const Float small = std::min(section, std::fabs(moved));
    const Float norm = large * std::pow(1 + std::pow(small / large, q), 1 / q);
    const Float slope = std::copysign(k, k * moved) * std::pow(std::fabs(moved) / norm, q - 1) - 1;
    const Float step = (root - norm) / slope;
    root += step;
    if (!(step > 4 * std::numeric_limits<Float>::epsilon() * root)) break;
  }
  return root;
}

// The shortest straight way from a point inside a superquadric to its surface, in plain floating point. Proposes,
// proves nothing.

struct InnerWalk {
  Coordinates<double> direction;  ///< of length 1
  double length;
};

struct InnerWalkLimits {
  double steady_direction;  ///< the error of the length is of second order in that of the direction
  int most_walks;
};

/// Each step walks along the surface normal at the point where the last walk ended. This never lengthens the way, and
/// it stops at a locally shortest one. `q` lies where Boundary covers the solid; for a tapered solid walks go down,
/// too.
[[nodiscard]] InnerWalk shortest_walk(const Boundary<double>& boundary, bool is_tapered, const Coordinates<double>& q,
                                      const InnerWalkLimits& limits);

// Small linear programs over boxes: the largest value of a linear function under linear constraints.

using PoseParameters = Eigen::Matrix<double, 6, 1>;  ///< a translation, then a rotation vector

/// constant + slope·δ >= 0
struct LinearConstraint {
  double constant;
  PoseParameters slope;
  double tightness = 0.0;  ///< constant by the range of slope·δ: the smaller, the more of the box is excluded
};

/// Multipliers λ >= 0, one for each constraint, which make
///     Σ λ c + Σ_k half_k |objective_k + Σ λ a_k|
/// small. By weak duality no δ of the box |δ| <= half that keeps the constraints has a larger objective·δ, whatever λ
/// is. If `ray` is true, the same sum with objective 0 is negative: then no such δ exists. They are found by the
/// simplex method in floating point; users evaluate them in intervals.
struct Multipliers {
  std::vector<double> values;
  bool ray = false;
};

[[nodiscard]] Multipliers multipliers(const PoseParameters& objective, const PoseParameters& half,
                                      std::span<const LinearConstraint> constraints);

}  // namespace verisq::verify
