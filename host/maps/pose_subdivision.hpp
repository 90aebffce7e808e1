/// Distances of points to a model of uncertain pose, by dividing where the model may see each point
/// (docs/mathematics.md §27).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "verisq/map_result.hpp"
#include "verisq/model.hpp"
#include "verisq/pose_uncertainty.hpp"

namespace verisq {

/// Fills the rows of as many points, with the model at its nominal pose; false: interrupted.
using NominalRows = std::function<bool(std::span<const Point>, std::span<MapResult>)>;

/// For each point an enclosure of its distances at every pose, and whether a device has proven all that it rests on
/// (otherwise host_verified). Cubes are halved where the smallest or the largest distance may be, until their edges are
/// 1/divisions of the first's; a cube's distances are those of its centre, more or less half its diagonal. None if
/// interrupted; `enough`, polled between halvings, ends them early. Precondition: divisions >= 1.
[[nodiscard]] std::vector<MapResult> subdivided(const PoseUncertainty& bounds, unsigned divisions,
                                                std::span<const Point> points, const NominalRows& rows,
                                                const std::function<bool()>& enough);

}  // namespace verisq
