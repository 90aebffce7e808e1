/// The alpha wrap: a closed oriented surface around points or triangles, whatever their state.
#pragma once

#include <verisq/mesh.hpp>

namespace verisq::surface {

/// Contains all of `input`, its triangles or, where it has none, its points: the space outside is carved away by balls
/// of radius `alpha`, which stop at the distance `offset` (Portaneri, Rouxel-Labbé, Hemmer, Cohen-Steiner, Alliez:
/// Alpha Wrapping with an Offset, SIGGRAPH 2022). Gaps narrower than 2 alpha are bridged. Normals point outward.
/// Preconditions: alpha, offset > 0; `input` is not empty.
[[nodiscard]] Mesh alpha_wrap(const Mesh& input, double alpha, double offset);

}  // namespace verisq::surface
