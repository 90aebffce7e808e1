/// Whether meshes are closed, cuts of meshes by planes, meshes of models.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// A plane that divides space: where a bone is resected.

/// Beyond is where (x - point) . normal > 0.
struct Plane {
  Point point;
  Point normal;  ///< finite, of any length but 0
};

// A mesh without what lies beyond a plane.

/// The same plane, with a normal whose largest coordinate is 1, to nearest. Precondition: finite, normal not 0.
[[nodiscard]] Plane scaled(const Plane& plane);

struct CutMesh {
  Mesh mesh;
  std::vector<std::uint32_t> origin;  ///< for each vertex that of the whole mesh which it is, or which lies at the kept
                                      ///< end of its edge: new ones lie where an edge meets the plane, to nearest
};

/// In the order of the whole mesh: vertices that are kept, of triangles or not, then new ones; triangles as they come,
/// those that the plane crosses replaced by one or two.
[[nodiscard]] CutMesh cut_off(const Mesh& mesh, const Plane& plane);

// Whether a mesh bounds a solid: closed, manifold, consistently oriented; and its Euler characteristic and volume.

/// Counts alone: what the indices say, not where the vertices lie. Vertices that no triangle uses are left out.
struct MeshTopology {
  std::size_t vertices = 0;
  std::size_t edges = 0;
  std::size_t triangles = 0;
  std::size_t components = 0;             ///< sets of triangles that are connected through edges
  std::size_t boundary_edges = 0;         ///< of one triangle
  std::size_t non_manifold_edges = 0;     ///< of more than two triangles
  std::size_t non_manifold_vertices = 0;  ///< see the function of that name
  std::size_t inconsistent_edges = 0;     ///< of two triangles that run through it the same way

  [[nodiscard]] bool closed() const { return triangles > 0 && boundary_edges == 0; }
  [[nodiscard]] bool manifold() const { return non_manifold_edges == 0 && non_manifold_vertices == 0; }
  [[nodiscard]] bool oriented() const { return inconsistent_edges == 0; }
  [[nodiscard]] bool bounds_solid() const { return closed() && manifold() && oriented(); }

  /// V - E + F.
  [[nodiscard]] std::int64_t euler_characteristic() const;

  /// The sum over all components (0 for spheres, 1 for a torus); nothing unless `bounds_solid()`.
  [[nodiscard]] std::optional<std::int64_t> genus() const;
};

/// Precondition: the corners of each triangle differ, as in every mesh that a reader delivers.
[[nodiscard]] MeshTopology mesh_topology(const Mesh& mesh);

/// Vertices whose triangles are not one fan, in ascending order: bow ties, and the ends of non-manifold edges. Same
/// precondition.
[[nodiscard]] std::vector<std::uint32_t> non_manifold_vertices(const Mesh& mesh);

/// Positive where the normals of a closed mesh point outward; rounded to nearest, no enclosure. Of no meaning unless
/// the mesh is closed and oriented.
[[nodiscard]] double signed_volume(const Mesh& mesh);

/// The same as the sum of the cones from `apex` to the triangles: for open meshes, which bound nothing.
[[nodiscard]] double signed_volume(const Mesh& mesh, const Point& apex);

// A model's surface as a triangle mesh, for printing and for other programs.

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
