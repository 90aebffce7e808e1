/// What a device sums up of rows: the books of a summary.
#pragma once

#include <cstdint>

namespace verisq::device {

/// As kernels/row_verdict.clh declares it. Rows that are open are in no other sum; `open_inside` are those of
/// them that are not proven outside.
struct RowSums {
  double minimum_lo, minimum_hi, largest_width;
  std::uint32_t verified, wide, wide_inside, open, open_inside;
};
static_assert(sizeof(RowSums) == 48);

/// What is asked of a row, in model units: at most `tolerance` wide, or with a tolerance of 0 as tight as the methods
/// get, which is `inside` where its lower end is below 0, else `outside` times the larger of `radius` and the point's
/// largest coordinate. As tight as that, but wider than the tolerance: wide for good. All others are open.
struct RowCriterion {
  double tolerance, inside, outside, radius;
};

}  // namespace verisq::device
