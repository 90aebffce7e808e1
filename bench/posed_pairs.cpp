/// The gap between two parallel supporting planes is exact up to rounding: it needs only the support mappings.
#include "bench/posed_pairs.hpp"

#include <algorithm>
#include <array>

#include "bench/approximate_motion.hpp"
#include "bench/points.hpp"
#include "bench/support_mapping.hpp"
#include "bench/uniform_numbers.hpp"

namespace verisq::bench {
namespace {

constexpr std::uint64_t seed = 20'110'503;
constexpr std::array gaps{0.01, 0.1, 1.0, 10.0};

/// Uniform on the unit sphere: from the ball, so that no direction is preferred.
template <int dimension>
Eigen::Vector<double, dimension> random_unit_vector(UniformNumbers& uniform) {
  while (true) {
    Eigen::Vector<double, dimension> v;
    for (double& coordinate : v) coordinate = uniform.within(1.0);
    const double norm = v.norm();
    if (norm > 0.1 && norm < 1.0) return v / norm;
  }
}

/// h(v), the largest v·x over the solid.
double support(const SupportMapping& solid, const Eigen::Vector3d& v) {
  return v.dot(vector(solid(point(v))));
}

}  // namespace

std::vector<Pose> separated_poses(const Superquadric& a, const Superquadric& b, std::size_t count) {
  UniformNumbers uniform(seed);
  const SupportMapping support_of_a(a);
  const SupportMapping support_of_b(b);
  const double size = std::max(size_of(a), size_of(b));
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d direction = random_unit_vector<3>(uniform);
    const Eigen::Vector4d quaternion = random_unit_vector<4>(uniform);
    Pose pose{{}, {quaternion[0], quaternion[1], quaternion[2], quaternion[3]}};
    const Eigen::Vector3d seen_from_b = -(ApproximateMotion(pose).rotation.transpose() * direction);
    const double between_centres =
        support(support_of_a, direction) + support(support_of_b, seen_from_b) + size * gaps[i % gaps.size()];
    // Off the common normal, or both closest points would be the support points: harder for every tool, still apart.
    const Eigen::Vector3d sideways = size * random_unit_vector<3>(uniform).cross(direction);
    pose.translation = point(between_centres * direction + sideways);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace verisq::bench
