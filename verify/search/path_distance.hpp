/// The smallest distance along a path.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>

#include "verify/proof/pair_checker.hpp"
#include "verify/search/mesh_union.hpp"
#include "verify/search/solid_pair_distance.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

// The questions about two models at the moments of a path.

/// A part of one leg. Both ends are exact binary64 numbers, and so is the middle of a stretch that may still be halved.
struct Stretch {
  std::size_t leg;
  double begin, end;         ///< times of the path
  double lower = -infinity;  ///< lower bound of the distance, at all its times

  [[nodiscard]] double middle() const { return 0.5 * (begin + end); }
  [[nodiscard]] double reach() const { return 0.5 * (end - begin); }
};

/// The bounds found at the middle of a stretch.
struct ExaminedStretch {
  double time;
  double lower;  ///< lower bound over the stretch
  double upper;  ///< upper bound at the middle; 0 if a common point is proven
};

/// Two models, one of which moves.
class PathMoments {
 public:
  PathMoments() = default;
  PathMoments(const PathMoments&) = delete;
  PathMoments& operator=(const PathMoments&) = delete;
  virtual ~PathMoments() = default;

  /// If the distance is proven to be more than `enough` at all times of the stretch, no closer bound is sought.
  [[nodiscard]] virtual ExaminedStretch examine(const Stretch& stretch, double enough) const = 0;
};

// Unions of convex primitives on their way: planes that stay between two primitives prove whole stretches of time
// (docs/mathematics.md §26).

class ConvexMoments : public PathMoments {
 public:
  /// B moves. Precondition: unions of convex primitives. The path must outlive this.
  ConvexMoments(const PosedPath& path, const Model& a, const Model& b) : path_(&path), a_(a), b_(b) {}

  /// Pairs whose distance is proven to be more than `enough` by their spheres are not looked at closer.
  [[nodiscard]] ExaminedStretch examine(const Stretch& stretch, double enough) const override;

 private:
  const PosedPath* path_;
  PosedPrimitives a_;
  PosedPrimitives b_;
};

// Any two models on their way: the distance at a moment and the speed of points prove a stretch of time
// (docs/mathematics.md §26).

/// One moment of a stretch.
struct MomentInStretch {
  double time;
  Pose pose;  ///< rounded
  RigidMotion exact;
  double off;  ///< no point of B lies farther from its place at the exact pose
  ShortMotion motion;
  PreciseInterval lost;  ///< no distance at another time of the stretch is smaller by more than this
  double by_balls;       ///< the lower end over the stretch that enclosing balls give

  /// The lower end over the stretch that one at the rounded pose gives.
  [[nodiscard]] double over_stretch(double at_moment) const {
    return (PreciseInterval(Real(at_moment)) - lost).lower().to_double(Direction::down);
  }
};

class SpeedMoments : public PathMoments {
 public:
  /// B moves. The path must outlive this.
  SpeedMoments(const PosedPath& path, const Model& a, const Model& b);

 protected:
  [[nodiscard]] MomentInStretch moment_of(const Stretch& stretch) const;

 private:
  /// Upper bound of the change of the distance between the moment and any time of the motion.
  [[nodiscard]] PreciseInterval change(const ShortMotion& motion) const;

  /// Upper bound of the displacement of a point of B from its place at the exact pose.
  [[nodiscard]] double displacement(const RigidMotion& exact, const RigidMotion& nearby) const;

  const PosedPath* path_;
  EnclosingSphere sphere_a_;
  EnclosingSphere sphere_b_;
};

/// Bent, or built by set operations: planes that stay between sections of primitives prove a stretch of time, too.
class SearchedMoments : public SpeedMoments {
 public:
  /// B moves. Distances are enclosed to a quarter of `tolerance` at best. `interrupted`, polled, ends searches. The
  /// path must outlive this.
  SearchedMoments(const PosedPath& path, const Model& a, const Model& b, double tolerance,
                  std::function<bool()> interrupted);

  [[nodiscard]] ExaminedStretch examine(const Stretch& stretch, double enough) const override;

 private:
  /// Returns whether a point of A is proven to lie in B, too, at the exact pose.
  [[nodiscard]] bool is_in_b(const Point& x, const RigidMotion& exact) const;

  PairSearch search_;
  ModelPair pair_;
  double tolerance_;
  std::function<bool()> interrupted_;
};

/// Unions with meshes.
class MeshMoments : public SpeedMoments {
 public:
  /// Throws as MeshPairDistance.
  MeshMoments(const PosedPath& path, const Model& a, const Model& b, std::function<bool()> interrupted)
      : SpeedMoments(path, a, b), distance_(a, b), interrupted_(std::move(interrupted)) {}

  [[nodiscard]] ExaminedStretch examine(const Stretch& stretch, double enough) const override;

 private:
  MeshPairDistance distance_;
  std::function<bool()> interrupted_;
};

}  // namespace verisq::verify
