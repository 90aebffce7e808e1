/// Closed meshes among other primitives: signed distances and closest points.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "verify/search/closed_mesh.hpp"
#include "verify/search/solid_distance.hpp"
#include "verisq/checker.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// The closest point of a mesh, proven in 127-bit intervals (docs/mathematics.md §29). Nothing if several points may be
/// closest, if the point may lie on the surface, or inside where triangles cross. `primitive` is left out.
[[nodiscard]] std::optional<ClosestPoint> closest_point(const PosedMesh& mesh, const Point& point);

/// Immutable: safe to ask from many threads.
class MeshUnion {
 public:
  /// Throws Error(input) unless the model is the union of its primitives, and for meshes that are not closed.
  /// Precondition: valid, has_mesh(model).
  explicit MeshUnion(const Model& model);
  ~MeshUnion();
  MeshUnion(MeshUnion&&) noexcept;
  MeshUnion& operator=(MeshUnion&&) noexcept;

  struct Part {
    std::uint32_t primitive;  ///< index in Model::primitives
    PosedMesh mesh;
  };
  [[nodiscard]] std::span<const Part> meshes() const { return meshes_; }
  /// The model of all other primitives, which are superquadrics; nothing if there are none.
  [[nodiscard]] const std::optional<Model>& others() const { return others_; }

  /// Encloses the signed distance, with what proves it beside the meshes themselves. `tolerance` is of the search among
  /// superquadrics. Precondition: finite.
  [[nodiscard]] CertifiedEnclosure operator()(const Point& point, double tolerance, bool certified,
                                              const std::function<bool()>& interrupted) const;

  /// The same without a search, from distances to each mesh, in order, and to the others, whose certificate is of their
  /// own model.
  [[nodiscard]] CertifiedEnclosure joined(const Point& point, std::span<const ClosedMesh::Distance> to_meshes,
                                          const std::optional<CertifiedEnclosure>& to_others) const;

  /// Narrows an enclosure that is wider than the tolerance by a search, in a union of several primitives. An upper end
  /// with a certificate is left as it is.
  void narrow(const Point& point, double tolerance, bool certified, const std::function<bool()>& interrupted,
              CertifiedEnclosure& found) const;

  /// As SignedDistance::closest_point where it is proven.
  [[nodiscard]] std::optional<ClosestPoint> closest_point(const Point& point) const;

 private:
  [[nodiscard]] bool is_outside(const Point& point) const;
  [[nodiscard]] std::optional<Point> escape(const Point& point, std::span<const ClosedMesh::Distance> to_meshes,
                                            bool may_be_in_others) const;

  std::vector<Part> meshes_;
  std::optional<Model> others_;
  std::vector<std::uint32_t> index_of_;        ///< of each of the others, in Model::primitives
  std::unique_ptr<SignedDistance> to_others_;  ///< where there are some
  std::unique_ptr<SolidDistance> search_;      ///< of several primitives
  double size_;                                ///< no coordinate of the solid is larger
};

}  // namespace verisq::verify
