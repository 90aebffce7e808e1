/// Drives fcl::continuousCollide.
#include "bench/peer_fcl_continuous.hpp"

#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/continuous_collision.h>

#include "bench/approximate_motion.hpp"

namespace verisq::bench {
namespace {

fcl::Transform3d at(const Point& place) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  transform.translation() = vector(place);
  return transform;
}

FclContact contact(const fcl::CollisionGeometryd& a, const fcl::CollisionGeometryd& b, const Point& from,
                   const Point& to, const fcl::ContinuousCollisionRequestd& request) {
  fcl::ContinuousCollisionResultd result;
  const fcl::Transform3d still = fcl::Transform3d::Identity();
  fcl::continuousCollide(&a, still, still, &b, at(from), at(to), request, result);
  if (!result.is_collide) return std::nullopt;
  return result.time_of_contact;
}

fcl::Ellipsoidd ellipsoid(const Point& semi_axes) {
  return {semi_axes[0], semi_axes[1], semi_axes[2]};
}

}  // namespace

FclContact fcl_advanced_contact(double radius_a, double radius_b, const Point& from, const Point& to) {
  fcl::ContinuousCollisionRequestd request;
  request.ccd_motion_type = fcl::CCDM_TRANS;
  request.ccd_solver_type = fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
  return contact(fcl::Sphered(radius_a), fcl::Sphered(radius_b), from, to, request);
}

FclContact fcl_sampled_contact(const Point& semi_axes_a, const Point& semi_axes_b, const Point& from, const Point& to,
                               std::size_t samples) {
  fcl::ContinuousCollisionRequestd request;
  request.num_max_iterations = samples;
  request.toc_err = 1.0 / static_cast<double>(samples);
  request.ccd_motion_type = fcl::CCDM_TRANS;
  request.ccd_solver_type = fcl::CCDC_NAIVE;
  return contact(ellipsoid(semi_axes_a), ellipsoid(semi_axes_b), from, to, request);
}

}  // namespace verisq::bench
