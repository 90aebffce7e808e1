/// The OpenCL sources of each program as one text, in the order of their layers; generated at build time.
#pragma once

#include <string_view>

namespace verisq::kernels {

/// Of the self-test: the layers of arithmetic that all programs share, and kernels that apply one operation of them.
[[nodiscard]] std::string_view embedded_arithmetic_layers();
[[nodiscard]] std::string_view embedded_self_test();

/// Distances to unions of convex primitives.
[[nodiscard]] std::string_view embedded_point_sources();
/// To one primitive, from the caller's points to his rows.
[[nodiscard]] std::string_view embedded_point_map();
[[nodiscard]] std::string_view embedded_tapered_point_map();
/// To one tapered primitive: the first kernel of these, of the same name.
[[nodiscard]] std::string_view embedded_tapered_sources();
[[nodiscard]] std::string_view embedded_triangle_sources();
[[nodiscard]] std::string_view embedded_pair_sources();

/// The objective of a fit and its gradient for many candidates: floating point, for searches.
[[nodiscard]] std::string_view embedded_pose_objective_sources();
/// The same kernels for candidates of which primitives are tapered.
[[nodiscard]] std::string_view embedded_tapered_pose_objective_sources();

/// Of programs for models with bends or set operations: the layers, those of models with tapered primitives, and
/// kernels that call functions of the model's own tree, which come last (host/device/solid_model.hpp).
[[nodiscard]] std::string_view embedded_solid_layers();
[[nodiscard]] std::string_view embedded_tapered_solid_layers();
[[nodiscard]] std::string_view embedded_bent_distance();
/// Likewise, where a primitive is both tapered and bent.
[[nodiscard]] std::string_view embedded_tapered_bent_distance();
[[nodiscard]] std::string_view embedded_set_bounds();
[[nodiscard]] std::string_view embedded_solid_distance();
[[nodiscard]] std::string_view embedded_octree();

}  // namespace verisq::kernels
