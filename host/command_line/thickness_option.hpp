/// Options that say how thick a cortex is: --thickness, once or by heights, --axis.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/canal.hpp>
#include <verisq/features.hpp>

namespace verisq::command_line {

/// Of `texts`, at least one: "T" alone, or several "AT,T", where AT is a height along `axis` or the name of a landmark
/// that has one. Without `axis` heights are along the landmarks' shaft, from its distal to its proximal end, where they
/// name both, else along z. Ascending, whatever their order. Throws Error(input).
[[nodiscard]] CorticalThickness thickness_of(const std::vector<std::string>& texts, const std::optional<Point>& axis,
                                             const FemurLandmarks& landmarks);

}  // namespace verisq::command_line
