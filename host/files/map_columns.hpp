/// The columns of maps that are tables: what each holds, and which a format has unless others are asked for.
#pragma once

#include <cstdint>
#include <span>
#include <verisq/map_file.hpp>
#include <verisq/map_result.hpp>
#include <verisq/mesh.hpp>

namespace verisq {

/// A row of a map that is being written.
struct MapRow {
  std::uint64_t index;
  const Point* point;  ///< null where there is none: of triangles and poses
  MapResult result;
};

/// Precondition: neither index nor status; where there is no point no coordinate. The width is rounded upward.
[[nodiscard]] double number_in(MapColumn column, const MapRow& row);

/// The rows of one call of `MapFormat::append`, with the points of a mesh where it gives none. Views of all that it is
/// made of.
class AppendedRows {
 public:
  /// `first` is the index of the first of them.
  AppendedRows(const Mesh* mesh, MapElements elements, std::uint64_t first, std::span<const Point> points,
               std::span<const MapResult> results);

  [[nodiscard]] std::size_t size() const { return results_.size(); }
  [[nodiscard]] MapRow operator[](std::size_t k) const {
    return {first_ + k, points_.empty() ? nullptr : &points_[k], results_[k]};
  }

 private:
  std::uint64_t first_;
  std::span<const Point> points_;
  std::span<const MapResult> results_;
};

}  // namespace verisq
