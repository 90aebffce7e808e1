/// Cubes cut by a surface, and the divided surface.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/proof/closed_surface.hpp"
#include "verify/solids/cube.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The volume that half-spaces leave of a cube.

/// {e : normal·e <= offset}, e from the centre of a cube; what is meant is a set that contains it with the offset less
/// the error, and lies in it with the offset plus the error, in the same units.
struct CuttingPlane {
  Point normal;  ///< finite, not zero
  double offset;
  double error = 0.0;  ///< at least 0
};

[[nodiscard]] CuttingPlane opposite(const CuttingPlane& plane);

/// The largest value of normal·e over a cube, rounded up.
[[nodiscard]] double reach_up(const Point& normal, double half_width);

/// A cube, cut by one half-space after the other: tetrahedra in floating point, with a bound of what that loses
/// (docs/mathematics.md §23). Their coordinates are multiples of the half-width.
class ClippedCube {
 public:
  /// Precondition: a power of two, far from overflow and underflow of its cube.
  explicit ClippedCube(double half_width);

  void clip(const CuttingPlane& plane);

  /// Of what is meant; at least 0 and at most that of the cube.
  [[nodiscard]] Enclosure volume() const;

 private:
  using Tetrahedron = std::array<Point, 4>;

  double half_width_;
  double error_ = 0.0;  ///< of the volume so far, in cubic half-widths, rounded up
  std::vector<Tetrahedron> tetrahedra_;
};

// A closed surface in the cubes of an octree: the part of a cube on one side of it, where that is simple
// (docs/mathematics.md §23).

/// What of a cube belongs to a set: the part in all of the half-spaces, or, the other way about, what they leave.
struct CubePart {
  enum class Kind : std::uint8_t { nothing, all, within, beyond, unknown };
  Kind kind;
  std::vector<CuttingPlane> planes = {};  ///< of the kinds `within` and `beyond`: one or two
};

/// Immutable: safe to ask from many threads.
class DividedSurface {
 public:
  /// `orientation` is 1 where the triangles face outward, -1 where they face inward. Inside is where the surface winds
  /// as its orientation says, outside where it does not wind; the set is one of both. Precondition: as ClosedSurface,
  /// and every edge is run through as often one way as the other.
  DividedSurface(std::vector<Triangle> triangles, int orientation, Side side);

  [[nodiscard]] const ClosedSurface& closed() const { return surface_; }

  /// What is known of a cube.
  struct Piece {
    std::vector<std::uint32_t> triangles;  ///< no others meet the cube
    Point place{};                         ///< in the cube
    std::optional<int> winding = {};       ///< there
  };

  [[nodiscard]] Piece piece(const Cube& cube) const;
  /// Of a cube in the one that `whole` is of: the same, at less cost.
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

}  // namespace verisq::verify
