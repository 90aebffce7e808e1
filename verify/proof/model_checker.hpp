/// Proves distances to models whose primitives may be closed meshes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "verify/proof/exact_checker.hpp"

namespace verisq::verify {

class MeshSolid;

/// An ExactChecker of models that may have closed meshes, too. A mesh needs no certificate: normals that name a mesh
/// prove nothing. Immutable after construction: safe to call from many threads.
class ModelChecker {
 public:
  /// Throws Error(input) for a model that is not valid, for a mesh that is not closed, and for a model with meshes that
  /// is not the union of all its primitives.
  explicit ModelChecker(const Model& model);

  /// As ExactChecker.
  [[nodiscard]] Enclosure operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

  /// As ExactChecker. In a union with meshes the others are proven by normals alone.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                                     const Hook& interrupted = {}) const;

 private:
  [[nodiscard]] Enclosure least_of_meshes(const Point& point) const;
  [[nodiscard]] std::vector<Normal> normals_of_others(const Certificate& certificate) const;
  [[nodiscard]] double lower_by_escape(const Point& point, const std::optional<Point>& escape) const;

  std::vector<std::shared_ptr<const MeshSolid>> meshes_;  ///< in a header of their own: others need not read it
  std::optional<ExactChecker> others_;                    ///< of all that are no meshes
  std::vector<std::optional<std::uint32_t>> place_;       ///< of each primitive among the others
};

/// The places of cubes relative to a model that may have closed meshes, whatever its set operations are. Immutable
/// after construction: safe to call from many threads.
class CubePlaces {
 public:
  /// Throws Error(input) for a model that is not valid, and for a mesh that is not closed.
  explicit CubePlaces(const Model& model);

  /// True where the cube about any point of the enclosed centre is proven to lie outside of the solid, or in its
  /// interior, as wanted: by parts of it where it takes that. False once interrupted.
  [[nodiscard]] bool lies(Place wanted, const PreciseVector& centre, const Real& half_width,
                          const Hook& interrupted) const;

  /// No smaller than the distance of any point of the solid from `centre`.
  [[nodiscard]] Real reach(const PreciseVector& centre) const;

 private:
  using Solid = std::variant<std::shared_ptr<const MeshSolid>, PosedPrimitive>;

  SetExpression set_;
  std::vector<Solid> solids_;  ///< of each primitive
};

}  // namespace verisq::verify
