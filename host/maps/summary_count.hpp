/// The books of a map: what one more row adds to its summary.
#pragma once

#include <algorithm>
#include <span>

#include "host/batches/row_sums.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// Of no rows: the smallest distance of none is infinite.
[[nodiscard]] inline MapSummary empty_summary() {
  MapSummary summary;
  summary.minimum_lo = summary.minimum_hi = infinity;
  return summary;
}

/// What rows with these extremes add to those of the summary.
inline void extend(MapSummary& summary, double minimum_lo, double minimum_hi, double largest_width) {
  summary.minimum_lo = std::min(summary.minimum_lo, minimum_lo);
  summary.minimum_hi = std::min(summary.minimum_hi, minimum_hi);
  summary.largest_width = std::max(summary.largest_width, largest_width);
}

inline void count(MapSummary& summary, const MapResult& row) {
  ++summary.points;
  switch (row.status) {
    case Status::device_verified: ++summary.device_verified; break;
    case Status::host_verified: ++summary.host_verified; break;
    case Status::wide:
      ++summary.wide;
      if (row.distance.lo < 0.0) ++summary.wide_inside;
      break;
  }
  extend(summary, row.distance.lo, row.distance.hi, row.distance.width());
}

/// Likewise what another summary counts.
inline void add(MapSummary& summary, const MapSummary& other) {
  summary.points += other.points;
  summary.device_verified += other.device_verified;
  summary.host_verified += other.host_verified;
  summary.wide += other.wide;
  summary.wide_inside += other.wide_inside;
  extend(summary, other.minimum_lo, other.minimum_hi, other.largest_width);
}

/// Likewise all of these, without a write to the summary for each.
inline void count(MapSummary& summary, std::span<const MapResult> rows) {
  MapSummary of_rows = empty_summary();
  for (const MapResult& row : rows) count(of_rows, row);
  add(summary, of_rows);
}

/// What rows say together that took the place of those of `earlier`, which tells how they were found.
[[nodiscard]] inline MapSummary recounted(const MapSummary& earlier, std::span<const MapResult> rows) {
  MapSummary summary = empty_summary();
  count(summary, rows);
  summary.device = earlier.device;
  summary.notice = earlier.notice;
  summary.device_seconds = earlier.device_seconds;
  summary.host_seconds = earlier.host_seconds;
  return summary;
}

/// Likewise what a device has summed up.
inline void count(MapSummary& summary, const device::RowSums& sums) {
  summary.points += std::uint64_t{sums.verified} + sums.wide;
  summary.device_verified += sums.verified;
  summary.wide += sums.wide;
  summary.wide_inside += sums.wide_inside;
  extend(summary, sums.minimum_lo, sums.minimum_hi, sums.largest_width);
}

}  // namespace verisq
