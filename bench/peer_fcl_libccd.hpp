/// The peer: distance of a point to a superquadric by FCL's libccd GJK with an analytic support function.
#pragma once

#include <verisq/model.hpp>

namespace verisq::bench {

/// FCL has no superquadric, but its GJK takes any convex body by its support function: this is FCL's own
/// `fcl::detail::GJKDistance`, as installed, fed with ∇h of design 2, §1. One core, no verification, no EPA.
class LibccdPointDistance {
 public:
  /// FCL's defaults (fcl/narrowphase/detail/gjk_solver_libccd-inl.h). The tolerance is the least progress of one
  /// iteration, not a bound on the error.
  static constexpr double tolerance = 1e-6;
  static constexpr unsigned max_iterations = 1000;

  /// Precondition: exponents below 2 (their conjugates are finite).
  explicit LibccdPointDistance(const Superquadric& solid);

  /// The unverified distance of a point outside; -1 where GJK reports an intersection or does not converge.
  [[nodiscard]] double operator()(const Point& point) const;

  /// What GJK sees of the superquadric: all that its support function needs, computed once.
  struct Body {
    Point semi_axes;
    double section_conjugate;  ///< q2 = 2 / (2 - e2)
    double profile_conjugate;  ///< q1 = 2 / (2 - e1)
  };

 private:
  Body body_;
};

/// ∇h(direction): the point of the body that lies farthest in `direction`. Precondition: direction not zero.
[[nodiscard]] Point support_point(const LibccdPointDistance::Body& body, const Point& direction);

}  // namespace verisq::bench
