/// One line says what is wrong, and where.
#include "host/deviation/deviation_check.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstddef>

#include "host/errors/refusal.hpp"

namespace verisq {

void check_mesh(const Mesh& mesh) {
  if (mesh.vertices.empty()) refuse("the mesh has no vertices");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& [x, y, z] = mesh.vertices[i];
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z)) continue;
    refuse(fmt::format("vertex {} of the mesh, ({}, {}, {}), is not finite", i, x, y, z));
  }
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    for (const std::uint32_t corner : mesh.triangles[n]) {
      if (corner < mesh.vertices.size()) continue;
      refuse(fmt::format("triangle {} of the mesh names vertex {}, of {}", n, corner, mesh.vertices.size()));
    }
  }
}

void check_regions(const Mesh& mesh, std::span<const std::uint32_t> region_of, std::uint32_t regions) {
  if (regions == 0) return;
  if (region_of.size() != mesh.triangles.size())
    refuse(fmt::format("{} regions for {} triangles", region_of.size(), mesh.triangles.size()));
  for (const std::uint32_t region : region_of) {
    if (region >= regions) refuse(fmt::format("there is no region {} of {}", region, regions));
  }
}

}  // namespace verisq
