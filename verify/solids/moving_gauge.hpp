/// The gauge of a primitive on a leg of its way, in floating point: the time at which it is least at a point, and its
/// value and gradient at a time. Proposes, proves nothing.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "verify/numbers/norms.hpp"
#include "verify/solids/paths.hpp"

namespace verisq::verify {

class MovingGauge {
 public:
  /// The primitive's frame in the implant's, and the path's leg; the gauge must outlive this.
  MovingGauge(const NormFunction<double>& gauge, const EnclosedPose& own, const EnclosedPose& at_begin,
              const EnclosedMotion& motion);

  /// When in [begin, end] the gauge at x is least, about.
  [[nodiscard]] double nearest_time(double begin, double end, const Eigen::Vector3d& x) const;

  /// The gauge at x, and its gradient there.
  struct Slope {
    double value;
    Eigen::Vector3d gradient;
  };

  [[nodiscard]] Slope slope(double time, const Eigen::Vector3d& x) const;

  /// A normal, of length 1, of a plane that touches the swept region near x: the gradient of the gauge; where the gauge
  /// is least `between` the ends of a stretch of time, its part across the motion.
  [[nodiscard]] Eigen::Vector3d normal(double time, bool between, const Slope& slope, const Eigen::Vector3d& x) const;

  /// Takes a direction from the bone's frame to the primitive's own frame.
  [[nodiscard]] Eigen::Vector3d own_direction(double time, const Eigen::Vector3d& direction) const;

 private:
  [[nodiscard]] Eigen::Vector3d speed(double time, const Eigen::Vector3d& x) const;
  [[nodiscard]] std::pair<Eigen::Vector3d, Eigen::Matrix3d> local(double time, const Eigen::Vector3d& x) const;

  const NormFunction<double>* gauge_;
  Eigen::Matrix3d own_rotation_;
  Eigen::Vector3d own_translation_;
  Eigen::Matrix3d path_rotation_;  // at the leg's begin, like the next
  Eigen::Vector3d path_translation_;
  Eigen::Vector3d velocity_;
  Eigen::Vector3d spin_;
};

}  // namespace verisq::verify
