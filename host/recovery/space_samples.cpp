/// A grid, and the distances of its points outside.
#include "host/recovery/space_samples.hpp"

#include <algorithm>

#include "host/recovery/mesh_sample.hpp"

namespace verisq::recovery {
namespace {

constexpr std::size_t space_points = 8'000;  // of the grid about a closed mesh
constexpr double grid_steps_near = 2.0;      // so near the grid cannot tell how long a primitive is

}  // namespace

void add_space(const Mesh& mesh, const verify::TriangleTree& tree, UnionSamples& samples) {
  const GridSample space = sample_space(mesh, space_points);
  samples.inside.insert(samples.inside.end(), space.inside.begin(), space.inside.end());
  for (const Eigen::Vector3d& point : space.outside) {
    const double distance = tree.nearest({point[0], point[1], point[2]}).distance.hi;
    samples.outside.push_back(point);
    samples.beyond.push_back(std::max(0.0, distance - grid_steps_near * space.step));
  }
}

}  // namespace verisq::recovery
