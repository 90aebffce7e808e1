/// Signed distances of all points to posed implants, shared among the processors.
#include "host/fit/host_evaluator.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>

#include "host/fit/evaluation_sum.hpp"
#include "host/fit/primitive_projection.hpp"
#include "host/mesh/eigen_points.hpp"
#include "host/threads/parallel.hpp"
#include "verify/sets/set_tree.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Points summed by one processor at a time: the sums are added in the order of the blocks.
constexpr std::size_t kBlock = 64;

class PlacedSolid {
 public:
  explicit PlacedSolid(const Primitive& primitive)
      : projection_(primitive), translation_(vector_of(primitive.pose.translation)) {
    const auto& [w, x, y, z] = primitive.pose.quaternion;
    rotation_ = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  }

  [[nodiscard]] Vector3d local(const Vector3d& p) const { return rotation_.transpose() * (p - translation_); }
  [[nodiscard]] double lower_bound(const Vector3d& local) const { return projection_.lower_bound(local); }

  [[nodiscard]] PointDistance distance(const Vector3d& local, std::uint32_t index) const {
    const Projection found = projection_(local);
    return {found.distance, point_of(rotation_ * found.normal), index, point_of(projection_.size_gradient(found))};
  }

 private:
  PrimitiveProjection projection_;
  Vector3d translation_;
  Matrix3d rotation_;
};

PointDistance turned_over(PointDistance at) {
  at.distance = -at.distance;
  for (double& component : at.normal) component = -component;
  for (double& component : at.size_gradient) component = -component;
  return at;
}

/// The candidate's set, with distances as PointDistance has them.
class PlacedSet {
 public:
  explicit PlacedSet(const Candidate& candidate)
      : solids_(candidate.primitives.begin(), candidate.primitives.end()), set_(candidate.set) {
    if (!set_) set_ = std::make_shared<const SetNode>(verify::normal_form({"", candidate.primitives}, Side::inside));
  }

  [[nodiscard]] PointDistance distance(const Point& at) const {
    return distance(*set_, vector_of(at), -infinity, infinity);
  }

 private:
  using SetNode = verify::SetNode;
  using Side = verify::Side;

  /// Exactly where it lies between the two; else any number on the same side of them, by a box alone.
  [[nodiscard]] PointDistance distance(const SetNode& set, const Vector3d& p, double above, double below) const {
    switch (set.kind) {
      case SetNode::Kind::leaf: break;
      case SetNode::Kind::union_of: return least(set, p, above, below);
      case SetNode::Kind::intersection_of: return greatest(set, p, above, below);
    }
    const PlacedSolid& solid = solids_[set.primitive];
    const Vector3d local = solid.local(p);
    const double bound = solid.lower_bound(local);
    if (set.side == Side::inside) {
      return bound >= below ? PointDistance{bound, {}, set.primitive, {}} : solid.distance(local, set.primitive);
    }
    if (-bound <= above) return {-bound, {}, set.primitive, {}};
    return turned_over(solid.distance(local, set.primitive));
  }

  [[nodiscard]] PointDistance least(const SetNode& set, const Vector3d& p, double above, double below) const {
    const std::size_t first = most_promising(set.operands, p);
    PointDistance nearest = distance(set.operands[first], p, above, below);
    for (std::size_t k = 0; k < set.operands.size() && nearest.distance > above; ++k) {
      if (k == first) continue;
      const PointDistance other = distance(set.operands[k], p, above, std::min(below, nearest.distance));
      if (other.distance < nearest.distance) nearest = other;
    }
    return nearest;
  }

  [[nodiscard]] PointDistance greatest(const SetNode& set, const Vector3d& p, double above, double below) const {
    PointDistance farthest = distance(set.operands.front(), p, above, below);
    for (std::size_t k = 1; k < set.operands.size() && farthest.distance < below; ++k) {
      const PointDistance other = distance(set.operands[k], p, std::max(above, farthest.distance), below);
      if (other.distance > farthest.distance) farthest = other;
    }
    return farthest;
  }

  /// The primitive whose box is nearest; the first operand where there are none.
  [[nodiscard]] std::size_t most_promising(const std::vector<SetNode>& operands, const Vector3d& p) const {
    std::size_t best = 0;
    double least = infinity;
    for (std::size_t k = 0; k < operands.size(); ++k) {
      if (operands[k].kind != SetNode::Kind::leaf || operands[k].side != Side::inside) continue;
      const PlacedSolid& solid = solids_[operands[k].primitive];
      const double bound = solid.lower_bound(solid.local(p));
      if (bound < least) {
        least = bound;
        best = k;
      }
    }
    return best;
  }

  std::vector<PlacedSolid> solids_;
  std::shared_ptr<const SetNode> set_;
};

class HostEvaluator final : public CandidateEvaluator {
 public:
  HostEvaluator(std::span<const Point> points, std::span<const double> weights)
      : points_(points.begin(), points.end()), weights_(weights.begin(), weights.end()) {}

  void evaluate(std::span<const Candidate> candidates, const Fitness& fitness, const PoseCell& cell, std::size_t stride,
                std::vector<Evaluation>& evaluations) override {
    const std::size_t used = (points_.size() + stride - 1) / stride;
    const std::size_t blocks = (used + kBlock - 1) / kBlock;
    const std::vector<PlacedSet> sets(candidates.begin(), candidates.end());
    std::vector<EvaluationSum> sums;
    sums.reserve(blocks * candidates.size());
    for (const Candidate& candidate : candidates) sums.insert(sums.end(), blocks, {fitness, candidate, cell});
    in_parallel(sums.size(), [&](std::size_t n) {
      const PlacedSet& placed = sets[n / blocks];
      const std::size_t first = n % blocks * kBlock;
      for (std::size_t i = first; i < std::min(first + kBlock, used); ++i)
        sums[n].add(points_[i * stride], weights_[i * stride], placed.distance(points_[i * stride]));
    });
    evaluations.clear();
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      EvaluationSum& sum = sums[c * blocks];
      for (std::size_t b = 1; b < blocks; ++b) sum.add(sums[c * blocks + b]);
      evaluations.push_back(sum.result());
    }
  }

  void distances(const Candidate& candidate, std::vector<PointDistance>& distances) override {
    const PlacedSet placed(candidate);
    distances.resize(points_.size());
    in_parallel((points_.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      const std::size_t first = block * kBlock;
      for (std::size_t i = first; i < std::min(first + kBlock, points_.size()); ++i)
        distances[i] = placed.distance(points_[i]);
    });
  }

 private:
  std::vector<Point> points_;
  std::vector<double> weights_;
};

}  // namespace

std::unique_ptr<CandidateEvaluator> host_candidate_evaluator(std::span<const Point> points,
                                                             std::span<const double> weights) {
  return std::make_unique<HostEvaluator>(points, weights);
}

}  // namespace verisq::fit_search
