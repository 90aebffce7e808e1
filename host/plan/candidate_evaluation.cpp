/// This file implements candidate_evaluation.hpp.
#include "host/plan/candidate_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>

#include "host/plan/primitive_projection.hpp"
#include "host/prepare/eigen_points.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "host/threads/parallel.hpp"
#include "verify/search/distance_field.hpp"
#include "verify/search/set_tree.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"

namespace verisq::fit_search {

namespace {

/// Points of a grid over a mesh's box, each way, and how many of those inside are kept.
constexpr int grid_points = 12;
constexpr std::size_t most_samples = 48;

template <class Item>
std::vector<Item> thinned(const std::vector<Item>& items, std::size_t most) {
  std::vector<Item> kept;
  const std::size_t stride = (items.size() + most - 1) / most;
  for (std::size_t i = 0; i < items.size(); i += stride) kept.push_back(items[i]);
  return kept;
}

/// A corner of each.
std::vector<Point> one_of_each_triangle(const Mesh& mesh) {
  std::vector<Point> corners;
  for (const auto& triangle : mesh.triangles) corners.push_back(mesh.vertices[triangle[0]]);
  return corners;
}

std::vector<Point> grid_over(const Mesh& mesh) {
  const Extent extent = extent_of(mesh.vertices);
  std::vector<Point> grid;
  const auto at = [&](int i, std::size_t axis) {
    const double share = (i + 0.5) / grid_points;
    return extent.lower[axis] + share * (extent.upper[axis] - extent.lower[axis]);
  };
  for (int i = 0; i < grid_points; ++i)
    for (int j = 0; j < grid_points; ++j)
      for (int k = 0; k < grid_points; ++k) grid.push_back({at(i, 0), at(j, 1), at(k, 2)});
  return grid;
}

}  // namespace

SolidMesh::SolidMesh(const Mesh& mesh) : solid(mesh) {
  const std::vector<Point> grid = grid_over(mesh);
  std::vector<verify::ClosedMesh::Distance> distances(grid.size());
  solid.signed_distances(grid, distances);
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (distances[i].side == verify::ClosedMesh::Side::inside) samples.push_back(grid[i]);
  if (samples.empty()) samples = one_of_each_triangle(mesh);
  samples = thinned(samples, most_samples);
}

namespace {

/// f rises to its target and falls beyond it: over [d - r, d + r] it is largest nearest to the target.
double largest_value(const Fitness& fitness, double distance, double radius) {
  return value(fitness, std::clamp(fitness.target, distance - radius, distance + radius));
}

}  // namespace

std::array<double, 6> pose_gradient(const Point& point, const Point& pivot, const Point& normal) {
  const auto& [nx, ny, nz] = normal;
  const double x = point[0] - pivot[0];
  const double y = point[1] - pivot[1];
  const double z = point[2] - pivot[2];
  return {-nx, -ny, -nz, z * ny - y * nz, x * nz - z * nx, y * nx - x * ny};
}

EvaluationSum::EvaluationSum(const Fitness& fitness, const Candidate& candidate, const PoseCell& cell)
    : fitness_(fitness),
      pivot_(candidate.pivot),
      cell_(cell),
      sum_{.objective = 0.0,
           .pose_gradient = {},
           .size_gradient = std::vector<std::array<double, 3>>(candidate.primitives.size()),
           .smallest_distance = infinity,
           .objective_bound = 0.0} {}

void EvaluationSum::add(const Point& point, double weight, const PointDistance& at) {
  sum_.objective += weight * value(fitness_, at.distance);
  sum_.smallest_distance = std::min(sum_.smallest_distance, at.distance);
  const double by_distance = weight * slope(fitness_, at.distance);
  const std::array<double, 6> by_pose = fit_search::pose_gradient(point, pivot_, at.normal);
  for (std::size_t i = 0; i < 6; ++i) sum_.pose_gradient[i] += by_distance * by_pose[i];
  for (std::size_t i = 0; i < 3; ++i) sum_.size_gradient[at.primitive][i] += by_distance * at.size_gradient[i];
  const double lever = std::hypot(point[0] - pivot_[0], point[1] - pivot_[1], point[2] - pivot_[2]);
  sum_.objective_bound += weight * largest_value(fitness_, at.distance, cell_.translation + cell_.rotation * lever);
}

void EvaluationSum::add(const EvaluationSum& other) {
  sum_.objective += other.sum_.objective;
  sum_.smallest_distance = std::min(sum_.smallest_distance, other.sum_.smallest_distance);
  sum_.objective_bound += other.sum_.objective_bound;
  for (std::size_t i = 0; i < 6; ++i) sum_.pose_gradient[i] += other.sum_.pose_gradient[i];
  for (std::size_t k = 0; k < sum_.size_gradient.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) sum_.size_gradient[k][i] += other.sum_.size_gradient[k][i];
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Points summed by one processor at a time: the sums are added in the order of the blocks.
constexpr std::size_t kBlock = 64;

class PlacedSolid {
 public:
  /// `mesh`: nothing for a superquadric.
  PlacedSolid(const Primitive& primitive, std::shared_ptr<const SolidMesh> mesh)
      : mesh_(std::move(mesh)), translation_(vector_of(primitive.pose.translation)) {
    if (!mesh_) projection_.emplace(primitive);
    rotation_ = verify::unit_quaternion(primitive.pose.quaternion).toRotationMatrix();
  }

  [[nodiscard]] Vector3d local(const Vector3d& p) const { return rotation_.transpose() * (p - translation_); }
  [[nodiscard]] double lower_bound(const Vector3d& local) const {
    return mesh_ ? -infinity : projection_->lower_bound(local);
  }

  [[nodiscard]] PointDistance distance(const Vector3d& local, std::uint32_t index) const {
    if (mesh_) {
      const verify::ClosedMesh::Distance found = mesh_->solid.signed_distance(point_of(local));
      return {middle(found.signed_distance), point_of(rotation_ * vector_of(found.normal)), index, {}};
    }
    const Projection found = (*projection_)(local);
    return {found.distance, point_of(rotation_ * found.normal), index, point_of(projection_->size_gradient(found))};
  }

 private:
  static double middle(const Enclosure& distance) { return std::midpoint(distance.lo, distance.hi); }

  std::shared_ptr<const SolidMesh> mesh_;
  std::optional<PrimitiveProjection> projection_;  ///< unless there is a mesh
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
  explicit PlacedSet(const Candidate& candidate) : set_(candidate.set) {
    for (std::size_t k = 0; k < candidate.primitives.size(); ++k)
      solids_.emplace_back(candidate.primitives[k], candidate.meshes.empty() ? nullptr : candidate.meshes[k]);
    if (!set_) set_ = std::make_shared<const SetNode>(verify::normal_form({"", candidate.primitives}, Side::inside));
  }

  [[nodiscard]] PointDistance distance(const Point& at) const {
    return distance(*set_, vector_of(at), -infinity, infinity);
  }

 private:
  using SetNode = verify::SetNode;
  using Side = verify::Side;

  /// Exact if the distance lies between the two; else any number on the same side of them, by a box alone.
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

namespace {

constexpr double kTolerance = 1e-9;
/// The tolerance of searched distances.
constexpr double kSearchedTolerance = 1e-6;

/// A wide enclosure, by an interruption or at the limits of the methods, leaves `known` unchanged.
void take_if_narrow(double& known, const Enclosure& found, double tolerance) {
  if (found.width() <= 10.0 * tolerance) known = std::midpoint(found.lo, found.hi);
}

void map_all(const Model& posed, const Cavity& cavity, const std::string& device,
             const std::function<bool()>& interrupted, std::vector<double>& known) {
  const double tolerance = kSearchedTolerance * bounding_radius(posed);
  std::size_t row = 0;
  std::size_t asked = 0;
  PointMapper mapper(posed, {.tolerance = tolerance, .device = device, .interrupted = interrupted});
  mapper.map(
      [&](std::span<Point> points) {
        const std::size_t count = std::min(points.size(), cavity.points.size() - asked);
        std::copy_n(cavity.points.begin() + static_cast<std::ptrdiff_t>(asked), count, points.begin());
        asked += count;
        return count;
      },
      [&](std::span<const Point>, std::span<const MapResult> rows, std::span<const Certificate>) {
        for (const MapResult& found : rows) take_if_narrow(known[row++], found.distance, tolerance);
      });
}

void prove_inside(const Model& posed, const Cavity& cavity, const std::function<bool()>& interrupted,
                  std::vector<double>& known) {
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (known[i] < 0.0) inside.push_back(i);
  std::mutex polling;
  const auto poll = [&] {
    const std::lock_guard lock(polling);
    return interrupted();
  };
  const SignedDistance signed_distance(posed);
  const double tolerance = kTolerance * bounding_radius(posed);
  in_parallel(inside.size(), [&](std::size_t n) {
    take_if_narrow(known[inside[n]], signed_distance(cavity.points[inside[n]], tolerance, poll), tolerance);
  });
}

}  // namespace

UnionDepth union_depth(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                       std::span<const PointDistance> distances, const std::string& device,
                       const std::function<bool()>& interrupted) {
  std::vector<double> known;
  known.reserve(distances.size());
  for (const PointDistance& at : distances) known.push_back(at.distance);
  if (!is_union_of_convex(posed)) {
    map_all(posed, cavity, device, interrupted, known);
  } else if (posed.primitives.size() > 1) {
    prove_inside(posed, cavity, interrupted, known);
  }
  UnionDepth result{0.0, 0.0};
  for (std::size_t i = 0; i < known.size(); ++i) {
    result.objective += cavity.areas[cavity.area_of[i]].weight * value(fitness, known[i]);
    result.deepest_penetration = std::max(result.deepest_penetration, -known[i]);
  }
  return result;
}

}  // namespace verisq::fit_search
