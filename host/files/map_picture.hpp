/// What a map draws, read back, and what it should draw.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>
#include <verisq/map_file.hpp>
#include <verisq/mesh.hpp>

namespace verisq {

/// The geometry of a map and the colours of its rows, as a viewer takes them.
struct MapPicture {
  std::vector<Point> points;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<std::int64_t> vertex_cells;  ///< where there are no triangles: the point of each
  std::vector<std::int64_t> offsets;       ///< behind the last corner of each cell
  std::vector<double> middles;             ///< `dist_mid`

  /// The first number, bit for bit, that is not as the writer writes it for `mesh`, of a map of `elements` with the
  /// enclosures [lo, hi]. Precondition: as many `lo`, `hi` and `middles`.
  [[nodiscard]] std::optional<MapDifference> difference_from(const Mesh& mesh, MapElements elements,
                                                             std::span<const double> lo,
                                                             std::span<const double> hi) const;
};

}  // namespace verisq
