/// Shapes that look much like a given one but are far from it in the search's parameters: where another optimum may
/// be ("switching" of Liu et al., CVPR 2022).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "host/recovery/mixture_fit.hpp"
#include "host/recovery/shape.hpp"

namespace verisq::recovery {

/// Another axis as z, and the section turned by 45 degrees with its exponent on the other side of 1: a square is a
/// rhombus too. Where the points of the fit end well before the shape does, also shapes that end with them, or half
/// way.
[[nodiscard]] std::vector<Shape> alternative_shapes(const MixtureFit& fit, std::span<const Eigen::Vector3d> points);

}  // namespace verisq::recovery
