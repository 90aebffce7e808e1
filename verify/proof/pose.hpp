/// Rigid motions in precise interval arithmetic: model frame to the frame of a primitive and back.
#pragma once

#include "verify/proof/certificate.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// x -> R x + t with R the rotation of the normalised quaternion, enclosed to the rounding error of 127 bits.
class Frame {
 public:
  explicit Frame(const Pose& pose);

  /// R^T (x - t)
  [[nodiscard]] PreciseVector local_point(const Point& x) const;
  /// R^T v
  [[nodiscard]] PreciseVector local_direction(const Proposal& v) const;
  /// R v, to nearest: a direction to be certified. Zero if v is not usable.
  [[nodiscard]] Proposal model_direction(const Proposal& v) const;

  [[nodiscard]] const PreciseVector& origin() const { return translation_; }
  [[nodiscard]] const PreciseMatrix& rotation() const { return rotation_; }

 private:
  PreciseMatrix rotation_;
  PreciseVector translation_;
};

/// |x - y|, rounded up.
[[nodiscard]] double distance_up(const Point& x, const Point& y);

}  // namespace verisq::verify
