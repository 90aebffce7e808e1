/// F of Eq. (4), its derivatives and its bound over a cell of poses, summed point by point.
#pragma once

#include "host/fit/candidate_evaluation.hpp"

namespace verisq::fit_search {

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

/// How the distance of a point changes with the pose, as in Evaluation::pose_gradient: where the implant moves by τ and
/// turns by ω, the point moves by -τ - ω x (point - pivot) as seen from the implant.
[[nodiscard]] std::array<double, 6> pose_gradient(const Point& point, const Point& pivot, const Point& normal);

}  // namespace verisq::fit_search
