/// The poses and sizes that a fit may choose, as boxes of parameters.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/fit/candidate_evaluation.hpp"
#include "verify/placement/pose_box.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {

using Parameters = std::vector<double>;

/// Parameters: a translation τ, a rotation vector ω, then every semi-axis that is an interval. With c the centre of the
/// implant's bounding box (sizes at the middle of their intervals) and the start x -> R0 x + t0, the implant is moved
/// by
///     x -> exp(ω) R0 (x - c) + (R0 c + t0) + τ.
class CandidateSpace {
 public:
  /// Throws Error(input) unless the implant is exact but, of a union of convex primitives, for its semi-axes.
  CandidateSpace(const UncertainModel& implant, const PoseRange& range);

  [[nodiscard]] const Parameters& lower() const { return lower_; }
  [[nodiscard]] const Parameters& upper() const { return upper_; }
  /// The start itself, sizes at the middle of their intervals.
  [[nodiscard]] Parameters start() const;
  /// A change of each parameter that moves the implant's surface by about one model unit.
  [[nodiscard]] const Parameters& units() const { return units_; }

  /// Where the implant's centre is.
  [[nodiscard]] Point pivot(std::span<const double> parameters) const;
  [[nodiscard]] Candidate candidate(std::span<const double> parameters) const;
  [[nodiscard]] Pose pose(std::span<const double> parameters) const;
  /// From the start, and where its range ends.
  [[nodiscard]] FitMovement movement(std::span<const double> parameters) const;
  /// The implant of these sizes in its own frame.
  [[nodiscard]] Model sized(std::span<const double> parameters) const;
  /// The parameters of the pose, or of the range the nearest to them; sizes at the middle of their intervals.
  [[nodiscard]] Parameters nearest(const Pose& pose) const;
  /// How the six parameters of the pose move the implant.
  [[nodiscard]] verify::PoseSpace pose_space() const;

  /// Derivatives by the parameters from those by the candidate, as in Evaluation.
  [[nodiscard]] Parameters gradient(std::span<const double> parameters, const std::array<double, 6>& by_pose,
                                    std::span<const std::array<double, 3>> by_size) const;
  /// The same for the distance of one point, a row of a Jacobian.
  void gradient(std::span<const double> parameters, const std::array<double, 6>& by_pose, const PointDistance& at,
                std::span<double> row) const;

 private:
  /// A semi-axis that is free.
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
  std::vector<Size> sizes_;
  Eigen::Quaterniond start_rotation_;
  Eigen::Vector3d centre_;        ///< of the implant, in its own frame
  Eigen::Vector3d start_centre_;  ///< where the start puts it
  double radius_;                 ///< of the bounding box
  Parameters lower_, upper_, units_;
};

}  // namespace verisq::fit_search
