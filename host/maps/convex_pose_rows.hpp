/// Distances of points to convex solids of uncertain pose: their ends follow from convexity (docs/mathematics.md §27).
#pragma once

#include <span>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"

namespace verisq {

class ConvexPoseRows {
 public:
  /// `options` are those of the maps of each solid at the nominal pose. Throws as the constructors of Mapper.
  /// Precondition: is_union_of_convex.
  ConvexPoseRows(const Model& model, const PoseUncertainty& bounds, const MapOptions& options);
  ~ConvexPoseRows();
  ConvexPoseRows(ConvexPoseRows&&) noexcept;
  ConvexPoseRows& operator=(ConvexPoseRows&&) noexcept;

  /// Bounds of each point's distances at every pose; an end is infinite where nothing is proven. None if interrupted.
  [[nodiscard]] std::vector<Enclosure> operator()(std::span<const Point> points);

 private:
  struct Solid;

  PoseUncertainty bounds_;
  std::vector<Solid> solids_;
};

}  // namespace verisq
