/// Patches of a superquadric's surface, and their areas.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/solids/bend.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Arcs of the curve |x|^p + |y|^p = 1, x, y >= 0, p = 2/e: their ends, and how far they bulge from their chords
// (docs/mathematics.md §20).

/// Encloses one point of the curve.
struct CurvePoint {
  Interval x;
  Interval y;
};

/// The arcs between (1, 0) and (0, 1), made on demand. An arc is halved about its middle, so that all halves of one
/// depth have about the same length, however flat or sharp the curve is.
class ArcTree {
 public:
  using Arc = std::uint32_t;

  /// `exponent`: e, in (0, 2].
  explicit ArcTree(double exponent);

  [[nodiscard]] static Arc whole() { return 0; }

  [[nodiscard]] const CurvePoint& from(Arc arc) const { return points_[arcs_[arc].from].point; }
  [[nodiscard]] const CurvePoint& to(Arc arc) const { return points_[arcs_[arc].to].point; }

  /// Normals of the curve at the ends, of any length, outward: between the ends they turn from one to the other.
  [[nodiscard]] const CurvePoint& normal_from(Arc arc) const { return points_[arcs_[arc].from].normal; }
  [[nodiscard]] const CurvePoint& normal_to(Arc arc) const { return points_[arcs_[arc].to].normal; }

  /// Makes the halves, unless they are made already. Not thread-safe: no other thread may use the tree meanwhile.
  void halve(Arc arc);
  /// The halves are this arc and the next. Precondition: halved.
  [[nodiscard]] Arc first_half(Arc arc) const { return arcs_[arc].first_half; }
  /// The point where the arc is halved. Precondition: halved.
  [[nodiscard]] const CurvePoint& middle(Arc arc) const { return to(first_half(arc)); }

  /// Returns whether it is proven that the arc's halvings cut off nothing beyond the arc. Two such arcs, neither of
  /// which is a part of the other, have at most ends in common. If neighbours differ by rounding only, halves may
  /// overlap.
  [[nodiscard]] bool in_order(Arc arc) const { return arcs_[arc].in_order; }

  /// Scale the arc by `width` in x and `height` in y: no point of it is farther from the chord of its exact ends than
  /// this. Rounded up; infinite if the ends cannot be distinguished.
  [[nodiscard]] double bulge(Arc arc, double width, double height) const;

 private:
  struct Node {
    CurvePoint point;
    CurvePoint normal;
  };
  struct Entry {
    std::uint32_t from;  ///< index in `points_`, like `to`
    std::uint32_t to;
    bool in_order = true;
    Arc first_half = 0;  ///< 0: not made yet
  };

  [[nodiscard]] CurvePoint point_towards(double x, double y) const;
  [[nodiscard]] CurvePoint normal_at(const CurvePoint& point) const;

  NormExponent<Real> primal_;
  NormExponent<Real> dual_;
  std::vector<Node> points_;
  std::vector<Entry> arcs_;
};

// A convex arc in the plane, known by its ends and the tangents there: its length, its bulge, and how fast the point
// passes as its foot moves along the chord (docs/mathematics.md §20).

using PlaneVector = std::array<Interval, 2>;

/// Tangents have any length but 0, and point in the direction from `from` to `to`.
struct PlaneArc {
  PlaneVector from;
  PlaneVector to;
  PlaneVector tangent_from;
  PlaneVector tangent_to;
};

struct ArcBounds {
  Interval chord;    ///< its length
  Interval stretch;  ///< the stretch of the arc over its chord, everywhere: at least 1
  Interval lens;     ///< the area between arc and chord: at least 0
  double bulge;      ///< no point of the arc is farther from its foot
  /// The derivative by the share u of the chord lies on the segment between these two: here its components' hulls.
  PlaneVector speed;
};

// How large a patch is, and how evenly its parameters cover it (docs/mathematics.md §20).

/// With (u, t) in [0, 1]² the shares of both chords, a patch's point stands over its foot, and over the point of the
/// two triangles `Patch::halves` with the same shares. `density` is the patch's area by du dt.
struct PatchArea {
  Enclosure area;         ///< finite below sizes of 1e150; lower ends of patches that do not hold each other add up
  double unevenness;      ///< no less than (greatest density - least) / mean density; infinite if nothing is known
  double correspondence;  ///< upper bound of the distance of a point from the triangles' point of the same shares
};

// Patches that cover the surface of one posed superquadric, tapered or bent. Each patch lies close to the hull of four
// points (docs/mathematics.md §20).

/// A part of the surface of primitive `primitive`: the image, in one octant, of an arc along the latitude and an arc
/// along the longitude.
struct PatchCell {
  std::uint32_t primitive;
  std::uint8_t octant;  ///< bit i: coordinate i is negative
  std::uint8_t halvings = 0;
  ArcTree::Arc along = ArcTree::whole();   ///< from the equator to a pole
  ArcTree::Arc around = ArcTree::whole();  ///< from x to y
};

/// Every point of the patch is no farther than `thickness` from one of two flat triangles between its corners,
/// `halves()`. It is no farther than `radius` from `sample`, a point near the patch's middle.
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

/// The arc of a patch that is halved.
enum class PatchHalving : std::uint8_t { along, around };

/// The largest number of halvings of a patch: parts are no smaller than 2^-60 of the surface.
inline constexpr int most_halvings_of_patch = 60;

/// Makes the patches of one primitive.
class PatchedSurface {
 public:
  PatchedSurface(const Primitive& primitive, std::uint32_t index);

  /// The eight octants.
  [[nodiscard]] std::vector<PatchCell> octants() const;

  /// Must be called before any other function of a cell; the cell belongs to this primitive. Not thread-safe: no other
  /// thread may use the surface meanwhile.
  void prepare(const PatchCell& cell);

  [[nodiscard]] Patch patch(const PatchCell& cell) const;

  [[nodiscard]] PatchArea area(const PatchCell& cell) const;

  /// The halving of the longer way. Nothing if the ends of its arcs cannot be distinguished well, or if the patch is
  /// already halved too often. The choice proves nothing.
  [[nodiscard]] std::optional<PatchHalving> halving(const PatchCell& cell) const;
  /// The two halves cover the patch, whichever arc is halved.
  [[nodiscard]] std::array<PatchCell, 2> halves(const PatchCell& cell, PatchHalving halving) const;
  [[nodiscard]] std::optional<std::array<PatchCell, 2>> halves(const PatchCell& cell) const;

 private:
  /// The place of a point before the bend, and in the model.
  struct Placed {
    Vector3<double> straight;
    Vector3<double> posed;
  };

  [[nodiscard]] Placed placed(const CurvePoint& along, const CurvePoint& around, std::uint8_t octant) const;
  [[nodiscard]] Interval taper_stretch(const PatchCell& cell, double reach) const;
  [[nodiscard]] std::array<Placed, 4> corners(const PatchCell& cell) const;
  /// Upper bound of the distance of the patch from the corners' hull, before the bend.
  [[nodiscard]] Interval straight_thickness(const PatchCell& cell) const;
  /// The same distance, between straight points of the patch and of the corners' hull, after the bend.
  [[nodiscard]] Interval bent_thickness(const Interval& straight, const std::array<Placed, 4>& corners) const;
  /// The distance from straight points near the corners' hull to the flat triangles of the corners in the model, as in
  /// `Patch`.
  [[nodiscard]] double flat_thickness(const Interval& straight, const std::array<Placed, 4>& corners) const;
  /// The arc along the latitude after the taper, x scaled by `scale`; then the arc along the longitude.
  [[nodiscard]] PlaneArc profile(const PatchCell& cell, const Interval& scale) const;
  [[nodiscard]] PlaneArc section(const PatchCell& cell) const;
  [[nodiscard]] std::array<Interval, 2> taper_scales(const PatchCell& cell) const;
  /// The factor by which the bend stretches the patch along z: 1 - k r.
  [[nodiscard]] Interval bend_stretch(const std::array<Placed, 4>& corners, double beyond) const;
  /// An upper bound of the cell's area, from the run and rise of its arcs. `widest` bounds |β| of its section.
  [[nodiscard]] double largest_area(const PatchCell& cell, const PlaneArc& along, const PlaneArc& around,
                                    const Interval& widest) const;
  /// The radius of the cell's section arc: its largest distance from the axis.
  [[nodiscard]] double section_radius(const PatchCell& cell) const;

  std::uint32_t index_;
  Superquadric superquadric_;
  Vector3<double> semi_axes_;
  bool tapered_;
  Interval k_;     ///< the taper's k
  Interval fall_;  ///< 1 - k²
  std::optional<Bend> bend_;
  std::optional<BendMap<double>> bend_map_;
  Matrix3<double> rotation_;
  Vector3<double> translation_;
  ArcTree along_;
  ArcTree around_;
};

}  // namespace verisq::verify
