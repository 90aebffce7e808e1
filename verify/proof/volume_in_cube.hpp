/// The volume of a swept solid in a cube, on its bone's side of closed surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/norms.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/solids/cube.hpp"
#include "verify/solids/moving_gauge.hpp"
#include "verify/solids/paths.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

// The volume of a cube's part in a set that half-spaces bracket from within and from without (docs/mathematics.md §23).

/// Values at the corners of a cube; corner k lies at the larger x, y, z if bit 0, 1, 2 of k is set. They are values of
/// a function that is linear on each of six tetrahedra. The tetrahedra lie between the corner 0 and the corner 7 along
/// the edges. The heights describe the part of the cube where the function is not positive.
using CornerHeights = std::array<Interval, 8>;

/// The heights of a function that is linear on the whole cube, by its value at the centre and its rise from there to
/// the sides of larger x, y and z.
[[nodiscard]] CornerHeights linear_heights(const Interval& at_centre, const Vector3<double>& rise);

[[nodiscard]] CornerHeights negative(const CornerHeights& heights);

/// The union of such parts; of none it is empty.
using UnionOfParts = std::vector<CornerHeights>;

/// The intersection of such unions; of none it is the whole cube.
using PartOfCube = std::vector<UnionOfParts>;

/// A set between two others: `inner` is a part of it, and it is a part of `outer`.
struct BracketedPart {
  PartOfCube inner;
  PartOfCube outer;
};

/// Sets the part to the empty set, or to an unknown set.
void leave_nothing(BracketedPart& part);
void leave_unknown(BracketedPart& part);

/// Encloses the volume of the set in a cube of this half-width.
[[nodiscard]] Enclosure volume_in_cube(double half_width, const BracketedPart& part);

/// The volume of the whole cube.
[[nodiscard]] Interval volume_of_cube(double half_width);

// The part of a cube that a convex primitive sweeps on its way, from within and from without (docs/mathematics.md §23).

/// The part of a leg of the path between the shares `begin` and `end`, in [0, 1].
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
    std::vector<PartOfLeg> times = {};  ///< at other times the swept region does not meet the cube; empty: it never
                                        ///< does
    CornerHeights outer = {};           ///< if there are times: the whole swept part of the cube lies in this part
    Moment deepest = {};                ///< if there are times: the time for a bound from within; proves nothing
  };

  /// The part of the cube that is swept at these times. `interrupted` is polled; once it returns true, the result is
  /// meaningless. Precondition: at other times the swept region does not meet the cube.
  [[nodiscard]] InCube in(const Cube& cube, std::span<const PartOfLeg> times,
                          const std::function<bool()>& interrupted) const;

  /// A part of the cube that lies in the primitive at about this moment.
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
  Matrix3<double> rotation_;     ///< rotation from the primitive's own frame
  Vector3<double> translation_;  ///< translation of its origin: the focus
  Interval radius_;              ///< radius of a sphere about the focus that contains the primitive
  double smallest_semi_axis_;
  NormFunction<double> gauge_;  ///< proposes
};

// A closed surface in cubes: which part of a cube lies on its bone's side, where that is simple (docs/mathematics.md
// §23).

/// Immutable: safe to ask from many threads.
class BoundingSurface {
 public:
  /// Closes the surface over its rims. Throws Error(input) unless it is finite and every edge of the closed surface is
  /// run through as often one way as the other. Also throws unless it encloses a volume that is proven not to be 0.
  /// Precondition: triangles of existing vertices.
  explicit BoundingSurface(const BoneSurface& surface) : BoundingSurface(surface, closing_over_rims(surface.mesh)) {}

  [[nodiscard]] std::size_t rims() const { return rims_; }
  [[nodiscard]] const ClosedSurface& closed() const { return surface_; }

  /// The facts known about a cube.
  struct Piece {
    std::vector<std::uint32_t> triangles;  ///< a point in the cube
    Point place{};                         ///< the winding number at `place`
    std::optional<int> winding = {};       ///< there
  };

  [[nodiscard]] Piece piece(const Cube& cube) const;
  /// The piece of a cube within the cube of `whole`: the same result, at less cost.
  [[nodiscard]] Piece piece(const Cube& cube, const Piece& whole) const;

  /// Returns whether no bone lies in the cube, on this side of this surface.
  [[nodiscard]] bool leaves_nothing(const Piece& piece) const;

  /// Adds the restriction that points are on the bone's side.
  void restrict(BracketedPart& part, const Cube& cube, const Piece& piece) const;

 private:
  enum class Answer : std::uint8_t { no, yes, unknown };
  struct Wedge;

  BoundingSurface(const BoneSurface& surface, const Closing& closing);

  [[nodiscard]] Piece piece(const Cube& cube, const std::vector<std::uint32_t>& of, const Piece* whole) const;
  [[nodiscard]] Answer is_bone(int winding) const;
  void restrict_to_side(BracketedPart& part, int winding_behind, const Wedge& wedge) const;
  void restrict_by_one(BracketedPart& part, const Cube& cube, const Piece& piece) const;
  void restrict_by_two(BracketedPart& part, const Cube& cube, const Piece& piece) const;

  std::size_t rims_;
  ClosedSurface surface_;
  BoneSide side_;
  int orientation_;  ///< the sign of the volume that it encloses
};

/// The values at a cube's corners of the function (x - point)·normal.
[[nodiscard]] CornerHeights heights_above(const Cube& cube, const Point& point, const Vector3<double>& normal);

}  // namespace verisq::verify
