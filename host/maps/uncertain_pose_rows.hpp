/// Distances of points to models of uncertain pose: of convex solids, and by dividing where the model may see them.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"
#include "verisq/model.hpp"

namespace verisq {

// Distances of points to convex solids of uncertain pose: their ends follow from convexity (docs/mathematics.md §27).

class ConvexPoseRows {
 public:
  /// `options` are those of the maps of each solid at the nominal pose. Throws like the constructors of Mapper.
  /// Precondition: is_union_of_convex.
  ConvexPoseRows(const Model& model, const PoseUncertainty& bounds, const MapOptions& options);
  ~ConvexPoseRows();
  ConvexPoseRows(ConvexPoseRows&&) noexcept;
  ConvexPoseRows& operator=(ConvexPoseRows&&) noexcept;

  /// Bounds of each point's distances at every pose; an end is infinite if nothing is proven. None if interrupted.
  [[nodiscard]] std::vector<Enclosure> operator()(std::span<const Point> points);

 private:
  struct Solid;

  PoseUncertainty bounds_;
  std::vector<Solid> solids_;
};

// Distances of points to a model of uncertain pose, by dividing where the model may see each point
// (docs/mathematics.md §27).

/// Fills the rows of as many points, with the model at its nominal pose; false: interrupted.
using NominalRows = std::function<bool(std::span<const Point>, std::span<MapResult>)>;

/// For each point an enclosure of its distances at every pose, with a status that states whether a device has proven
/// all of its parts (otherwise host_verified). Cubes that may contain the smallest or the largest distance are halved,
/// until their edges are 1/divisions of the first's. A cube's distances are those of its centre, more or less half its
/// diagonal. None if interrupted; `enough`, polled between halvings, ends them early. Precondition: divisions >= 1.
[[nodiscard]] std::vector<MapResult> subdivided(const PoseUncertainty& bounds, unsigned divisions,
                                                std::span<const Point> points, const NominalRows& rows,
                                                const std::function<bool()>& enough);

}  // namespace verisq
