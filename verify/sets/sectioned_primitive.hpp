/// A primitive cut across its axis, bent or not: how far each of its sections reaches, proven, and where, proposed
/// (docs/mathematics.md §9).
#pragma once

#include <array>
#include <optional>

#include "verify/numbers/vector.hpp"
#include "verify/proof/superquadric.hpp"
#include "verify/proposals/section_mapping.hpp"
#include "verify/sets/bend.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Everything in the primitive's own frame, with its centre as origin. A bent solid is not convex, but a section of it
/// is the more nearly so the thinner it is. Immutable.
class SectionedPrimitive {
 public:
  explicit SectionedPrimitive(const Primitive& primitive);

  /// What the bend makes of the axis at a height z: it turns by kz.
  struct End {
    double height;
    Interval cosine, sine;  ///< of kz
    Interval along, up;     ///< R and Z of the axis' point
  };

  /// The image of the points with heights between those of two ends.
  struct Section {
    End lower, upper;
  };

  [[nodiscard]] Section whole() const;

  /// Nothing where there is no bend, or no number between the heights.
  [[nodiscard]] std::optional<std::array<Section, 2>> halves(const Section& section) const;

  /// About how far the hull of a section, or what bounds it, exceeds the section.
  [[nodiscard]] double slack(const Section& section) const;

  /// At least the largest direction·x over the section; infinity where it overflows. With (n_R, n_S, n_Z) the direction
  /// in the frame of the bend, and at a height z
  ///     e(z) = n·(the axis' point),   c(z) = n_R cos kz - n_Z sin kz,
  /// the image of (r, s, z) has n·x = e(z) + c(z) r + n_S s. Let H(c) be the support function of the unbent solid
  /// towards (c, n_S, v) for a number v: convex in c, and changed by no more than the largest |r| times what c is. So
  ///     n·x <= e(z) - v z + H(c(z))   for any v,
  /// and between the two ends e and c leave their chords by no more than an eighth of the squared difference of heights
  /// times |e''| = |k c| and |c''| = |k² c|; e not upwards where it is convex, k c >= 0. The chords of e, of H along
  /// that of c, and v z are linear: largest at an end.
  [[nodiscard]] double support_up(const Vector3<double>& direction, const Section& section) const;

  /// The number v of `support_up` that gives about the least bound; it may overflow.
  [[nodiscard]] double slope(const Coordinates<double>& direction, const Section& section) const;

  /// About a point of the section where direction·x is largest.
  [[nodiscard]] Coordinates<double> support_point(const Coordinates<double>& direction, const Section& section) const;

 private:
  [[nodiscard]] End end_at(double height) const;

  double half_length_;
  double curvature_ = 0.0;
  std::optional<BendMap<double>> map_;  ///< where there is a bend
  SuperquadricBounds<double> bounds_;
  Interval focus_;          ///< along z
  double extent_ = 0.0;     ///< at least the largest |r|
  SectionMapping mapping_;  ///< proposes slopes and farthest points
};

}  // namespace verisq::verify
