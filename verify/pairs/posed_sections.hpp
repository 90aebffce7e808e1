/// A posed primitive cut across its axis, bent or not, and how far each section reaches (docs/mathematics.md §9).
#pragma once

#include <optional>

#include "verify/proof/rigid_motion.hpp"
#include "verify/proof/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Everything in the primitive's own frame, with its centre as origin, in 127-bit interval arithmetic. Immutable.
class PosedSections {
 public:
  /// Heights of the axis between which a section lies, before the bend.
  struct Section {
    double lower, upper;
  };

  explicit PosedSections(const Primitive& primitive);

  [[nodiscard]] const RigidMotion& motion() const { return motion_; }  ///< to the model's frame

  [[nodiscard]] Section whole() const { return {-half_length_, half_length_}; }

  /// At least the largest n·x of the section. With (n_R, n_S, n_Z) = n in the frame of the bend and at a height z
  ///     e(z) = n·(the axis' point),   c(z) = n_R cos kz - n_Z sin kz,
  /// no n·x of the section is more than the larger at both ends of e(z) - v z + h(c(z), n_S, v), and
  /// D²/8 (max (-k c)⁺ + k² |(n_R, n_Z)| max |r|) with the difference D of their heights, for any `slope` v: finite.
  [[nodiscard]] Real reach(const PreciseVector& n, const Section& section, double slope) const;

 private:
  [[nodiscard]] PreciseVector turned(const PreciseVector& n) const;

  SuperquadricBounds<Real> bounds_;
  PreciseVector focus_;  ///< about which the support function is
  RigidMotion motion_;
  double half_length_;
  PreciseInterval curvature_;
  PreciseInterval cosine_, sine_;  ///< of the bend's direction's angle from x to y
  PreciseInterval extent_;         ///< at least the largest |r| before the bend
};

/// Two sections of equal difference of heights; nothing where no number lies between the heights.
[[nodiscard]] std::optional<std::array<PosedSections::Section, 2>> halves(const PosedSections::Section& section);

}  // namespace verisq::verify
