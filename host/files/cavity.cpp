/// Sorts points into the boxes of areas.
#include <algorithm>
#include <utility>
#include <verisq/cavity.hpp>

#include "host/files/model_areas.hpp"

namespace verisq {
namespace {

bool holds(const AreaBox& box, const Point& point) {
  const auto within = [&](std::size_t k) { return box.lower[k] <= point[k] && point[k] <= box.upper[k]; };
  return within(0) && within(1) && within(2);
}

}  // namespace

Cavity cavity(std::vector<Point> points, std::span<const AreaBox> boxes, double weight_elsewhere) {
  Cavity result{std::move(points), {}, {}};
  for (const AreaBox& box : boxes) result.areas.push_back(box.area);
  result.area_of.reserve(result.points.size());
  for (const Point& point : result.points) {
    const auto first = std::ranges::find_if(boxes, [&](const AreaBox& box) { return holds(box, point); });
    result.area_of.push_back(static_cast<std::uint32_t>(first - boxes.begin()));
  }
  const bool all_within = std::ranges::none_of(result.area_of, [&](std::uint32_t k) { return k == boxes.size(); });
  if (!all_within) result.areas.push_back({std::string(elsewhere), weight_elsewhere});
  return result;
}

}  // namespace verisq
