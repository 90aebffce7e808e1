/// Drives FCL's libccd GJK with the support functions of superquadrics, points and triangles.
#include "bench/peer_fcl_libccd.hpp"

#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd.h>

#include <algorithm>

#include "bench/approximate_motion.hpp"

namespace verisq::bench {
namespace {

/// FCL's own defaults (fcl/narrowphase/detail/gjk_solver_libccd-inl.h). The tolerance is the least progress of one
/// iteration, not a bound on the error.
constexpr double tolerance = 1e-6;
constexpr unsigned max_iterations = 1000;

struct PosedBody {
  const SupportMapping& body;
  ApproximateMotion pose;
};

void store(const Point& point, ccd_vec3_t* support) {
  std::copy(point.begin(), point.end(), support->v);
}

void support_of(const SupportMapping& body, const ccd_vec3_t* direction, ccd_vec3_t* support) {
  store(body({direction->v[0], direction->v[1], direction->v[2]}), support);
}

/// The affine transformation theorem: s of R K + t is R s(Rᵀ v) + t.
void support_of(const PosedBody& posed, const ccd_vec3_t* direction, ccd_vec3_t* support) {
  const Eigen::Vector3d v(direction->v[0], direction->v[1], direction->v[2]);
  const Eigen::Vector3d own = posed.pose.rotation.transpose() * v;
  store(point(posed.pose(vector(posed.body(point(own))))), support);
}

void support_of(const Point& body, const ccd_vec3_t* /*direction*/, ccd_vec3_t* support) {
  store(body, support);
}

void support_of(const Triangle& body, const ccd_vec3_t* direction, ccd_vec3_t* support) {
  const auto height = [&](const Point& x) {
    return direction->v[0] * x[0] + direction->v[1] * x[1] + direction->v[2] * x[2];
  };
  store(*std::ranges::max_element(body, {}, height), support);
}

template <class Body>
void support_function(const void* body, const ccd_vec3_t* direction, ccd_vec3_t* support) {
  support_of(*static_cast<const Body*>(body), direction, support);
}

template <class A, class B>
double gjk_distance(const A& a, const B& b) {
  double distance = -1.0;
  // GJKDistance takes mutable pointers, but hands them on to the support functions alone, as pointers to const.
  fcl::detail::GJKDistance<double>(const_cast<A*>(&a), support_function<A>, const_cast<B*>(&b), support_function<B>,
                                   max_iterations, tolerance, &distance, nullptr, nullptr);
  return distance;
}

}  // namespace

double LibccdPointDistance::operator()(const Point& point) const {
  return gjk_distance(solid_, point);
}

double LibccdTriangleDistance::operator()(const Triangle& triangle) const {
  return gjk_distance(solid_, triangle);
}

double LibccdPairDistance::operator()(const Pose& pose_of_b) const {
  return gjk_distance(a_, PosedBody{b_, ApproximateMotion(pose_of_b)});
}

}  // namespace verisq::bench
