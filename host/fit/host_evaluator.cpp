/// Signed distances of all points to posed unions, shared among the processors.
#include "host/fit/host_evaluator.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "host/fit/evaluation_sum.hpp"
#include "host/fit/primitive_projection.hpp"
#include "host/mesh/eigen_points.hpp"
#include "host/threads/parallel.hpp"
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
      : projection_(primitive.superquadric),
        semi_axes_(vector_of(primitive.superquadric.semi_axes)),
        translation_(vector_of(primitive.pose.translation)) {
    const auto& [w, x, y, z] = primitive.pose.quaternion;
    rotation_ = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  }

  [[nodiscard]] Vector3d local(const Vector3d& p) const { return rotation_.transpose() * (p - translation_); }
  [[nodiscard]] double lower_bound(const Vector3d& local) const { return projection_.lower_bound(local); }

  [[nodiscard]] PointDistance distance(const Vector3d& local, std::uint32_t index) const {
    const Projection found = projection_(local);
    const Vector3d by_size = -found.normal.cwiseProduct(found.nearest).cwiseQuotient(semi_axes_);
    return {found.distance, point_of(rotation_ * found.normal), index, point_of(by_size)};
  }

 private:
  PrimitiveProjection projection_;
  Vector3d semi_axes_;
  Vector3d translation_;
  Matrix3d rotation_;
};

/// The primitives of a candidate. The least of their signed distances is that of the union outside; inside an overlap
/// the union may be deeper.
class PlacedUnion {
 public:
  explicit PlacedUnion(const Candidate& candidate)
      : solids_(candidate.primitives.begin(), candidate.primitives.end()) {}

  [[nodiscard]] PointDistance distance(const Point& at) const {
    const Vector3d p = vector_of(at);
    const std::size_t first = most_promising(p);
    PointDistance nearest = solids_[first].distance(solids_[first].local(p), static_cast<std::uint32_t>(first));
    for (std::size_t k = 0; k < solids_.size(); ++k) {
      const Vector3d local = solids_[k].local(p);
      if (k == first || solids_[k].lower_bound(local) >= nearest.distance) continue;
      const PointDistance other = solids_[k].distance(local, static_cast<std::uint32_t>(k));
      if (other.distance < nearest.distance) nearest = other;
    }
    return nearest;
  }

 private:
  [[nodiscard]] std::size_t most_promising(const Vector3d& p) const {
    std::size_t best = 0;
    double least = infinity;
    for (std::size_t k = 0; k < solids_.size(); ++k) {
      const double bound = solids_[k].lower_bound(solids_[k].local(p));
      if (bound < least) {
        least = bound;
        best = k;
      }
    }
    return best;
  }

  std::vector<PlacedSolid> solids_;
};

class HostEvaluator final : public CandidateEvaluator {
 public:
  HostEvaluator(std::span<const Point> points, std::span<const double> weights)
      : points_(points.begin(), points.end()), weights_(weights.begin(), weights.end()) {}

  void evaluate(std::span<const Candidate> candidates, const Fitness& fitness, const PoseCell& cell, std::size_t stride,
                std::vector<Evaluation>& evaluations) override {
    const std::size_t used = (points_.size() + stride - 1) / stride;
    const std::size_t blocks = (used + kBlock - 1) / kBlock;
    const std::vector<PlacedUnion> unions(candidates.begin(), candidates.end());
    std::vector<EvaluationSum> sums;
    sums.reserve(blocks * candidates.size());
    for (const Candidate& candidate : candidates) sums.insert(sums.end(), blocks, {fitness, candidate, cell});
    in_parallel(sums.size(), [&](std::size_t n) {
      const PlacedUnion& placed = unions[n / blocks];
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
    const PlacedUnion placed(candidate);
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
