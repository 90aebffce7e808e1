/// map_points on points that are already in memory, for tests.
#pragma once

#include <algorithm>
#include <span>
#include <vector>
#include <verisq/distance_map.hpp>

namespace verisq::oracle {

struct FinishedMap {
  std::vector<MapResult> rows;
  std::vector<Certificate> certificates;  ///< empty unless asked for
  MapSummary summary;
};

[[nodiscard]] inline FinishedMap map_in_memory(const Model& model, std::span<const Point> points,
                                               const MapOptions& options) {
  FinishedMap map;
  map.rows.reserve(points.size());
  std::size_t delivered = 0;
  const PointSource source = [&](std::span<Point> chunk) {
    const std::size_t count = std::min(chunk.size(), points.size() - delivered);
    std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(delivered), count, chunk.begin());
    delivered += count;
    return count;
  };
  const MapSink sink = [&](std::span<const Point>, std::span<const MapResult> rows,
                           std::span<const Certificate> certificates) {
    map.rows.insert(map.rows.end(), rows.begin(), rows.end());
    map.certificates.insert(map.certificates.end(), certificates.begin(), certificates.end());
  };
  map.summary = map_points(model, source, sink, options);
  return map;
}

}  // namespace verisq::oracle
