/// The distance of two solids of any kind, by covers of neighbourhoods.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/proof/empty_neighbourhood.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/paths.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// A bound of how far a primitive reaches from a point: the primitive lies in a ball about that point.

/// The semi-axes of an ellipsoid that contains the solid, along its axes. They are the solid's semi-axes times 2^(1/2 -
/// 1/p) for each p = 2/e > 2, the largest ratio of the norm of exponent 2 to the solid's norm. Rounded up. A taper is
/// not taken into account.
[[nodiscard]] std::array<double, 3> semi_axes_of_ellipsoid(const Superquadric& solid);

/// At least the largest distance from any point of the box x, in the model's frame, to a point of the primitive. For a
/// ball it is |x - centre| plus the radius. Else, with the ellipsoid {Σ (xᵢ/bᵢ)² <= 1} about the primitive, for every x
/// in the ellipsoid and every `multiplier` μ > max bᵢ²
///     |x - c|² <= |x - c|² + μ (1 - Σ (xᵢ/bᵢ)²) <= μ + Σ cᵢ² μ / (μ - bᵢ²),
/// coordinate by coordinate the largest value of a parabola. The least such bound over μ is exact for the ellipsoid
/// (the S-lemma). Infinite if this proves nothing, as for bends and tapers.
[[nodiscard]] double farthest_up(const Primitive& primitive, const PreciseVector& x, double multiplier);

[[nodiscard]] bool is_ball(const Primitive& primitive);

// A posed primitive cut across its axis, bent or not, and how far each section reaches (docs/mathematics.md §9).

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
  PreciseInterval cosine_, sine_;  ///< cosine and sine of the angle from x to y of the bend's direction
  PreciseInterval extent_;         ///< at least the largest |r| before the bend
};

/// Two sections of equal difference of heights; nothing where no number lies between the heights.
[[nodiscard]] std::optional<std::array<PosedSections::Section, 2>> halves(const PosedSections::Section& section);

// A convex primitive in the frame of another model, at all times of a short motion: a body for covers to surround.

/// The hull of all places of the primitive, about a point beside its centre.
class PosedBody : public ConvexBody {
 public:
  /// `motion` is that of its model. The solid must outlive this.
  PosedBody(const PosedSuperquadric& solid, const ShortMotion& motion);

  [[nodiscard]] const Point& centre() const { return centre_; }

  [[nodiscard]] Real reach(const PreciseVector& v) const override;
  [[nodiscard]] std::array<double, 3> farthest(const std::array<double, 3>& v) const override;

 private:
  using Plain = Coordinates<double>;

  const PosedSuperquadric* solid_;
  ShortMotion motion_;
  RigidMotion place_;  ///< from its own frame, at the moment
  Point centre_;
  SuperquadricSet<double> plain_;  ///< in its own frame
  std::array<Plain, 3> rows_;      ///< rows of the rotation, about
};

// Two models of any kind, one of which moves, and the bounds that single evaluations prove about their distance.

/// A model's places, and its primitives' sections.
struct SolidParts {
  explicit SolidParts(const Model& model)
      : places(model), primitives(model.primitives), sections(model.primitives.begin(), model.primitives.end()) {}

  ExactChecker places;
  std::vector<Primitive> primitives;
  std::vector<PosedSections> sections;
};

/// Model A, and model B that moves for a short time. Both must outlive this. `interrupted`, unless empty, is polled;
/// once it returns true, less is proven.
class SolidPair {
 public:
  SolidPair(const SolidParts& a, const SolidParts& b, const ShortMotion& motion, Hook interrupted = {})
      : a_(&a), b_(&b), motion_(motion), pose_(motion.pose()), interrupted_(std::move(interrupted)) {}

  /// The enclosure of the distance at the moment that the certificate proves, as defined by PairChecker.
  [[nodiscard]] Enclosure at_moment(const PairCertificate& certificate) const;

  /// A lower bound of the distance at all times of the motion, proven by the certificate. Rounded down; may be
  /// negative.
  [[nodiscard]] double lower(const PairCertificate& certificate) const;

 private:
  using Section = PosedSections::Section;

  [[nodiscard]] bool share(const Point& x) const;
  [[nodiscard]] double upper(const std::array<Point, 2>& near_points) const;
  [[nodiscard]] double lower_by_spheres(std::size_t i, std::size_t j) const;
  [[nodiscard]] double lower_by(const DividedSeparation& separation) const;
  [[nodiscard]] bool ended() const { return interrupted_ && interrupted_(); }

  const SolidParts* a_;
  const SolidParts* b_;
  ShortMotion motion_;
  RigidMotion pose_;  ///< from the frame of model B to that of model A, at the moment
  Hook interrupted_;
};

}  // namespace verisq::verify
