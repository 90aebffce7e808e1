/// What a cell leaves open is its weight times the width of what is weighed, and the width of its weight times how far
/// that is from the result.
#include "verify/deviation/chosen_cells.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace verisq::verify {

namespace {

double middle_of(const Enclosure& e) {
  return 0.5 * e.lo + 0.5 * e.hi;
}

double open_in(const WeightedCell& cell, const Enclosure& value, double result) {
  const double from_result = std::max(std::abs(value.hi - result), std::abs(value.lo - result));
  return cell.weight.hi * (value.hi - value.lo) + cell.weight.width() * from_result;
}

}  // namespace

void choose_for_mean(std::span<const WeightedCell> cells, const Enclosure& mean, double allowed,
                     std::vector<bool>& chosen) {
  if (mean.hi - mean.lo <= allowed) return;
  double weight = 0.0;
  std::vector<std::pair<double, std::size_t>> widths;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    weight += middle_of(cells[i].weight);
    widths.emplace_back(open_in(cells[i], cells[i].mean, middle_of(mean)), i);
  }
  choose_widest(widths, allowed * weight, chosen);
}

void choose_for_percentile(std::span<const WeightedCell> cells, const Enclosure& value, double part, double allowed,
                           std::vector<bool>& chosen) {
  if (value.hi - value.lo <= allowed) return;
  double excess = 0.0;
  std::vector<std::pair<double, std::size_t>> widths;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double open = open_in(cells[i], part_up_to(cells[i], middle_of(value)), part);
    if (!(open > 0.0)) continue;
    widths.emplace_back(open, i);
    excess += open;
  }
  choose_widest(widths, excess * allowed / (value.hi - value.lo), chosen);
}

void choose_for_share(std::span<const WeightedCell> cells, const AreaWithin& within, double distance, double allowed,
                      std::vector<bool>& chosen) {
  if (within.share.width() <= allowed) return;
  double area = 0.0;
  std::vector<std::pair<double, std::size_t>> widths;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    area += middle_of(cells[i].weight);
    const double open = open_in(cells[i], part_up_to(cells[i], distance), middle_of(within.share));
    if (open > 0.0) widths.emplace_back(open, i);
  }
  choose_widest(widths, allowed * area, chosen);
}

}  // namespace verisq::verify
