/// The best of some normals that may separate two convex sets, in plain floating point. Proposes, proves nothing.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "verify/proposals/gjk.hpp"
#include "verify/proposals/triangle.hpp"

namespace verisq::verify {

/// Of those that are offered the one along which B lies farthest beyond A.
template <SupportMapping<double> SetA, SupportMapping<double> SetB>
class BestNormal {
 public:
  /// Both have to outlive this.
  BestNormal(const SetA& a, const SetB& b) : a_(a), b_(b) {}

  /// Of any length. One along which numbers overflow is none.
  void offer(const Coordinates<double>& n) {
    const double gap = (dot(n, b_({-n[0], -n[1], -n[2]})) - dot(n, a_(n))) / std::sqrt(dot(n, n));
    if (!(gap > gap_)) return;
    normal_ = n;
    gap_ = gap;
  }

  /// That of a triangle, and its opposite.
  void offer_normals_of(const std::array<Coordinates<double>, 3>& corners) {
    const Coordinates<double> n = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
    offer(n);
    offer({-n[0], -n[1], -n[2]});
  }

  /// Zero before one was offered.
  [[nodiscard]] const Coordinates<double>& normal() const { return normal_; }
  /// About how far that is; negative where the sets are not apart along it.
  [[nodiscard]] double gap() const { return gap_; }

 private:
  const SetA& a_;
  const SetB& b_;
  Coordinates<double> normal_{};
  double gap_ = -std::numeric_limits<double>::infinity();
};

}  // namespace verisq::verify
