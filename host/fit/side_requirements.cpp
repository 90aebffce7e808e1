/// Seven samples a primitive.
#include "host/fit/side_requirements.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>

#include "host/fit/bent_projection.hpp"
#include "host/mesh/eigen_points.hpp"
#include "verify/proof/superquadric.hpp"

namespace verisq::fit_search {
namespace {

constexpr double drawn_in = 0.97;

/// In the primitive's own frame, before its bend.
std::array<Eigen::Vector3d, 7> unbent_samples_of(const Superquadric& solid) {
  // A taper moves the widest section along z and scales it (docs/mathematics.md §18, P of z = 0).
  const double taper = verify::taper_coefficient<double>(solid.taper);
  const Eigen::Vector3d section(0.0, 0.0, -taper * solid.semi_axes[2]);
  std::array<Eigen::Vector3d, 7> samples{Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const Eigen::Vector3d from = axis == 2 ? Eigen::Vector3d::Zero() : section;
    const double scale = axis == 2 ? 1.0 : 1.0 - taper * taper;
    const Eigen::Vector3d way = drawn_in * scale * solid.semi_axes[k] * Eigen::Vector3d::Unit(axis);
    samples[2 * k + 1] = from + way;
    samples[2 * k + 2] = from - way;
  }
  return samples;
}

std::array<Point, 7> samples_of(const Primitive& primitive) {
  const auto& [w, x, y, z] = primitive.pose.quaternion;
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(w, x, y, z).normalized();
  const Eigen::Vector3d centre = vector_of(primitive.pose.translation);
  std::optional<BentProjection> bend;
  if (is_bent(primitive)) bend.emplace(primitive.superquadric, *primitive.bend);
  std::array<Point, 7> samples{};
  std::ranges::transform(unbent_samples_of(primitive.superquadric), samples.begin(), [&](const Eigen::Vector3d& own) {
    return point_of(centre + rotation * (bend ? bend->image(own) : own));
  });
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
