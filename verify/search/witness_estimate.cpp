/// The point b and its distance in long double.
#include "verify/search/witness_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/triangle.hpp"

namespace verisq::verify {

WitnessEstimate::WitnessEstimate(const Model& model) {
  for (const Primitive& primitive : model.primitives) {
    const RigidMotion motion = PosedSuperquadric(primitive).motion();
    std::array<Vector, 3> rotation{};
    for (std::size_t i = 0; i < 3; ++i) rotation[i] = midpoint(motion.rotation.column(i));
    const auto& a = primitive.superquadric.semi_axes;
    primitives_.push_back({Boundary<long double>(primitive.superquadric), rotation, midpoint(motion.translation),
                           std::hypot(a[0], a[1], a[2])});
  }
}

long double WitnessEstimate::operator()(const Vector& point, const Normal& normal) const {
  const auto& [boundary, rotation, origin, radius] = primitives_[normal.primitive];
  const Vector d = difference(point, origin);
  Vector q{};
  Vector x{};
  for (std::size_t i = 0; i < 3; ++i) {
    q[i] = dot(rotation[i], d);
    x[i] = q[i] - normal.vector[i];
  }
  const long double gauge = boundary.gauge({std::fabs(x[0]), std::fabs(x[1]), x[2]});
  const Vector apart = along(q, x, gauge > 0.0L ? -1.0L / gauge : 0.0L);
  const long double rounding = 0x1p-56L * (radius + std::sqrt(dot(d, d)));
  return std::sqrt(dot(apart, apart)) + rounding;
}

}  // namespace verisq::verify
