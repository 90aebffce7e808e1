/// Bisected tetrahedra fill the cube and meet face to face, wherever they were refined.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "host/prepare/tetrahedra_surface.hpp"

namespace verisq::tessellation {
namespace {

TEST(BisectedTetrahedra, FillTheCubeFaceToFace) {
  BisectedTetrahedra grid(Eigen::Vector3d(-1.0, 2.0, 3.0), 2.0);
  for (int round = 0; round < 25; ++round) {  // deep into one corner
    grid.bisect(std::vector{grid.leaf_at({-0.999, 2.001, 3.002})});
    grid.bisect(std::vector{grid.leaf_at({0.3, 3.1, 4.2})});
  }
  std::map<std::array<std::uint32_t, 3>, int> faces;
  double volume = 0.0;
  for (std::uint32_t k = 0; k < grid.tetrahedra().size(); ++k) {
    if (!grid.is_leaf(k)) continue;
    auto corners = grid.tetrahedra()[k].corners;
    const auto& v = grid.vertices();
    volume +=
        std::abs(
            (v[corners[1]] - v[corners[0]]).cross(v[corners[2]] - v[corners[0]]).dot(v[corners[3]] - v[corners[0]])) /
        6.0;
    std::ranges::sort(corners);
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<std::uint32_t, 3> face{};
      std::copy_if(corners.begin(), corners.end(), face.begin(), [&](auto c) { return c != corners[left_out]; });
      ++faces[face];
    }
  }
  EXPECT_NEAR(volume, 8.0, 1e-12);
  EXPECT_LT(grid.size(grid.leaf_at({-0.999, 2.001, 3.002})), 0.02);
  for (const auto& [face, count] : faces) {
    if (count == 2) continue;
    ASSERT_EQ(count, 1);  // on the cube's boundary: one coordinate is an end of it, of all three corners
    bool outer = false;
    for (int axis = 0; axis < 3; ++axis) {
      const double first = grid.vertices()[face[0]][axis];
      const bool at_end = std::abs(std::abs(first - Eigen::Vector3d(0.0, 3.0, 4.0)[axis]) - 1.0) < 1e-12;
      outer = outer || (at_end && grid.vertices()[face[1]][axis] == first && grid.vertices()[face[2]][axis] == first);
    }
    EXPECT_TRUE(outer);
  }
}

}  // namespace
}  // namespace verisq::tessellation
