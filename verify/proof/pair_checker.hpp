/// Proves distances of two models again: the parts of a proof for a pair, the bounds that it gives, its checker.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/solid_pair.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

class MeshPairChecker;

// Bounds of the distance of two convex solids, at rest and in motion.

// Two posed superquadrics A and B in A's own frame, and the bounds that one evaluation proves about their distance.

/// x / max(1, g(x)), with g rounded up: a point of the solid.
[[nodiscard]] inline PreciseVector moved_into(const SuperquadricBounds<Real>& solid, const PreciseVector& x) {
  const Real gauge = solid.gauge_up(x);
  return gauge > Real(1) ? PreciseVector(x / PreciseInterval(gauge)) : x;
}

/// Bounds of the distance of A and B (docs/mathematics.md §7), each by a single evaluation in 127-bit interval
/// arithmetic. Points of B are stated in B's own frame, all else in A's. The solids must outlive this.
class PairBounds {
 public:
  /// `relative` leads from B's own frame to A's.
  PairBounds(const PosedSuperquadric& a, const PosedSuperquadric& b, const RigidMotion& relative)
      : a_(&a), b_(&b), relative_(relative) {}

  [[nodiscard]] const PosedSuperquadric& a() const { return *a_; }
  [[nodiscard]] const PosedSuperquadric& b() const { return *b_; }
  [[nodiscard]] const RigidMotion& relative() const { return relative_; }

  /// d >= (v·c - h_A(v) - h_B(R^T v)) / |v| for every v other than 0: A lies in {v·x <= h_A(v)}, B in
  /// {v·x >= v·c - h_B(R^T v)}. Rounded down.
  [[nodiscard]] Real lower_by_vector(const PreciseVector& v) const {
    const PreciseVector w = relative_.rotation.transpose() * v;
    const PreciseInterval supports =
        PreciseInterval(a_->bounds().support_up(v)) + PreciseInterval(b_->bounds().support_up(-w));
    const PreciseInterval gap = v.dot(relative_.translation) - supports;
    return (gap / length<Real>(v)).lower();
  }

  /// d <= |c + R b / max(1, g_B(b)) - a / max(1, g_A(a))|, because both points are in their solids. Rounded up.
  [[nodiscard]] Real upper_by_points(const PreciseVector& on_a, const PreciseVector& on_b) const {
    const PreciseVector a = moved_into(a_->bounds(), on_a);
    const PreciseVector b = relative_(moved_into(b_->bounds(), on_b));
    return length<Real>(PreciseVector(b - a)).upper();
  }

  /// Both ends rounded outward to binary64; -infinity and infinity for a zero or non-finite vector and for non-finite
  /// points. The lower end may be negative.
  [[nodiscard]] Enclosure distance(const Separation& separation) const;

 private:
  const PosedSuperquadric* a_;
  const PosedSuperquadric* b_;
  RigidMotion relative_;
};

// Every pair of primitives of two models, one of which is moved by a pose.

/// The primitives of a model with their motions into its frame.
struct PosedPrimitives {
  explicit PosedPrimitives(const Model& model) : primitives(model.primitives.begin(), model.primitives.end()) {
    for (const PosedSuperquadric& primitive : primitives) {
      motions.push_back(primitive.motion());
      inverse_motions.push_back(motions.back().inverse());
    }
  }

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

  /// The radii of spheres about the primitives' centres that contain the primitives.
  [[nodiscard]] const PreciseInterval& radius_a(std::size_t i) const { return a_->primitives[i].radius(); }
  [[nodiscard]] const PreciseInterval& radius_b(std::size_t j) const { return b_->primitives[j].radius(); }

  /// The motion from a primitive's own frame to the frame of model A.
  [[nodiscard]] const RigidMotion& motion_a(std::size_t i) const { return a_->motions[i]; }
  [[nodiscard]] const RigidMotion& motion_b(std::size_t j) const { return moved_[j]; }

  /// Returns whether the point of A's frame is proven to lie in both models.
  [[nodiscard]] bool share(const Point& x) const;

 private:
  const PosedPrimitives* a_;
  const PosedPrimitives* b_;
  std::vector<RigidMotion> moved_;  ///< from the frame of B's primitives to A's model frame
};

// The primitives of two models, one of which moves for a short time: bounds by single evaluations.

/// Model B moves. All lower bounds hold at all times of its short motion. The models must outlive this.
class MovingPairs {
 public:
  MovingPairs(const PosedPrimitives& a, const PosedPrimitives& b, const ShortMotion& motion)
      : a_(&a), b_(&b), motion_(motion), pairs_(a, b, motion.pose()) {}

  /// The pairs at the moment.
  [[nodiscard]] const PosedPairs& pairs() const { return pairs_; }

  /// A lower bound of the distance of two primitives, by the spheres about them. Rounded down; may be negative.
  [[nodiscard]] double lower_by_spheres(std::size_t i, std::size_t j) const;

  /// A lower bound by any direction in the frame of A's primitive, best from A to B; -infinity for a direction that is
  /// zero or not finite.
  [[nodiscard]] double lower_by_vector(std::size_t i, std::size_t j, const Point& vector) const;

 private:
  const PosedPrimitives* a_;
  const PosedPrimitives* b_;
  ShortMotion motion_;
  PosedPairs pairs_;
};

// Checks of the distance of two models, at rest and along a path.

/// Convex primitives by their support functions and gauges, models with meshes by their triangles, all others by
/// sections and places. Immutable.
class ModelPair {
 public:
  ModelPair(const Model& a, const Model& b);

  /// Like PairChecker::prove, with B moved by `pose`.
  [[nodiscard]] Enclosure distance(const RigidMotion& pose, const PairCertificate& certificate,
                                   const Hook& interrupted = {}) const;

  /// The distance is no less at any time of B's motion. Rounded down; at least 0, and 0 once interrupted.
  [[nodiscard]] double lower(const ShortMotion& motion, const PairCertificate& certificate,
                             const Hook& interrupted = {}) const;

 private:
  template <class Parts>
  struct Two {
    Parts a, b;
  };
  using Convex = Two<PosedPrimitives>;
  using Solids = Two<SolidParts>;
  using Meshes = std::shared_ptr<const MeshPairChecker>;

  static std::variant<Convex, Solids, Meshes> models_of(const Model& a, const Model& b);

  std::variant<Convex, Solids, Meshes> models_;
};

}  // namespace verisq::verify
