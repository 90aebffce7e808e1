/// A model's solid to nearest: which points it contains, by which primitive; and its surface along a line.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>
#include <verisq/model.hpp>

#include "host/tessellation/placed_primitive.hpp"

namespace verisq::tessellation {

class Solid {
 public:
  /// The model must outlive it.
  explicit Solid(const Model& model);

  [[nodiscard]] const std::vector<PlacedPrimitive>& primitives() const { return primitives_; }

  [[nodiscard]] bool contains(const Eigen::Vector3d& point) const;

  /// The same of a point of which it is known whether primitive k contains it.
  [[nodiscard]] bool contains(const Eigen::Vector3d& point, std::size_t k, bool in_k) const;

  /// `PlacedPrimitive::level` through the set operations, at most 0 in the solid, and the primitive that decides it.
  struct Level {
    double value;
    std::size_t primitive;
  };
  [[nodiscard]] Level level(const Eigen::Vector3d& point) const;

  /// The direction in which the level grows, of unit length, from differences over `step`; zero where there is none.
  [[nodiscard]] Eigen::Vector3d outward(const Eigen::Vector3d& point, double step) const;

  /// Where the line from `inside` to `outside` leaves the solid: in fractions of the way. Precondition: the solid
  /// contains the one and not the other.
  [[nodiscard]] double crossing(const Eigen::Vector3d& inside, const Eigen::Vector3d& outside) const;

  /// The point of the surface nearest to `point` on the line through it, at most `reach` away; `outward`, of unit
  /// length, leads out of the solid there. Nothing where both ends are inside or outside.
  [[nodiscard]] std::optional<Eigen::Vector3d> surface_along(const Eigen::Vector3d& point,
                                                             const Eigen::Vector3d& outward, double reach) const;

 private:
  const Model& model_;
  std::vector<PlacedPrimitive> primitives_;
};

}  // namespace verisq::tessellation
