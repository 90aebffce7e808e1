/// A convex primitive in the frame of another model, wherever it is in a short time: what a cover goes around.
#pragma once

#include "verify/pairs/short_motion.hpp"
#include "verify/proof/empty_neighbourhood.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/support_mapping.hpp"

namespace verisq::verify {

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
  std::array<Plain, 3> rows_;      ///< of the rotation, about
};

}  // namespace verisq::verify
