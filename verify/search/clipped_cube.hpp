/// The part of a cube on one side of a surface, and the part that a convex primitive sweeps on its way.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/numbers/norms.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/solids/cube.hpp"
#include "verify/solids/moving_gauge.hpp"
#include "verify/solids/paths.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The volume that half-spaces leave of a cube.

/// {e : normal·e <= offset}, e from the centre of a cube. The plane stands for a set between two such half-spaces: with
/// the offset less the error, and with the offset plus the error, in the same units.
struct CuttingPlane {
  Point normal;  ///< finite, not zero
  double offset;
  double error = 0.0;  ///< at least 0
};

[[nodiscard]] CuttingPlane opposite(const CuttingPlane& plane);

/// The largest value of normal·e over a cube, rounded up.
[[nodiscard]] double reach_up(const Point& normal, double half_width);

/// A cube, cut by one half-space after the other: tetrahedra in floating point, with a bound of the volume lost by
/// rounding (docs/mathematics.md §23). Their coordinates are multiples of the half-width.
class ClippedCube {
 public:
  /// Precondition: the half-width is a power of two, far from overflow and underflow of its cube.
  explicit ClippedCube(double half_width);

  void clip(const CuttingPlane& plane);

  /// The volume of the intended set; at least 0 and at most the cube's volume.
  [[nodiscard]] Enclosure volume() const;

 private:
  using Tetrahedron = std::array<Point, 4>;

  double half_width_;
  double error_ = 0.0;  ///< of the volume so far, in cubic half-widths, rounded up
  std::vector<Tetrahedron> tetrahedra_;
};

// A closed surface in the cubes of an octree: the part of a cube on one side of the surface, if that part is simple
// (docs/mathematics.md §23).

/// The part of a cube that belongs to a set: within all of the half-spaces or, for `beyond`, the complement of that.
struct CubePart {
  enum class Kind : std::uint8_t { nothing, all, within, beyond, unknown };
  Kind kind;
  std::vector<CuttingPlane> planes = {};  ///< one or two planes for the kinds `within` and `beyond`
};

/// Immutable: safe to ask from many threads.
class DividedSurface {
 public:
  /// `orientation` is 1 if the triangles face outward, -1 if they face inward. Inside are the points about which the
  /// surface winds with its orientation, outside those about which it does not wind; the set is one of both.
  /// Precondition: as for ClosedSurface, and every edge is run through as often one way as the other.
  DividedSurface(std::vector<Triangle> triangles, int orientation, Side side);

  [[nodiscard]] const ClosedSurface& closed() const { return surface_; }

  /// The facts known about a cube.
  struct Piece {
    std::vector<std::uint32_t> triangles;  ///< no other triangles meet the cube
    Point place{};                         ///< a point in the cube
    std::optional<int> winding = {};       ///< the winding number at `place`
  };

  [[nodiscard]] Piece piece(const Cube& cube) const;
  /// The piece of a cube within the cube of `whole`: the same result, at less cost.
  [[nodiscard]] Piece piece(const Cube& cube, const Piece& whole) const;

  [[nodiscard]] CubePart part(const Cube& cube, const Piece& piece) const;

 private:
  [[nodiscard]] CubePart::Kind kind_at(int winding) const;
  [[nodiscard]] CubePart divided_by_one(const Cube& cube, const Piece& piece) const;
  [[nodiscard]] CubePart divided_by_two(const Cube& cube, const Piece& piece) const;
  [[nodiscard]] CubePart parts(int winding_behind, std::vector<CuttingPlane> planes, bool behind_all) const;

  ClosedSurface surface_;
  int orientation_;
  Side side_;
};

/// The half-space {x : (x - point)·normal <= 0} in a cube.
[[nodiscard]] CuttingPlane plane_in(const Cube& cube, const Point& point, const Point& normal);

// The part of a cube that a convex primitive sweeps on its way: half-spaces between which the boundary of the swept
// set runs (docs/mathematics.md §23).

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
