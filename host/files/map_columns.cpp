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

/// The ends of one box, then those of another, in the order of the columns from `first` on.
double end_in(MapColumn column, MapColumn first, const EnclosedPoint& one, const EnclosedPoint& other) {
  const int offset = static_cast<int>(column) - static_cast<int>(first);
  const Enclosure& coordinate = (offset < 6 ? one : other)[static_cast<std::size_t>(offset % 6 / 2)];
  return offset % 2 == 0 ? coordinate.lo : coordinate.hi;
}

}  // namespace

double number_in(MapColumn column, const MapRow& row) {
  if (is_of_closest_pair(column)) return end_in(column, MapColumn::on_a_x_lo, row.pair->on_a, row.pair->on_b);
  if (is_of_closest_point(column))
    return end_in(column, MapColumn::closest_x_lo, row.closest->point, row.closest->normal);
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

bool is_unique(const MapRow& row) {
  return row.pair == nullptr ? row.closest->unique : row.pair->unique;
}

std::int32_t primitive_in(const ClosestPoint& closest) {
  return closest.primitive ? static_cast<std::int32_t>(*closest.primitive) : -1;
}

std::vector<MapColumn> columns_of_closest_points(MapElements elements) {
  const bool pairs = elements == MapElements::poses;
  const MapColumn first = pairs ? MapColumn::on_a_x_lo : MapColumn::closest_x_lo;
  const MapColumn last = pairs ? MapColumn::on_b_z_hi : MapColumn::primitive;
  std::vector<MapColumn> columns{MapColumn::unique};
  for (int k = static_cast<int>(first); k <= static_cast<int>(last); ++k) columns.push_back(static_cast<MapColumn>(k));
  return columns;
}

AppendedRows::AppendedRows(const Mesh* mesh, MapElements elements, std::uint64_t first, const MapChunk& chunk)
    : first_(first),
      points_(chunk.points),
      results_(chunk.results),
      closest_(chunk.closest),
      pairs_(chunk.closest_pairs) {
  if (!points_.empty() || mesh == nullptr || elements != MapElements::vertices) return;
  const std::span<const Point> vertices = mesh->vertices;
  points_ = vertices.subspan(static_cast<std::size_t>(first), results_.size());
}

}  // namespace verisq
