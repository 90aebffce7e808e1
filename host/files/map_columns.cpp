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

}  // namespace

double number_in(MapColumn column, const MapRow& row) {
  const auto& [lo, hi] = row.result.distance;
  switch (column) {
    case MapColumn::x: return (*row.point)[0];
    case MapColumn::y: return (*row.point)[1];
    case MapColumn::z: return (*row.point)[2];
    case MapColumn::hi: return hi;
    case MapColumn::mid: return finite_middle(lo, hi);
    case MapColumn::width: return width_of(row.result.distance);
    case MapColumn::index:
    case MapColumn::status:
    case MapColumn::lo: break;
  }
  return lo;
}

AppendedRows::AppendedRows(const Mesh* mesh, MapElements elements, std::uint64_t first, std::span<const Point> points,
                           std::span<const MapResult> results)
    : first_(first), points_(points), results_(results) {
  if (!points.empty() || mesh == nullptr || elements != MapElements::vertices) return;
  const std::span<const Point> vertices = mesh->vertices;
  points_ = vertices.subspan(static_cast<std::size_t>(first), results.size());
}

}  // namespace verisq
