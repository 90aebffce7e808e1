/// The point b and its distance in long double.
#include "verify/search/witness_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proof/rigid_motion.hpp"
#include "verify/proof/triangle.hpp"

namespace verisq::verify {

WitnessEstimate::WitnessEstimate(const Model& model) {
  for (const auto& [name, superquadric, pose, bend] : model.primitives) {
    const RigidMotion motion(pose);
    std::array<Vector, 3> rotation{};
    for (std::size_t i = 0; i < 3; ++i) rotation[i] = midpoint(motion.rotation.column(i));
    const auto& a = superquadric.semi_axes;
    primitives_.push_back({Boundary<long double>(superquadric),
                           rotation,
                           {pose.translation[0], pose.translation[1], pose.translation[2]},
                           std::hypot(a[0], a[1], a[2])});
  }
}

long double WitnessEstimate::operator()(const Vector& point, const Normal& normal) const {
  const auto& [boundary, rotation, centre, radius] = primitives_[normal.primitive];
  const Vector d = difference(point, centre);
  Vector q{};
  Vector x{};
  for (std::size_t i = 0; i < 3; ++i) {
    q[i] = dot(rotation[i], d);
    x[i] = q[i] - normal.vector[i];
  }
  const long double gauge = boundary.gauge({std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])});
  const Vector apart = along(q, x, gauge > 0.0L ? -1.0L / gauge : 0.0L);
  const long double rounding = 0x1p-56L * (radius + std::sqrt(dot(d, d)));
  return std::sqrt(dot(apart, apart)) + rounding;
}

}  // namespace verisq::verify
