/// Smooths a mesh without shrinking it.
#pragma once

#include <verisq/mesh.hpp>

namespace verisq::surface {

/// Taubin's smoothing (A signal processing approach to fair surface design, SIGGRAPH 1995): each round moves every
/// vertex towards the mean of its neighbours, then all a little farther back, which damps ripples of a few edges and
/// keeps the shape. Vertices at the border of an open mesh stay. Precondition: rounds >= 0.
[[nodiscard]] Mesh smoothed(Mesh mesh, int rounds);

}  // namespace verisq::surface
