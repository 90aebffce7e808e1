/// A model's surface as a triangle mesh, for printing and for other programs.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

struct ModelMeshOptions {
  double deviation;  ///< > 0, in model units: the mesh is to be this near to the surface, and the surface to the mesh
  std::size_t most_triangles = 20'000'000;                   ///< refuses to go on beyond
  std::function<bool()> interrupted = [] { return false; };  ///< polled, also by several threads at once; true, and it
                                                             ///< must stay so, ends the work
  /// Called now and then with what is being done, and a number that grows from 0 to 1.
  std::function<void(std::string_view, double)> progress = [](std::string_view, double) {};
};

struct ModelMesh {
  Mesh mesh;  ///< closed, manifold and consistently oriented, normals outward; empty where `interrupted`
  /// The largest distance of sampled points of the mesh from the surface, along the normal, at most 12.5 % more than
  /// the samples have: an estimate, nothing is proven.
  double estimated_deviation = 0.0;
  std::size_t samples = 0;
  bool interrupted = false;
};

/// The boundary of the model's solid: of unions that of the union. Primitives that are proven disjoint are gridded each
/// along its own longitudes and latitudes; all others by marching tetrahedra, refined where samples are farther from
/// the surface than half the deviation (docs/architecture.md, A mesh of a model). Nothing but disjointness is proven;
/// floating point to nearest. Throws Error(input) for a deviation that is not positive or so small that it is lost in
/// the rounding of coordinates or takes more than `most_triangles`, for a model without any point (an empty
/// intersection), and as `SignedDistance` for bad models.
[[nodiscard]] ModelMesh model_mesh(const Model& model, const ModelMeshOptions& options);

}  // namespace verisq
