/// The distance of points to a mesh's triangles, by a tree of their boxes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq::recovery {

class TriangleTree {
 public:
  /// Precondition: at least one triangle.
  explicit TriangleTree(const Mesh& mesh);

  /// To the nearest triangle, rounded.
  [[nodiscard]] double distance(const Eigen::Vector3d& point) const;

 private:
  struct Node {
    Eigen::Vector3d lowest;
    Eigen::Vector3d highest;
    std::uint32_t first;  ///< triangle of a leaf, else the left child; the right one follows it
    std::uint32_t count;  ///< of triangles; 0: no leaf
  };

  void divide(std::uint32_t node, std::uint32_t first, std::uint32_t last);

  std::vector<std::array<Eigen::Vector3d, 3>> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace verisq::recovery
