/// What of a cube a convex primitive sweeps on its way, from within and from without (docs/mathematics.md §23).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "verify/analysis/norm_expansion.hpp"
#include "verify/proof/superquadric.hpp"
#include "verify/removed_volume/volume_in_cube.hpp"
#include "verify/sets/cube.hpp"
#include "verify/sweep/enclosed_path.hpp"
#include "verify/sweep/moving_gauge.hpp"

namespace verisq::verify {

/// Of a leg of the path the shares from `begin` to `end`, in [0, 1].
struct PartOfLeg {
  std::uint32_t leg;
  double begin;
  double end;
};

/// Immutable: safe to ask from many threads.
class SweptPrimitive {
 public:
  /// Precondition: the primitive is not bent. The path has to outlive this.
  SweptPrimitive(const Primitive& primitive, const EnclosedPath& path);

  [[nodiscard]] std::vector<PartOfLeg> whole_path() const;

  /// A box that contains all that is swept.
  [[nodiscard]] std::array<Interval, 3> box() const;

  /// A time of a leg.
  struct Moment {
    std::uint32_t leg = 0;
    double time = 0.0;
  };

  struct InCube {
    std::vector<PartOfLeg> times = {};  ///< what is swept at others does not meet the cube; none: nothing does
    CornerHeights outer = {};           ///< where there are times: all that is swept of the cube lies there
    Moment deepest = {};                ///< likewise: when to look from within; proves nothing
  };

  /// Of what is swept at these times; once `interrupted`, which is polled, nothing of the kind is meant. Precondition:
  /// what is swept at others does not meet the cube.
  [[nodiscard]] InCube in(const Cube& cube, std::span<const PartOfLeg> times,
                          const std::function<bool()>& interrupted) const;

  /// A part of the cube that lies in the primitive about then.
  [[nodiscard]] CornerHeights inner(const Cube& cube, const Moment& moment) const;

 private:
  struct Placement;
  struct Facing;

  [[nodiscard]] Placement placement(std::uint32_t leg, double time) const;
  [[nodiscard]] MovingGauge moving_gauge(std::uint32_t leg) const;
  [[nodiscard]] Facing facing(const Cube& cube, const PartOfLeg& times) const;
  [[nodiscard]] double sag(const Cube& cube, const PartOfLeg& times) const;
  [[nodiscard]] static bool is_beyond_nothing(const Facing& deepest);
  [[nodiscard]] static bool is_above(const Facing& other, const Facing& deepest, double allowed);
  [[nodiscard]] std::optional<double> middle_of(const PartOfLeg& times) const;

  const EnclosedPath& path_;
  SuperquadricBounds<Real> bounds_;
  Matrix3<double> rotation_;     ///< from the primitive's own frame
  Vector3<double> translation_;  ///< its origin: the focus
  Interval radius_;              ///< of a sphere about it that contains the primitive
  double smallest_semi_axis_;
  NormFunction<double> gauge_;  ///< proposes
};

}  // namespace verisq::verify
