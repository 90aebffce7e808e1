/// Takes vertices out of a surface that bounds a solid, where it stays as near to the solid's surface without them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/tessellation/solid.hpp"

namespace verisq::tessellation {

struct Triangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Collapses edges onto one of their ends, short ones first, while the topology stays (link condition: Dey,
/// Edelsbrunner et al., Topology preserving edge contraction, 1999), no triangle turns over, every vertex taken out is
/// within `deviation` of the triangles that replace it, and these, at points of them, of the solid. Stops early, with a
/// valid surface, where `interrupted` says so.
[[nodiscard]] Triangles collapse_edges(const Solid& solid, Triangles surface, double deviation,
                                       const std::function<bool()>& interrupted);

}  // namespace verisq::tessellation
