/// The columns of maps that are tables: what each holds, and which a format has unless others are asked for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <verisq/map_file.hpp>
#include <verisq/map_result.hpp>
#include <verisq/mesh.hpp>

#include "host/files/map_format.hpp"

namespace verisq {

/// A row of a map that is being written.
struct MapRow {
  std::uint64_t index;
  const Point* point;  ///< null where there is none: of triangles and poses
  MapResult result;
  const ClosestPoint* closest;  ///< null where the map has none
  const ClosestPoints* pair;    ///< likewise, of poses
};

/// Precondition: none of those that are whole numbers or words; where there is no point no coordinate. The width is
/// rounded upward.
[[nodiscard]] double number_in(MapColumn column, const MapRow& row);

/// Precondition: a row with closest points.
[[nodiscard]] bool is_unique(const MapRow& row);

/// Of the deciding primitive; -1 where it is not known.
[[nodiscard]] std::int32_t primitive_in(const ClosestPoint& closest);

/// Those of closest points, in their order.
[[nodiscard]] std::vector<MapColumn> columns_of_closest_points(MapElements elements);

/// The rows of one call of `MapFormat::append`, with the points of a mesh where it gives none. Views of all that it is
/// made of.
class AppendedRows {
 public:
  /// `first` is the index of the first of them.
  AppendedRows(const Mesh* mesh, MapElements elements, std::uint64_t first, const MapChunk& chunk);

  [[nodiscard]] std::size_t size() const { return results_.size(); }
  [[nodiscard]] MapRow operator[](std::size_t k) const {
    return {first_ + k, points_.empty() ? nullptr : &points_[k], results_[k], closest_.empty() ? nullptr : &closest_[k],
            pairs_.empty() ? nullptr : &pairs_[k]};
  }

 private:
  std::uint64_t first_;
  std::span<const Point> points_;
  std::span<const MapResult> results_;
  std::span<const ClosestPoint> closest_;
  std::span<const ClosestPoints> pairs_;
};

}  // namespace verisq
