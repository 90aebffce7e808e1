/// Proves distances to an ordinary model by certificates.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/empty_neighbourhood.hpp"
#include "verify/proof/mesh_solid.hpp"
#include "verisq/checker.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Immutable after construction: safe to call from many threads.
class ExactChecker {
 public:
  /// Throws Error(input) for a model that is not valid, or has a mesh.
  explicit ExactChecker(const Model& model);

  /// The enclosure of the exact signed distance that the certificate proves, whatever the certificate contains. An
  /// inner end, and an end proven by a cover, is proven no farther than claimed. `interrupted`, unless empty, is
  /// polled; once it returns true, the enclosure is looser. Preconditions: those of Checker.
  [[nodiscard]] Enclosure operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

  /// The same for the distance of a triangle.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

  /// The set and the primitives that covers are about.
  [[nodiscard]] const SetExpression& set() const { return set_; }
  [[nodiscard]] std::span<const PosedPrimitive> primitives() const { return primitives_; }

 private:
  template <class Query>
  [[nodiscard]] bool is_covered(const Query& query, double radius, Place wanted, const Certificate& certificate,
                                const Hook& interrupted) const;
  [[nodiscard]] double distance_of(const PreciseVector& x, const std::optional<Point>& p, Place place) const;
  [[nodiscard]] double proven_lower(const Point& x, double claimed, const Certificate& certificate,
                                    const Hook& interrupted) const;
  [[nodiscard]] double proven_upper(const Point& x, double claimed, const Certificate& certificate,
                                    const Hook& interrupted) const;
  [[nodiscard]] double proven_lower(const Triangle& triangle, double claimed, const Certificate& certificate,
                                    const Hook& interrupted) const;
  [[nodiscard]] double proven_upper(const Triangle& triangle, double claimed, const Certificate& certificate) const;

  std::vector<PosedPrimitive> primitives_;
  SetExpression set_;
  bool is_union_ = false;
};

/// Checks models that may have closed meshes, too: of a union with meshes, points alone. Of a mesh it asks for no
/// certificate, so that normals that name a mesh prove nothing. Immutable after construction: safe to call from many
/// threads.
class ModelChecker {
 public:
  /// Throws Error(input) for a model that is not valid, for a mesh that is not closed, and for a model with meshes that
  /// is not the union of all its primitives.
  explicit ModelChecker(const Model& model);

  /// As ExactChecker.
  [[nodiscard]] Enclosure operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

  /// As ExactChecker; throws Error(input) if the model has meshes.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

 private:
  [[nodiscard]] Enclosure least_of_meshes(const Point& point) const;
  [[nodiscard]] std::vector<Normal> normals_of_others(const Certificate& certificate) const;
  [[nodiscard]] double lower_by_escape(const Point& point, const std::optional<Point>& escape) const;

  std::vector<MeshSolid> meshes_;
  std::optional<ExactChecker> others_;               ///< of all that are no meshes
  std::vector<std::optional<std::uint32_t>> place_;  ///< of each primitive among the others
};

}  // namespace verisq::verify
