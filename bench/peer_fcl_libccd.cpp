/// Drives FCL's libccd GJK with the support functions of a superquadric and of a point.
#include "bench/peer_fcl_libccd.hpp"

#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd.h>

#include <algorithm>
#include <cmath>

namespace verisq::bench {
namespace {

/// Norm of two nonnegative numbers for the exponent q > 1, and its partial derivatives.
struct NormAndGradient {
  double norm;
  double by_first;
  double by_second;
};

/// Two powers instead of the five of the textbook formula, so that the peer runs as fast as its method allows: with
/// t = smaller / larger and T = 1 + t^q the norm is larger * T^(1/q), and (component / norm)^(q-1) follows from
/// T^(-(q-1)/q) = T^(1/q) / T.
NormAndGradient norm_and_gradient(double first, double second, double q) {
  const double larger = std::max(first, second);
  if (larger == 0.0) return {0.0, 0.0, 0.0};
  const double ratio = std::min(first, second) / larger;
  const double power = std::pow(ratio, q - 1.0);
  const double sum = 1.0 + ratio * power;
  const double root = std::pow(sum, 1.0 / q);
  const double of_larger = root / sum;
  const double of_smaller = power * of_larger;
  return first < second ? NormAndGradient{larger * root, of_smaller, of_larger}
                        : NormAndGradient{larger * root, of_larger, of_smaller};
}

void support_of_superquadric(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* support) {
  const auto& body = *static_cast<const LibccdPointDistance::Body*>(object);
  const Point point = support_point(body, {direction->v[0], direction->v[1], direction->v[2]});
  std::copy(point.begin(), point.end(), support->v);
}

void support_of_point(const void* object, const ccd_vec3_t* /*direction*/, ccd_vec3_t* support) {
  const auto& point = *static_cast<const Point*>(object);
  std::copy(point.begin(), point.end(), support->v);
}

}  // namespace

Point support_point(const LibccdPointDistance::Body& body, const Point& direction) {
  const auto& [a1, a2, a3] = body.semi_axes;
  const auto section =
      norm_and_gradient(a1 * std::abs(direction[0]), a2 * std::abs(direction[1]), body.section_conjugate);
  const auto profile = norm_and_gradient(section.norm, a3 * std::abs(direction[2]), body.profile_conjugate);
  return {std::copysign(a1 * section.by_first * profile.by_first, direction[0]),
          std::copysign(a2 * section.by_second * profile.by_first, direction[1]),
          std::copysign(a3 * profile.by_second, direction[2])};
}

LibccdPointDistance::LibccdPointDistance(const Superquadric& solid)
    : body_{solid.semi_axes, 2.0 / (2.0 - solid.exponents[1]), 2.0 / (2.0 - solid.exponents[0])} {}

double LibccdPointDistance::operator()(const Point& point) const {
  // GJKDistance takes mutable pointers, but hands them on to the support functions alone, as pointers to const.
  auto* const solid = const_cast<Body*>(&body_);
  auto* const query = const_cast<Point*>(&point);
  double distance = -1.0;
  fcl::detail::GJKDistance<double>(solid, support_of_superquadric, query, support_of_point, max_iterations, tolerance,
                                   &distance, nullptr, nullptr);
  return distance;
}

}  // namespace verisq::bench
