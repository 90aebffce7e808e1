/// Seven samples a primitive.
#include "host/fit/side_requirements.hpp"

#include <Eigen/Geometry>
#include <array>

#include "host/mesh/eigen_points.hpp"
#include "verify/proof/superquadric.hpp"

namespace verisq::fit_search {
namespace {

constexpr double drawn_in = 0.97;

std::array<Point, 7> samples_of(const Primitive& primitive) {
  const auto& [w, x, y, z] = primitive.pose.quaternion;
  const Eigen::Matrix3d rotation = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  const Eigen::Vector3d centre = vector_of(primitive.pose.translation);
  // A taper moves the widest section along z and scales it (docs/mathematics.md §18, P of z = 0).
  const double taper = verify::taper_coefficient<double>(primitive.superquadric.taper);
  const Eigen::Vector3d section = centre - taper * primitive.superquadric.semi_axes[2] * rotation.col(2);
  std::array<Point, 7> samples{primitive.pose.translation};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const Eigen::Vector3d& from = axis == 2 ? centre : section;
    const double scale = axis == 2 ? 1.0 : 1.0 - taper * taper;
    const Eigen::Vector3d way = drawn_in * scale * primitive.superquadric.semi_axes[k] * rotation.col(axis);
    samples[2 * k + 1] = point_of(from + way);
    samples[2 * k + 2] = point_of(from - way);
  }
  return samples;
}

}  // namespace

SideRequirements::SideRequirements(const InsideTest& inside, std::span<const SurfaceSide> required)
    : inside_(&inside), required_(required.begin(), required.end()) {}

std::size_t SideRequirements::misplaced(const Candidate& candidate) const {
  std::size_t count = 0;
  for (std::size_t k = 0; k < required_.size(); ++k) {
    if (required_[k] == SurfaceSide::any) continue;
    for (const Point& sample : samples_of(candidate.primitives[k])) {
      if ((*inside_)(sample) != (required_[k] == SurfaceSide::inside)) ++count;
    }
  }
  return count;
}

}  // namespace verisq::fit_search
