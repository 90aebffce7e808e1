/// Where a section of a primitive across its axis, bent or not, reaches farthest, in plain floating point. Proposes,
/// proves nothing (docs/mathematics.md §9).
#pragma once

#include "verify/proposals/support_mapping.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Everything in the primitive's own frame, with its centre as origin. Immutable.
class SectionMapping {
 public:
  explicit SectionMapping(const Primitive& primitive);

  /// What the bend makes of the axis at a height z: it turns by kz.
  struct End {
    double height;
    double cosine, sine;  ///< of kz
    double along, up;     ///< R and Z of the axis' point
  };

  /// Heights, before the bend, between which a section lies.
  struct Section {
    End lower, upper;
  };

  [[nodiscard]] Section section(double lower, double upper) const { return {end_at(lower), end_at(upper)}; }

  /// The number v with which the chords of §9 give about the least bound of the section towards `direction`; it may
  /// overflow. 0 without a bend.
  [[nodiscard]] double slope(const Coordinates<double>& direction, const Section& section) const;

  /// About a point of the section where direction·x is largest; without a bend of the whole primitive.
  [[nodiscard]] Coordinates<double> support_point(const Coordinates<double>& direction, const Section& section) const;

  /// About the point that the bend takes to x.
  [[nodiscard]] Coordinates<double> unbent(const Coordinates<double>& x) const;

  /// About the normal of the bent surface where the unbent one has that normal at that point.
  [[nodiscard]] Coordinates<double> bent_normal(const Coordinates<double>& normal,
                                                const Coordinates<double>& unbent_point) const;

 private:
  using Plain = Coordinates<double>;

  [[nodiscard]] End end_at(double height) const;
  [[nodiscard]] Plain turned(const Plain& v) const;
  [[nodiscard]] Plain turned_back(const Plain& v) const;
  [[nodiscard]] Plain bent(const Plain& unbent) const;
  [[nodiscard]] Plain farthest(double c, double across, double slope) const;
  [[nodiscard]] Plain farthest_at(double height, double c, double across) const;
  [[nodiscard]] double scale_at(double height) const;
  [[nodiscard]] double scale_slope_at(double height) const;

  Superquadric superquadric_;
  bool is_bent_;
  double curvature_ = 0.0;
  double cosine_ = 1.0, sine_ = 0.0;  ///< of the bend's direction
  double taper_;                      ///< k of docs/mathematics.md §18
  SuperquadricSet<double> unbent_;
  SuperquadricSet<double> untapered_;
};

}  // namespace verisq::verify
