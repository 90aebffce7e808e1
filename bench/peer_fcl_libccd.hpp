/// The peer: distances to superquadrics by FCL's libccd GJK with analytic support functions.
///
/// FCL has no superquadric, but its GJK takes any convex body by its support function: this is FCL's own
/// `fcl::detail::GJKDistance`, as installed, fed with support mappings. One core, no verification, no EPA.
/// Every distance is -1 where GJK reports an intersection or does not converge. Precondition: exponents below 2.
#pragma once

#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "bench/support_mapping.hpp"

namespace verisq::bench {

/// From a superquadric in its own frame to a point outside.
class LibccdPointDistance {
 public:
  explicit LibccdPointDistance(const Superquadric& solid) : solid_(solid) {}

  [[nodiscard]] double operator()(const Point& point) const;

 private:
  SupportMapping solid_;
};

/// To a triangle, its interior included.
class LibccdTriangleDistance {
 public:
  explicit LibccdTriangleDistance(const Superquadric& solid) : solid_(solid) {}

  [[nodiscard]] double operator()(const Triangle& triangle) const;

 private:
  SupportMapping solid_;
};

/// To a second superquadric in a pose.
class LibccdPairDistance {
 public:
  LibccdPairDistance(const Superquadric& a, const Superquadric& b) : a_(a), b_(b) {}

  [[nodiscard]] double operator()(const Pose& pose_of_b) const;

 private:
  SupportMapping a_;
  SupportMapping b_;
};

}  // namespace verisq::bench
