/// Patches that cover the surface of one posed superquadric, tapered or bent: each lies close to the hull of four
/// points (docs/mathematics.md §20).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/deviation/curve_arc.hpp"
#include "verify/deviation/patch_area.hpp"
#include "verify/deviation/plane_arc.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/sets/bend.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// A part of the surface of primitive `primitive`: the image of two arcs, of one along the latitude and of one along
/// the longitude, in one octant.
struct PatchCell {
  std::uint32_t primitive;
  std::uint8_t octant;  ///< bit i: coordinate i is negative
  std::uint8_t halvings = 0;
  ArcTree::Arc along = ArcTree::whole();   ///< from the equator to a pole
  ArcTree::Arc around = ArcTree::whole();  ///< from x to y
};

/// Every point of the patch is no farther than `thickness` from one of two flat triangles between its corners, which
/// are `halves()`, and no farther than `radius` from `sample`, a point near its middle.
struct Patch {
  std::array<Point, 4> corners;  ///< the first two at the same end of the arc along the latitude
  Point sample;
  double thickness;
  double radius;

  [[nodiscard]] std::array<Triangle, 2> halves() const {
    return {{{corners[0], corners[1], corners[3]}, {corners[0], corners[2], corners[3]}}};
  }

  /// No point of the patch is farther from x. Precondition: finite.
  [[nodiscard]] double radius_about(const Point& x) const;
};

/// Which of a patch's two arcs is halved.
enum class PatchHalving : std::uint8_t { along, around };

/// 2^-60 of the surface and no less: patches are not halved any more often.
inline constexpr int most_halvings_of_patch = 60;

/// Makes the patches of one primitive.
class PatchedSurface {
 public:
  PatchedSurface(const Primitive& primitive, std::uint32_t index);

  /// The eight octants.
  [[nodiscard]] std::vector<PatchCell> octants() const;

  /// Precondition of what is asked of a cell, which is of this primitive. Not while another thread asks anything.
  void prepare(const PatchCell& cell);

  [[nodiscard]] Patch patch(const PatchCell& cell) const;

  [[nodiscard]] PatchArea area(const PatchCell& cell) const;

  /// Of the longer way. Nothing where the ends of its arcs cannot be told apart well, or the patch is halved too often
  /// already. Nothing is proven by what is chosen.
  [[nodiscard]] std::optional<PatchHalving> halving(const PatchCell& cell) const;
  /// They cover the patch, whichever arc is halved.
  [[nodiscard]] std::array<PatchCell, 2> halves(const PatchCell& cell, PatchHalving halving) const;
  [[nodiscard]] std::optional<std::array<PatchCell, 2>> halves(const PatchCell& cell) const;

 private:
  /// Where a point lies before the bend, and in the model.
  struct Placed {
    Vector3<double> straight;
    Vector3<double> posed;
  };

  [[nodiscard]] Placed placed(const CurvePoint& along, const CurvePoint& around, std::uint8_t octant) const;
  [[nodiscard]] Interval taper_stretch(const PatchCell& cell, double reach) const;
  [[nodiscard]] std::array<Placed, 4> corners(const PatchCell& cell) const;
  /// How far the patch is from the corners' hull before the bend, at most.
  [[nodiscard]] Interval straight_thickness(const PatchCell& cell) const;
  /// What the bend makes of the distance between straight points of the patch and those of the corners' hull.
  [[nodiscard]] Interval bent_thickness(const Interval& straight, const std::array<Placed, 4>& corners) const;
  /// From straight points near the corners' hull to the flat triangles of the corners in the model, as a `Patch` has
  /// them.
  [[nodiscard]] double flat_thickness(const Interval& straight, const std::array<Placed, 4>& corners) const;
  /// The arc along the latitude after the taper, x scaled by `scale`; that around it.
  [[nodiscard]] PlaneArc profile(const PatchCell& cell, const Interval& scale) const;
  [[nodiscard]] PlaneArc section(const PatchCell& cell) const;
  [[nodiscard]] std::array<Interval, 2> taper_scales(const PatchCell& cell) const;
  /// By how much the bend stretches the patch along z: 1 - k r.
  [[nodiscard]] Interval bend_stretch(const std::array<Placed, 4>& corners, double beyond) const;
  /// Of the section's arc of the cell, of what is farthest from the axis.
  [[nodiscard]] double section_radius(const PatchCell& cell) const;

  std::uint32_t index_;
  Superquadric superquadric_;
  Vector3<double> semi_axes_;
  bool tapered_;
  Interval k_;     ///< of the taper
  Interval fall_;  ///< 1 - k²
  std::optional<Bend> bend_;
  std::optional<BendMap<double>> bend_map_;
  Matrix3<double> rotation_;
  Vector3<double> translation_;
  ArcTree along_;
  ArcTree around_;
};

}  // namespace verisq::verify
