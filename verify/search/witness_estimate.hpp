/// Foresees in plain floating point which upper ends the checker can prove, at a hundredth of its price.
#pragma once

#include <array>
#include <vector>

#include "verify/proposals/boundary.hpp"
#include "verisq/certificate.hpp"

namespace verisq::verify {

/// The kernels prove upper ends by a point b that they round; a certificate states it exactly. Where a solid is sharp
/// or a point is close to its surface, the two may differ by more than the kernels' bound allows for.
class WitnessEstimate {
 public:
  explicit WitnessEstimate(const Model& model);

  using Vector = std::array<long double, 3>;

  /// |point - b| with b as Normal describes it, and some 2^-56 of the lengths at hand for rounding. Proves nothing.
  [[nodiscard]] long double operator()(const Vector& point, const Normal& normal) const;

 private:
  struct PosedBoundary {
    Boundary<long double> boundary;
    std::array<Vector, 3> rotation;  ///< model to own frame, row by row
    Vector origin;
    long double radius;
  };

  std::vector<PosedBoundary> primitives_;
};

}  // namespace verisq::verify
