/// Names and numbers of columns.
#include "host/files/map_columns.hpp"

#include <algorithm>
#include <cmath>

#include "host/files/finite_middle.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

/// At least hi - lo, which a binary64 number need not be.
double width_of(const Enclosure& distance) {
  if (!std::isfinite(distance.lo) || !std::isfinite(distance.hi)) return infinity;
  return verify::subtract(distance.hi, distance.lo, verify::Direction::up);
}

/// The ends of the box of the point, then those of the normal, in the order of the columns.
double end_in(MapColumn column, const ClosestPoint& closest) {
  const int offset = static_cast<int>(column) - static_cast<int>(MapColumn::closest_x_lo);
  const EnclosedPoint& box = offset < 6 ? closest.point : closest.normal;
  const Enclosure& coordinate = box[static_cast<std::size_t>(offset % 6 / 2)];
  return offset % 2 == 0 ? coordinate.lo : coordinate.hi;
}

}  // namespace

double number_in(MapColumn column, const MapRow& row) {
  if (is_of_closest_point(column)) return end_in(column, *row.closest);
  const auto& [lo, hi] = row.result.distance;
  switch (column) {
    case MapColumn::x: return (*row.point)[0];
    case MapColumn::y: return (*row.point)[1];
    case MapColumn::z: return (*row.point)[2];
    case MapColumn::hi: return hi;
    case MapColumn::mid: return finite_middle(lo, hi);
    case MapColumn::width: return width_of(row.result.distance);
    default: return lo;
  }
}

std::int32_t primitive_in(const ClosestPoint& closest) {
  return closest.primitive ? static_cast<std::int32_t>(*closest.primitive) : -1;
}

std::vector<MapColumn> columns_of_closest_points() {
  std::vector<MapColumn> columns;
  for (int k = static_cast<int>(MapColumn::unique); k <= static_cast<int>(MapColumn::primitive); ++k) {
    columns.push_back(static_cast<MapColumn>(k));
  }
  return columns;
}

AppendedRows::AppendedRows(const Mesh* mesh, MapElements elements, std::uint64_t first, const MapChunk& chunk)
    : first_(first), points_(chunk.points), results_(chunk.results), closest_(chunk.closest) {
  if (!points_.empty() || mesh == nullptr || elements != MapElements::vertices) return;
  const std::span<const Point> vertices = mesh->vertices;
  points_ = vertices.subspan(static_cast<std::size_t>(first), results_.size());
}

}  // namespace verisq
