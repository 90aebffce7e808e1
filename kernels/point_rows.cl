// This file implements the end of a map on the device: enclosures in model units, rounded outward; whether they are as
// tight as was asked for; the rows in the caller's memory; and the sums of a summary.

// Of enum Status in include/verisq/map_result.hpp.
#define DEVICE_VERIFIED 0
#define WIDE 2

#define SIGN_BIT 0x8000000000000000UL
#define HIDDEN_BIT 0x10000000000000UL
#define EXPONENT_BIAS 1023
#define MANTISSA_BITS 52

// The largest multiple of 2^-1074 that is at most |x| 2^-exponent, counted in those; `exact` says whether it is that.
// By integers, for a device may flush subnormal results. Precondition: x is finite, |x| 2^-exponent <= 2^-1022.
ALWAYS_INLINE ulong subnormal_count(double x, int exponent, int* exact) {
  const ulong magnitude = as_ulong(x) & ~SIGN_BIT;
  const int biased = (int)(magnitude >> MANTISSA_BITS);
  const ulong digits = biased > 0 ? (magnitude & (HIDDEN_BIT - 1)) | HIDDEN_BIT : magnitude;
  const int shift = exponent - (max(biased, 1) - 1); // |x| = digits 2^(max(biased, 1) - 1 - 1074)
  if (shift > MANTISSA_BITS) {
    *exact = digits == 0;
    return 0;
  }
  // To the left there is room: the result is at most 2^52.
  const ulong count = shift > 0 ? digits >> shift : digits << -shift;
  *exact = shift <= 0 || count << shift == digits;
  return count;
}

// The largest number that is at most x 2^-exponent; NaN where x is. `factor` is 2^exponent, `inverse` its reciprocal,
// both exact. The product with a power of two is exact unless it underflows or overflows, and where it leads back it is.
// Otherwise it is
//   infinite, and x is not: then the largest number of all is a lower bound if x is positive; none is if x is negative;
//   or larger than 2^-1022, and exact (a device that flushes subnormal results has lost the way back);
//   or 2^-1022 or less, rounded or flushed: then the integers above tell the count, cut off; that is a lower bound if x
//   is positive; if x is negative and something was cut off, the count after it is.
// The bits of a number that is not larger than 2^-1022 are its count.
ALWAYS_INLINE double scaled_down(double x, double factor, double inverse) {
  const double y = x * inverse;
  if (y * factor == x || isnan(x)) return y;
  if (isinf(y)) return y > 0.0 ? DBL_MAX : y;
  if (fabs(y) > SMALLEST_NORMAL) return y;
  int exact;
  const int exponent = (int)(as_ulong(factor) >> MANTISSA_BITS) - EXPONENT_BIAS;
  const ulong count = subnormal_count(x, exponent, &exact);
  if (x > 0.0) return as_double(count);
  return as_double((exact ? count : count + 1) | SIGN_BIT);
}

// What kernels and host sum up of the rows of a work-group; RowSums in host/batches/row_sums.hpp.
typedef struct {
  double minimum_lo, minimum_hi, largest_width; // of the rows that are not open
  uint verified, wide, wide_inside, open;       // open rows are in no other count
} row_sums;

ALWAYS_INLINE row_sums no_rows() {
  const row_sums none = {INFINITY, INFINITY, 0.0, 0, 0, 0, 0};
  return none;
}

ALWAYS_INLINE row_sums sum_of(row_sums a, row_sums b) {
  const row_sums both = {fmin(a.minimum_lo, b.minimum_lo),
                         fmin(a.minimum_hi, b.minimum_hi),
                         fmax(a.largest_width, b.largest_width),
                         a.verified + b.verified,
                         a.wide + b.wide,
                         a.wide_inside + b.wide_inside,
                         a.open + b.open};
  return both;
}

// Likewise of each lane.
CALLED_ON_PROCESSORS real lanes_scaled_down(real x, double factor, double inverse) {
  double lanes[VECTOR_WIDTH];
  STORE(x, 0, lanes);
#pragma nounroll
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) lanes[lane] = scaled_down(lanes[lane], factor, inverse);
  return LOAD(0, lanes);
}

// -1 in the first `count` lanes.
ALWAYS_INLINE integer first_lanes(uint count) {
  long lanes[VECTOR_WIDTH];
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) lanes[lane] = lane < count ? -1 : 0;
  return LOAD(0, lanes);
}

ALWAYS_INLINE uint lanes_in(integer mask) {
  long lanes[VECTOR_WIDTH];
  STORE(mask, 0, lanes);
  uint count = 0;
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) count -= (int)lanes[lane];
  return count;
}

ALWAYS_INLINE double least_lane(real x) {
  double lanes[VECTOR_WIDTH];
  STORE(x, 0, lanes);
  double least = lanes[0];
  for (uint lane = 1; lane < VECTOR_WIDTH; ++lane) least = fmin(least, lanes[lane]);
  return least;
}

// At most `tolerance` wide, as `verified` in include/verisq/enclosure.hpp has it: not where anything is NaN.
ALWAYS_INLINE integer verified_rows(real lo, real hi, real tolerance) {
  return MASK(lo <= hi) & MASK(hi - lo <= tolerance);
}

// The largest of the coordinates of each point, in model units.
ALWAYS_INLINE real largest_coordinate(ulong group, global const double* xs, global const double* ys,
                                      global const double* zs, double inverse) {
  return fmax(fmax(fabs(LOAD(group, xs)), fabs(LOAD(group, ys))), fabs(LOAD(group, zs))) * inverse;
}

// As tight as the methods get, in model units: `inside` of points proven inside, else `outside` times the larger of
// `radius` and the largest coordinate (host/maps/tightest_enclosure.hpp). NaN, as which no row is tight, where the coordinate has
// left the device's numbers.
ALWAYS_INLINE real tightest_width(real hi, real largest, double inside, double outside, double radius) {
  const real of_outside = select(REAL(NAN), outside * fmax(largest, REAL(radius)), MASK(isfinite(largest)));
  return select(of_outside, REAL(inside), MASK(hi < 0.0));
}

// The first `count` lanes to memory, `first` the place of the first.
CALLED_ON_PROCESSORS void store_first(real x, global double* memory, ulong first, ulong stride, uint count) {
  double lanes[VECTOR_WIDTH];
  STORE(x, 0, lanes);
#pragma nounroll
  for (uint lane = 0; lane < count; ++lane) memory[first + lane * stride] = lanes[lane];
}

ALWAYS_INLINE void strided_store(real x, global double* memory, ulong first, ulong stride, uint count) {
  if (count < VECTOR_WIDTH) {
    store_first(x, memory, first, stride, count);
  } else if (stride == 1) {
    STORE(x, 0, memory + first);
  } else {
    double lanes[VECTOR_WIDTH];
    STORE(x, 0, lanes);
#pragma unroll
    for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) memory[first + lane * stride] = lanes[lane];
  }
}

// Likewise the status of rows that are good, or not.
CALLED_ON_PROCESSORS void store_statuses(integer good, global uchar* memory, ulong first, ulong stride, uint count) {
  long lanes[VECTOR_WIDTH];
  STORE(good, 0, lanes);
#pragma nounroll
  for (uint lane = 0; lane < count; ++lane) memory[first + lane * stride] = lanes[lane] ? DEVICE_VERIFIED : WIDE;
}

// `all`: all lanes are to be written, and good.
ALWAYS_INLINE void store_status(integer good, bool all, global uchar* memory, ulong first, ulong stride, uint count) {
  if (!all) {
    store_statuses(good, memory, first, stride, count);
    return;
  }
#pragma unroll
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) memory[first + lane * stride] = DEVICE_VERIFIED;
}

// Row n of `size` is written to memory_lo[offset_lo + n * stride_lo] and likewise, in sums that wrap. A work-group takes
// `vectors` vectors a work-item; work-items that are neighbours take vectors that are, so that their loads are, too. A
// row at most `tolerance` wide is verified; with a tolerance of 0 one as tight as the methods get; otherwise such a row
// stays wide. Rows that are none of these are open: written as wide, for the host to find. `sums`: one a work-group.
kernel void point_rows(ulong size, uint vectors, double factor, double inverse, double tolerance, double inside,
                       double outside, double radius, global const double* xs, global const double* ys,
                       global const double* zs, global const double* union_los, global const double* union_his,
                       global double* memory_lo, global double* memory_hi, global uchar* memory_status, ulong offset_lo,
                       ulong offset_hi, ulong offset_status, ulong stride_lo, ulong stride_hi, ulong stride_status,
                       global row_sums* sums, local row_sums* of_items) {
  const uint item = get_local_id(0);
  const uint items = get_local_size(0);
  row_sums own = no_rows();
  real minimum_lo = REAL(INFINITY);
  real minimum_hi = REAL(INFINITY);
  real negative_width = REAL(0.0);
  for (uint v = 0; v < vectors; ++v) {
    const ulong group = (get_group_id(0) * vectors + v) * items + item;
    const ulong first = group * VECTOR_WIDTH;
    if (first >= size) break;
    const uint count = min((ulong)VECTOR_WIDTH, size - first);
    const real scaled_lo = LOAD(group, union_los);
    const real scaled_hi = LOAD(group, union_his);
    real lo = scaled_lo * inverse;
    real hi = scaled_hi * inverse;
    real limit = REAL(tolerance);
    if (tolerance == 0.0) {
      const real largest = largest_coordinate(group, xs, ys, zs, inverse);
      limit = tightest_width(hi, largest, inside, outside, radius);
    }
    integer good = verified_rows(lo, hi, limit);
    // As a rule one multiplication an end, which is exact where it leads back, and all rows are verified.
    const integer exact = MASK(lo * factor == scaled_lo) & MASK(hi * factor == scaled_hi);
    integer settled = INTEGER(-1);
    const bool all = count == VECTOR_WIDTH && !any(~(good & exact));
    if (all) {
      own.verified += VECTOR_WIDTH;
    } else {
      const integer known = first_lanes(count);
      lo = lanes_scaled_down(scaled_lo, factor, inverse);
      hi = -lanes_scaled_down(-scaled_hi, factor, inverse);
      const real largest = largest_coordinate(group, xs, ys, zs, inverse);
      const integer tightest = verified_rows(lo, hi, tightest_width(hi, largest, inside, outside, radius));
      good = tolerance == 0.0 ? tightest : verified_rows(lo, hi, REAL(tolerance));
      settled = known & (good | tightest);
      own.verified += lanes_in(good & known);
      own.wide += lanes_in(settled & ~good);
      own.wide_inside += lanes_in(settled & ~good & MASK(lo < 0.0));
      own.open += lanes_in(known & ~settled);
    }
    strided_store(lo, memory_lo, offset_lo + first * stride_lo, stride_lo, count);
    strided_store(hi, memory_hi, offset_hi + first * stride_hi, stride_hi, count);
    store_status(good, all, memory_status, offset_status + first * stride_status, stride_status, count);
    minimum_lo = fmin(minimum_lo, select(REAL(INFINITY), lo, settled));
    minimum_hi = fmin(minimum_hi, select(REAL(INFINITY), hi, settled));
    negative_width = fmin(negative_width, select(REAL(0.0), lo - hi, settled));
  }
  own.minimum_lo = least_lane(minimum_lo);
  own.minimum_hi = least_lane(minimum_hi);
  own.largest_width = -least_lane(negative_width);
  of_items[item] = own;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item > 0) return;
  for (uint other = 1; other < items; ++other) own = sum_of(own, of_items[other]);
  sums[get_group_id(0)] = own;
}
