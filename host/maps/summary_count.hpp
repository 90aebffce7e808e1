/// The books of a map: what one more row adds to its summary.
#pragma once

#include <algorithm>

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

}  // namespace verisq
