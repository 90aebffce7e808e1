/// Which vertices of a mesh hang together.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Of each vertex the one that stands for its part: the same for two just where triangles lead from one to the other.
[[nodiscard]] inline std::vector<std::uint32_t> connected_parts(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&parent](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    parent[root(b)] = root(a);
    parent[root(c)] = root(a);
  }
  for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
  return parent;
}

}  // namespace verisq::verify
