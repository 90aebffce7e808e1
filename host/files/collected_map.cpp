/// Rows of a map, stored by column.
#include "host/files/collected_map.hpp"

#include <fmt/format.h>

namespace verisq {

CollectedMap::CollectedMap(const MapKind& kind) : mesh_(kind.mesh), elements_(kind.elements) {
  const std::size_t rows = complete_size();
  lo_.reserve(rows);
  hi_.reserve(rows);
  statuses_.reserve(rows);
}

void CollectedMap::append(std::span<const Point> points, std::span<const MapResult> results) {
  if (mesh_ == nullptr) points_.insert(points_.end(), points.begin(), points.end());
  for (const MapResult& result : results) {
    lo_.push_back(result.distance.lo);
    hi_.push_back(result.distance.hi);
    statuses_.push_back(static_cast<std::uint8_t>(result.status));
  }
}

void CollectedMap::check_complete(const OutputFile& output) const {
  if (complete_size() == statuses_.size()) return;
  output.fail(fmt::format("{} results for {} {}", statuses_.size(), complete_size(),
                          elements_ == MapElements::vertices ? "vertices" : "triangles"));
}

std::size_t CollectedMap::complete_size() const {
  return elements_ == MapElements::vertices ? vertices().size() : triangles().size();
}

std::span<const Point> CollectedMap::vertices() const {
  return mesh_ == nullptr ? points_ : mesh_->vertices;
}

std::span<const std::array<std::uint32_t, 3>> CollectedMap::triangles() const {
  if (mesh_ == nullptr) return {};
  return mesh_->triangles;
}

}  // namespace verisq
