/// Maps of models at uncertain poses: rows at the nominal pose, widened by what the motions may change.
#pragma once

#include <algorithm>
#include <chrono>
#include <concepts>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/maps/bracket_map.hpp"
#include "host/maps/chunk_pace.hpp"
#include "host/maps/convex_pose_rows.hpp"
#include "host/maps/map_copies.hpp"
#include "host/maps/pose_subdivision.hpp"
#include "host/maps/summary_count.hpp"
#include "verify/placement/displaced_point.hpp"

namespace verisq {

/// What the motions change the distance of a query by, at most. `reach` is that of the model (of poses).
[[nodiscard]] inline double change_of(const PoseUncertainty& bounds, const Point& point, double /*reach*/) {
  return verify::DisplacedPoint(bounds, point).reach();
}
/// The motions are affine: no point of a triangle is taken farther than a corner.
[[nodiscard]] inline double change_of(const PoseUncertainty& bounds, const Triangle& triangle, double /*reach*/) {
  double reach = 0.0;
  for (const Point& corner : triangle) reach = std::max(reach, verify::DisplacedPoint(bounds, corner).reach());
  return reach;
}
[[nodiscard]] inline double change_of(const PoseUncertainty& /*bounds*/, const Pose& /*pose*/, double reach) {
  return reach;
}

template <class Query>
class UncertainPoseMap {
 public:
  /// `options` are those of the widened rows, `map` makes those at the nominal pose; `reach` is how far the motions
  /// take the model. `convex` is given of points about an exact union of convex primitives.
  UncertainPoseMap(const MapOptions& options, double reach, BracketMap<Query> map,
                   std::optional<ConvexPoseRows> convex = {})
      : options_(options), reach_(reach), map_(std::move(map)), convex_(std::move(convex)) {}

  /// As Mapper::map.
  MapSummary map(const Source<Query>& source, const Sink<Query>& sink) {
    if (!options_.pose_uncertainty) return map_.map(source, sink);
    MapSummary summary = empty_summary();
    std::vector<Query> queries;
    const bool of_blocks = !options_.out_of_time && options_.pose_divisions == 1;
    ChunkPace pace = of_blocks ? ChunkPace::of_blocks(rows_per_block, most_at_once) : ChunkPace();
    do {
      queries.resize(pace.size());
      queries.resize(source(queries));
      const auto start = std::chrono::steady_clock::now();
      const std::vector<MapResult> rows = map_chunk(queries, summary);
      pace.took(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      for (const MapResult& row : rows) count(summary, row);
      if (!rows.empty()) sink(std::span(queries).first(rows.size()), rows, {});
    } while (!queries.empty() && !summary.interrupted);
    return summary;
  }

  MapSummary map_in_memory(const typename QueriesInMemory<Query>::type& queries, const ResultColumns& rows) {
    if (!options_.pose_uncertainty) return map_.map_in_memory(queries, rows);
    return map_copies<Query>(queries, rows, [this](const auto& source, const auto& sink) { return map(source, sink); });
  }

  [[nodiscard]] const MapOptions& options() const { return options_; }

 private:
  /// None, or fewer than the queries, if interrupted.
  [[nodiscard]] std::vector<MapResult> map_chunk(std::span<const Query> queries, MapSummary& summary) {
    std::vector<MapResult> rows = changed_rows(queries, summary);
    if constexpr (std::same_as<Query, Point>) narrow(rows, queries, summary);
    for (MapResult& row : rows) {
      if (!verified(row.distance, options_.tolerance)) row.status = Status::wide;
    }
    return rows;
  }

  [[nodiscard]] std::vector<MapResult> changed_rows(std::span<const Query> queries, MapSummary& summary) {
    if constexpr (std::same_as<Query, Point>) {
      if (options_.pose_divisions > 1) {
        const auto rows = [&](std::span<const Point> points, std::span<MapResult> results) {
          return nominal_rows(points, results, summary) == points.size();
        };
        const auto enough = [this] { return options_.out_of_time && options_.out_of_time(); };
        return subdivided(*options_.pose_uncertainty, options_.pose_divisions, queries, rows, enough);
      }
    }
    std::vector<MapResult> rows(queries.size());
    rows.resize(nominal_rows(queries, rows, summary));
    for (std::size_t i = 0; i < rows.size(); ++i) widen(rows[i], queries[i]);
    return rows;
  }

  /// To what convexity proves, too.
  void narrow(std::vector<MapResult>& rows, std::span<const Point> queries,
              MapSummary& summary) requires(std::same_as<Query, Point>) {
    if (!convex_ || rows.size() != queries.size()) return;
    const std::vector<Enclosure> proven = (*convex_)(queries);
    if (proven.size() != rows.size()) {
      summary.interrupted = true;
      rows.clear();
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Enclosure& distance = rows[i].distance;
      const Enclosure widened = distance;
      using verify::Interval;
      const Interval radius(options_.point_radius);
      distance.lo = std::max(widened.lo, (Interval(proven[i].lo) - radius).lower());
      distance.hi = std::min(widened.hi, (Interval(proven[i].hi) + radius).upper());
      if (distance != widened) rows[i].status = Status::host_verified;
    }
  }

  void widen(MapResult& row, const Query& query) const {
    using verify::Interval;
    const Interval change(change_of(*options_.pose_uncertainty, query, reach_));
    row.distance.hi = (Interval(row.distance.hi) + change).upper();
    row.distance.lo = (Interval(row.distance.lo) - change).lower();
    if constexpr (!std::same_as<Query, Point>) row.distance.lo = std::max(0.0, row.distance.lo);
    // Rows that are wide at the nominal pose are the host's, too.
    if (row.status == Status::wide) row.status = Status::host_verified;
  }

  /// How many are filled; what the run took is added to the summary.
  [[nodiscard]] std::size_t nominal_rows(std::span<const Query> queries, std::span<MapResult> rows,
                                         MapSummary& summary) {
    const MapSummary run = map_.map_in_memory(queries, rows);
    summary.device = run.device;
    summary.notice = run.notice;
    summary.device_seconds += run.device_seconds;
    summary.host_seconds += run.host_seconds;
    summary.interrupted = summary.interrupted || run.interrupted;
    summary.out_of_time = summary.out_of_time || run.out_of_time;
    return run.points;
  }

  static constexpr std::size_t most_at_once = std::size_t{1} << 16U;

  MapOptions options_;
  double reach_;
  BracketMap<Query> map_;
  std::optional<ConvexPoseRows> convex_;
};

}  // namespace verisq
