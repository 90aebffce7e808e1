/// The books of a map: what one more row adds to its summary.
#pragma once

#include <algorithm>
#include <span>

#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// Of no rows: the smallest distance of none is infinite.
[[nodiscard]] inline MapSummary empty_summary() {
  MapSummary summary;
  summary.minimum_lo = summary.minimum_hi = infinity;
  return summary;
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
  summary.minimum_lo = std::min(summary.minimum_lo, row.distance.lo);
  summary.minimum_hi = std::min(summary.minimum_hi, row.distance.hi);
  summary.largest_width = std::max(summary.largest_width, row.distance.width());
}

/// Likewise all of these, without a write to the summary for each.
inline void count(MapSummary& summary, std::span<const MapResult> rows) {
  MapSummary of_rows = empty_summary();
  for (const MapResult& row : rows) count(of_rows, row);
  summary.points += of_rows.points;
  summary.device_verified += of_rows.device_verified;
  summary.host_verified += of_rows.host_verified;
  summary.wide += of_rows.wide;
  summary.wide_inside += of_rows.wide_inside;
  summary.minimum_lo = std::min(summary.minimum_lo, of_rows.minimum_lo);
  summary.minimum_hi = std::min(summary.minimum_hi, of_rows.minimum_hi);
  summary.largest_width = std::max(summary.largest_width, of_rows.largest_width);
}

}  // namespace verisq
