/// Small closed meshes of known topology and size.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <verisq/mesh.hpp>

namespace verisq::testing {

/// Half of a corner of the unit cube, of volume 1/6, normals outward.
inline Mesh tetrahedron() {
  return {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// Both meshes, the vertices of `b` after those of `a`.
inline Mesh join(Mesh a, const Mesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (auto triangle : b.triangles) {
    for (std::uint32_t& vertex : triangle) vertex += offset;
    a.triangles.push_back(triangle);
  }
  return a;
}

/// Around the z-axis, normals outward; `around` and `across` are at least 3.
inline Mesh torus_mesh(double major_radius, double minor_radius, std::uint32_t around, std::uint32_t across) {
  Mesh mesh;
  const auto index = [&](std::uint32_t i, std::uint32_t j) { return i % around * across + j % across; };
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around;
      const double v = 2.0 * std::numbers::pi * j / across;
      const double from_axis = major_radius + minor_radius * std::cos(v);
      mesh.vertices.push_back({from_axis * std::cos(u), from_axis * std::sin(u), minor_radius * std::sin(v)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return mesh;
}

/// The unit sphere from an octahedron whose triangles are divided in four `rounds` times, normals outward.
inline Mesh sphere_mesh(int rounds) {
  Mesh mesh{.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
            .triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) {
        const Point p = mesh.vertices[a];
        const Point q = mesh.vertices[b];
        const Point sum{p[0] + q[0], p[1] + q[1], p[2] + q[2]};
        const double length = std::hypot(sum[0], sum[1], sum[2]);
        mesh.vertices.push_back({sum[0] / length, sum[1] / length, sum[2] / length});
      }
      return place->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

}  // namespace verisq::testing
