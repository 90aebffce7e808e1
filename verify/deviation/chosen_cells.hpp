/// Which cells have to be smaller so that a mean, a percentile or a share is known better; nothing is proven by it.
#pragma once

#include <span>
#include <vector>

#include "verify/deviation/weighted_cells.hpp"
#include "verisq/area_within.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// Each of them marks what leaves most open in `chosen`, and nothing where the enclosure is as narrow as allowed: those
/// of the mean, of the least distance that a part of all weight does not exceed, of the share within a distance.
/// Precondition: as many chosen as cells, of which the enclosure is.
void choose_for_mean(std::span<const WeightedCell> cells, const Enclosure& mean, double allowed,
                     std::vector<bool>& chosen);
void choose_for_percentile(std::span<const WeightedCell> cells, const Enclosure& value, double part, double allowed,
                           std::vector<bool>& chosen);
void choose_for_share(std::span<const WeightedCell> cells, const AreaWithin& within, double distance, double allowed,
                      std::vector<bool>& chosen);

}  // namespace verisq::verify
