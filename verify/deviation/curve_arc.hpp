/// Arcs of the curve |x|^p + |y|^p = 1, x, y >= 0, p = 2/e: where they end, and how far they bulge from their chords
/// (docs/mathematics.md §20).
#pragma once

#include <cstdint>
#include <vector>

#include "verify/proof/superquadric.hpp"

namespace verisq::verify {

/// Encloses one point of the curve.
struct CurvePoint {
  Interval x;
  Interval y;
};

/// The arcs between (1, 0) and (0, 1), made as they are asked for: one is halved about its middle, so that all halves
/// of one depth are of about one length, however flat or sharp the curve is.
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

  /// Makes the halves, where they are not made yet. Not while another thread asks anything.
  void halve(Arc arc);
  /// The halves are this arc and the next. Precondition: halved.
  [[nodiscard]] Arc first_half(Arc arc) const { return arcs_[arc].first_half; }
  /// The point where the arc is halved. Precondition: halved.
  [[nodiscard]] const CurvePoint& middle(Arc arc) const { return to(first_half(arc)); }

  /// Whether its halvings are proven to have cut off no more than it: arcs of which that is so, and neither of which is
  /// a part of the other, have no more than ends in common. Where neighbours differ by rounding only, halves may
  /// overlap.
  [[nodiscard]] bool in_order(Arc arc) const { return arcs_[arc].in_order; }

  /// Whatever lies on the arc is, after x has been multiplied by `width` and y by `height`, no farther from the chord
  /// of its exact ends than this. Rounded up; infinite where the ends cannot be told apart.
  [[nodiscard]] double bulge(Arc arc, double width, double height) const;

 private:
  struct Node {
    CurvePoint point;
    CurvePoint normal;
  };
  struct Entry {
    std::uint32_t from;  ///< of `points_`, as `to`
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

}  // namespace verisq::verify
