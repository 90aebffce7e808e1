/// Triangles to draw a model by. For the eye alone: binary64 to nearest, nothing about them is proven.
#pragma once

#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq::report {

/// The boundary of the model's solid, outward by the right-hand rule; every vertex lies on the surface of a primitive
/// but for rounding. One primitive alone gives a closed surface. Where primitives meet, whole small triangles are kept
/// or left out, with no gaps between them: the edges of cuts are ragged by a fraction of a triangle.
[[nodiscard]] Mesh model_surface(const Model& model);

}  // namespace verisq::report
