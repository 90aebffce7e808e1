/// Maps of points that are already in memory, for tests.
#pragma once

#include <algorithm>
#include <span>
#include <vector>
#include <verisq/map.hpp>

namespace verisq::oracle {

struct FinishedMap {
  std::vector<MapResult> rows;
  std::vector<Certificate> certificates;  ///< empty unless asked for
  MapSummary summary;
};

[[nodiscard]] inline FinishedMap map_in_memory(const UncertainModel& model, std::span<const Point> points,
                                               const MapOptions& options) {
  FinishedMap map;
  map.rows.reserve(points.size());
  std::size_t delivered = 0;
  const Source<Point> source = [&](std::span<Point> chunk) {
    const std::size_t count = std::min(chunk.size(), points.size() - delivered);
    std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(delivered), count, chunk.begin());
    delivered += count;
    return count;
  };
  const Sink<Point> sink = [&](std::span<const Point>, std::span<const MapResult> rows,
                               std::span<const Certificate> certificates) {
    map.rows.insert(map.rows.end(), rows.begin(), rows.end());
    map.certificates.insert(map.certificates.end(), certificates.begin(), certificates.end());
  };
  map.summary = PointMapper(model, options).map(source, sink);
  return map;
}

}  // namespace verisq::oracle
