/// Every pair of primitives of two models, one of which is moved by a pose.
#pragma once

#include <vector>

#include "verify/proof/pair_bounds.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// The primitives of a model with their motions into its frame.
struct PosedPrimitives {
  explicit PosedPrimitives(const Model& model);

  std::vector<PosedSuperquadric> primitives;
  std::vector<RigidMotion> motions;          ///< primitive's frame to model's
  std::vector<RigidMotion> inverse_motions;  ///< model's frame to primitive's
};

/// A and B moved. Both models must outlive this.
class PosedPairs {
 public:
  PosedPairs(const PosedPrimitives& a, const PosedPrimitives& b, const Pose& pose)
      : PosedPairs(a, b, RigidMotion(pose)) {}
  PosedPairs(const PosedPrimitives& a, const PosedPrimitives& b, const RigidMotion& motion);

  /// Precondition: i and j are indices of primitives of A and of B.
  [[nodiscard]] PairBounds operator()(std::size_t i, std::size_t j) const {
    return {a_->primitives[i], b_->primitives[j], a_->inverse_motions[i].after(moved_[j])};
  }

  /// d >= |c| - r_A - r_B with the radii of spheres about the centres. Rounded down to binary64.
  [[nodiscard]] double lower_by_spheres(std::size_t i, std::size_t j) const;

  [[nodiscard]] std::size_t size_a() const { return a_->primitives.size(); }
  [[nodiscard]] std::size_t size_b() const { return b_->primitives.size(); }

  /// Of spheres about the primitives' centres that contain them.
  [[nodiscard]] const PreciseInterval& radius_a(std::size_t i) const { return a_->primitives[i].radius(); }
  [[nodiscard]] const PreciseInterval& radius_b(std::size_t j) const { return b_->primitives[j].radius(); }

  /// From a primitive's own frame to that of model A.
  [[nodiscard]] const RigidMotion& motion_a(std::size_t i) const { return a_->motions[i]; }
  [[nodiscard]] const RigidMotion& motion_b(std::size_t j) const { return moved_[j]; }

  /// Whether the point of A's frame is proven to lie in both models.
  [[nodiscard]] bool share(const Point& x) const;

 private:
  const PosedPrimitives* a_;
  const PosedPrimitives* b_;
  std::vector<RigidMotion> moved_;  ///< from the frame of B's primitives to A's model frame
};

}  // namespace verisq::verify
