/// Candidates of a fit: the space of poses and sizes, and the evaluation of single candidates.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "verify/search/closed_mesh.hpp"
#include "verify/search/distance_field.hpp"
#include "verify/search/set_tree.hpp"
#include "verisq/clearance.hpp"
#include "verisq/fit.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

// The evaluation of a candidate of a fit: distances of the cavity's points to it, and sums of them.

// The functions that the search of a fit calls: the objective of many candidates at once, and the distances of one.

/// A part of an implant that is a closed mesh, in its own frame: made once, for all candidates.
struct SolidMesh {
  explicit SolidMesh(const Mesh& mesh);

  verify::ClosedMesh solid;
  std::vector<Point> samples;  ///< points of it, about evenly inside where it is thick enough; at least one
};

/// An implant posed and sized, in the coordinates of the cavity. Rotations are about the pivot.
struct Candidate {
  std::vector<Primitive> primitives;  ///< as many in each candidate as in the others
  Point pivot;
  std::shared_ptr<const verify::SetNode> set = {};            ///< of the primitives; nothing: their union
  std::vector<std::shared_ptr<const SolidMesh>> meshes = {};  ///< of the primitives that are meshes; none: of no one
};

/// F over the chosen points, and its derivatives by the candidate, to nearest.
struct Evaluation {
  double objective;
  std::array<double, 6> pose_gradient;  ///< by a translation (x, y, z) and by a rotation vector about the pivot
  std::vector<std::array<double, 3>> size_gradient;  ///< by the semi-axes of each primitive
  double smallest_distance;
  double objective_bound;  ///< no candidate within the cell of poses around this one has a larger objective (but for
                           ///< rounding)
};

/// The cell of poses around a candidate: translations of the pivot by at most `translation`, rotations about it by at
/// most `rotation` radians. Its points' distances differ by at most translation + rotation times distance to the pivot.
struct PoseCell {
  double translation = 0.0;
  double rotation = 0.0;
};

/// The signed distance of one point, and its derivatives.
struct PointDistance {
  /// The distance to the union; inside, minus the largest depth in a primitive: overlaps are deeper. For other sets:
  /// unions take the least of their operands' distances, intersections the greatest, and a removed operand counts with
  /// its sign turned. The sign is that of the set. Near the set's edges the exact distance may be larger in magnitude,
  /// outside and inside, never smaller.
  double distance;
  Point normal;             ///< gradient by the point, a unit vector
  std::uint32_t primitive;  ///< the primitive that decides
  Point size_gradient;      ///< of the distance by this primitive's semi-axes
};

/// Points and weights are given at construction. One call at a time.
class CandidateEvaluator {
 public:
  CandidateEvaluator() = default;
  virtual ~CandidateEvaluator() = default;
  CandidateEvaluator(const CandidateEvaluator&) = delete;
  CandidateEvaluator& operator=(const CandidateEvaluator&) = delete;

  /// Sums over the points 0, stride, 2 stride, ..., each with its weight: a thinned cavity for the global start.
  virtual void evaluate(std::span<const Candidate> candidates, const Fitness& fitness, const PoseCell& cell,
                        std::size_t stride, std::vector<Evaluation>& evaluations) = 0;

  /// The distances of every point.
  virtual void distances(const Candidate& candidate, std::vector<PointDistance>& distances) = 0;
};

using MakeEvaluator = std::function<std::unique_ptr<CandidateEvaluator>(const Cavity&)>;

// F of Eq. (4), its derivatives and its bound over a cell of poses, summed point by point.

/// The order of the additions decides the last digits: same order, same result.
class EvaluationSum {
 public:
  EvaluationSum(const Fitness& fitness, const Candidate& candidate, const PoseCell& cell = {});

  void add(const Point& point, double weight, const PointDistance& at);
  void add(const EvaluationSum& other);

  [[nodiscard]] const Evaluation& result() const { return sum_; }

 private:
  Fitness fitness_;
  Point pivot_;
  PoseCell cell_;
  Evaluation sum_;
};

/// The change of a point's distance with the pose, as in Evaluation::pose_gradient. If the implant moves by τ and turns
/// by ω, the point moves by -τ - ω x (point - pivot) as seen from the implant.
[[nodiscard]] std::array<double, 6> pose_gradient(const Point& point, const Point& pivot, const Point& normal);

// Evaluates candidates on the host alone, for `--device host` and if no device is usable.

/// An evaluator on all processors; the same call gives the same bits again, on any number of processors. Precondition:
/// at least one point, as many weights; finite; weights >= 0.
[[nodiscard]] std::unique_ptr<CandidateEvaluator> host_candidate_evaluator(std::span<const Point> points,
                                                                           std::span<const double> weights);

// Depths inside the union of an implant's primitives: in their overlaps the union is deeper than each of them.
// Distances to sets at whose edges the search's distances are too small.

struct UnionDepth {
  double objective;            ///< F
  double deepest_penetration;  ///< >= 0
};

/// `distances` are the search's distances of every point to the posed implant. For points inside they are replaced by
/// the union's distances, proven to about 1e-9 of the implant's radius. For bent implants and other sets all distances
/// are replaced, by a map on `device`, to about 1e-6 of the radius. `interrupted` is polled by many threads in turn;
/// afterwards the search's distances stay.
[[nodiscard]] UnionDepth union_depth(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                                     std::span<const PointDistance> distances, const std::string& device,
                                     const std::function<bool()>& interrupted);

// The space that a fit searches: its checked problem; poses and sizes as parameters; the best candidate so far.

// Refuses problems that no search of poses can solve.

/// Throws Error(input) for an empty cavity, points that are not finite, and numbers out of the ranges that FitOptions
/// defines.
void check_fit_problem(const Cavity& cavity, const Fitness& fitness, double penetration_limit, const PoseRange& range);

// The poses and sizes that a fit may choose, as boxes of parameters.

using Parameters = std::vector<double>;

/// Parameters: a translation τ, a rotation vector ω, then every semi-axis that is an interval. Let c be the centre of
/// the implant's bounding box (sizes at the middle of their intervals) and x -> R0 x + t0 the start. The implant is
/// moved by
///     x -> exp(ω) R0 (x - c) + (R0 c + t0) + τ.
class CandidateSpace {
 public:
  /// Throws Error(input) unless the implant is exact. Only the semi-axes of a union of convex primitives may be
  /// intervals.
  CandidateSpace(const UncertainModel& implant, const PoseRange& range);

  [[nodiscard]] const Parameters& lower() const { return lower_; }
  [[nodiscard]] const Parameters& upper() const { return upper_; }
  /// The start itself, sizes at the middle of their intervals.
  [[nodiscard]] Parameters start() const;
  /// A change of each parameter that moves the implant's surface by about one model unit.
  [[nodiscard]] const Parameters& units() const { return units_; }

  /// The place of the implant's centre.
  [[nodiscard]] Point pivot(std::span<const double> parameters) const;
  [[nodiscard]] Candidate candidate(std::span<const double> parameters) const;
  [[nodiscard]] Pose pose(std::span<const double> parameters) const;
  /// The movement from the start, with the ends of its range.
  [[nodiscard]] FitMovement movement(std::span<const double> parameters) const;
  /// The implant of these sizes in its own frame.
  [[nodiscard]] Model sized(std::span<const double> parameters) const;
  /// The parameters of the pose, or the nearest ones in the range; sizes at the middle of their intervals.
  [[nodiscard]] Parameters nearest(const Pose& pose) const;
  /// The space of the implant's motions by the six parameters of the pose.
  [[nodiscard]] verify::PoseSpace pose_space() const;

  /// Derivatives by the parameters from those by the candidate, as in Evaluation.
  [[nodiscard]] Parameters gradient(std::span<const double> parameters, const std::array<double, 6>& by_pose,
                                    std::span<const std::array<double, 3>> by_size) const;
  /// The same for the distance of one point, a row of a Jacobian.
  void gradient(std::span<const double> parameters, const std::array<double, 6>& by_pose, const PointDistance& at,
                std::span<double> row) const;

 private:
  /// A free semi-axis.
  struct Size {
    std::size_t primitive;
    std::size_t axis;
  };

  [[nodiscard]] std::string name(std::size_t parameter) const;
  void bound_pose(const PoseRange& range);
  void bound_sizes(const UncertainModel& implant);
  void write_pose_gradient(std::span<const double> parameters, const std::array<double, 6>& by_pose,
                           std::span<double> row) const;
  [[nodiscard]] Eigen::Quaterniond rotation(std::span<const double> parameters) const;

  Model middle_;  ///< sizes at the middle of their intervals
  std::shared_ptr<const verify::SetNode> set_;
  std::vector<std::shared_ptr<const SolidMesh>> meshes_;  ///< as Candidate::meshes
  std::vector<Size> sizes_;
  Eigen::Quaterniond start_rotation_;
  Eigen::Vector3d centre_;        ///< the implant's centre, in its own frame
  Eigen::Vector3d start_centre_;  ///< the place of the centre in the start pose
  double radius_;                 ///< radius of the bounding box
  Parameters lower_, upper_, units_;
};

// The best candidate of an implant so far, kept for when the caller interrupts.

/// A candidate evaluated at every point of the cavity.
struct Found {
  Parameters parameters;
  double objective;
  double deepest_penetration;  ///< >= 0
  bool within_limit;
  double broken;       ///< how far other requirements are broken, as Requirements counts
  double apart = 0.0;  ///< the missing shares of contact
};

/// Better means, in this order: fewer broken requirements; within the limit; beyond it, the shallower penetration; less
/// missing contact, which no bone may be sacrificed for; a larger objective.
[[nodiscard]] inline bool better(const Found& a, const Found& b) {
  if (a.broken != b.broken) return a.broken < b.broken;
  if (a.within_limit != b.within_limit) return a.within_limit;
  if (!a.within_limit && a.deepest_penetration != b.deepest_penetration)
    return a.deepest_penetration < b.deepest_penetration;
  if (a.apart != b.apart) return a.apart < b.apart;
  return a.objective > b.objective;
}

class Incumbent {
 public:
  /// If two candidates are equal, the earlier stays.
  void offer(const Found& found) {
    if (!best_ || better(found, *best_)) best_ = found;
  }
  [[nodiscard]] const std::optional<Found>& best() const { return best_; }

 private:
  std::optional<Found> best_;
};

}  // namespace verisq::fit_search
