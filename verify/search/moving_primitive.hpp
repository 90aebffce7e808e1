/// The part of a cube that a convex primitive sweeps on its way: half-spaces between which the boundary of the swept
/// set runs (docs/mathematics.md §23).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/numbers/norms.hpp"
#include "verify/search/clipped_cube.hpp"
#include "verify/solids/cube.hpp"
#include "verify/solids/moving_gauge.hpp"
#include "verify/solids/paths.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {

/// A part of a leg, from `begin` to `end` in [0, 1].
struct TimeStretch {
  std::uint32_t leg;
  double begin;
  double end;
};

/// S is the set that the primitive sweeps.
struct SweptPart {
  bool covered = false;                    ///< all of the cube lies in S
  std::vector<TimeStretch> open = {};      ///< S meets the cube at these times alone; empty: it does not meet it
  std::optional<CuttingPlane> outer = {};  ///< the part of S in the cube lies in this half-space; without it nothing is
                                           ///< known
  std::optional<CuttingPlane> inner = {};  ///< the part of this half-space in the cube lies in S; without it nothing is
                                           ///< known
};

/// Immutable: safe to ask from many threads.
class MovingPrimitive {
 public:
  /// Precondition: the primitive is not bent. The path has to outlive this.
  MovingPrimitive(const Primitive& primitive, const EnclosedPath& path);

  [[nodiscard]] std::vector<TimeStretch> whole_path() const;

  /// A box that contains all that is swept.
  [[nodiscard]] std::array<Interval, 3> box() const;

  /// The part that the motion during these stretches sweeps. Precondition: at other times the swept set does not meet
  /// the cube.
  [[nodiscard]] SweptPart part(const Cube& cube, std::span<const TimeStretch> stretches) const;

 private:
  struct Placement;
  struct Plane;

  [[nodiscard]] Placement placement(std::size_t leg, double time) const;
  [[nodiscard]] MovingGauge moving_gauge(std::size_t leg) const;
  [[nodiscard]] Plane plane(const Cube& cube, const TimeStretch& stretch) const;
  [[nodiscard]] std::vector<TimeStretch> halved(std::vector<Plane>& planes, const Plane& deepest,
                                                const Cube& cube) const;
  [[nodiscard]] static double offset_along(const Plane& plane, const Plane& other, double half_width);
  [[nodiscard]] double middle_of(const TimeStretch& stretch) const;
  [[nodiscard]] bool is_divisible(const TimeStretch& stretch) const;
  [[nodiscard]] CuttingPlane inner_plane(const Cube& cube, const Plane& plane) const;

  const EnclosedPath& path_;
  SuperquadricBounds<double> bounds_;
  NormFunction<double> gauge_;
  Matrix3<double> rotation_;     ///< rotation from the primitive's own frame
  Vector3<double> translation_;  ///< translation of its origin: the focus
  double smallest_semi_axis_;
};

}  // namespace verisq::verify
