/// What the summary of a finished map has to say of its rows.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <verisq/map.hpp>

namespace verisq {

inline void expect_summary_of_rows(const MapSummary& summary, std::span<const MapResult> rows) {
  MapSummary expected;
  expected.minimum_lo = expected.minimum_hi = infinity;
  for (const auto& [distance, status] : rows) {
    if (status == Status::device_verified) ++expected.device_verified;
    if (status == Status::host_verified) ++expected.host_verified;
    if (status == Status::wide) ++expected.wide;
    expected.minimum_lo = std::min(expected.minimum_lo, distance.lo);
    expected.minimum_hi = std::min(expected.minimum_hi, distance.hi);
    expected.largest_width = std::max(expected.largest_width, distance.width());
  }
  EXPECT_EQ(summary.points, rows.size());
  EXPECT_EQ(summary.device_verified, expected.device_verified);
  EXPECT_EQ(summary.host_verified, expected.host_verified);
  EXPECT_EQ(summary.wide, expected.wide);
  EXPECT_EQ(summary.minimum_lo, expected.minimum_lo);
  EXPECT_EQ(summary.minimum_hi, expected.minimum_hi);
  EXPECT_EQ(summary.largest_width, expected.largest_width);
  EXPECT_FALSE(summary.interrupted);
}

}  // namespace verisq
