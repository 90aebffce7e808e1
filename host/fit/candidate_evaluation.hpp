/// What the search of a fit asks for: the objective of many candidates at once, and the distances of one.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "verify/sets/set_tree.hpp"
#include "verisq/cavity.hpp"
#include "verisq/fitness.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

/// An implant posed and sized, in the coordinates of the cavity. Rotations are taken about the pivot.
struct Candidate {
  std::vector<Primitive> primitives;  ///< as many in each candidate
  Point pivot;
  std::shared_ptr<const verify::SetNode> set = {};  ///< of the primitives; nothing: their union
};

/// F over the points asked for, and how it changes with the candidate, to nearest.
struct Evaluation {
  double objective;
  std::array<double, 6> pose_gradient;  ///< by a translation (x, y, z) and by a rotation vector about the pivot
  std::vector<std::array<double, 3>> size_gradient;  ///< by the semi-axes of each primitive
  double smallest_distance;
  double objective_bound;  ///< no candidate within the cell of poses around this one has more (but for rounding)
};

/// The cell of poses around a candidate: translations of the pivot by at most `translation`, rotations about it by at
/// most `rotation` radians. Its points' distances differ by at most translation + rotation times distance to the pivot.
struct PoseCell {
  double translation = 0.0;
  double rotation = 0.0;
};

/// The signed distance of one point, and its derivatives.
struct PointDistance {
  /// To the union; inside, minus the largest depth in a primitive: overlaps are deeper. Of other sets: unions take the
  /// least of their operands' distances, intersections the greatest, and what is removed counts with its sign turned.
  /// The sign is that of the set; near its edges it may be farther than that, and deeper, never nearer.
  double distance;
  Point normal;             ///< gradient by the point, a unit vector
  std::uint32_t primitive;  ///< that decides
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

  /// Of every point.
  virtual void distances(const Candidate& candidate, std::vector<PointDistance>& distances) = 0;
};

using MakeEvaluator = std::function<std::unique_ptr<CandidateEvaluator>(const Cavity&)>;

}  // namespace verisq::fit_search
