/// Mutants of point_columns.cl and point_rows.cl: what lies between the caller's memory and the kernels of distances.

#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array rows{
    Mutant{"columns: not scaled", "select(REAL(FAR_AWAY), y * factor, finite)", "select(REAL(FAR_AWAY), y, finite)"},
    Mutant{"columns: a coordinate twice", "strided_load(memory_z, offset_z + first * stride_z",
           "strided_load(memory_y, offset_z + first * stride_z"},
    Mutant{"columns: another one's offset", "strided_load(memory_z, offset_z + first * stride_z",
           "strided_load(memory_z, offset_y + first * stride_z"},
    Mutant{"columns: another one's stride", "strided_load(memory_z, offset_z + first * stride_z, stride_z",
           "strided_load(memory_z, offset_z + first * stride_z, stride_x"},
    Mutant{"columns: every stride is 1", "if (stride == 1) return LOAD(0, memory + first);",
           "return LOAD(0, memory + first);"},
    Mutant{"columns: whole vectors alone",
           "if (last < VECTOR_WIDTH - 1) return load_repeating(memory, first, stride, last);", ""},
    Mutant{"columns: lanes beyond the end", "memory[first + min(lane, last) * stride]", "memory[first]"},
    Mutant{"columns: NaN in x is passed on", "MASK(isfinite(x)) & MASK(isfinite(y))", "MASK(isfinite(y))"},
    Mutant{"columns: what is not finite is not told", "if (any(~all_finite)) atomic_or(refused, 1);", ""},
    Mutant{"columns: only the last vector is told of", "all_finite &= finite;", "all_finite = finite;"},
    Mutant{"columns: each work-item skips a vector", "get_global_id(0) * vectors + v;",
           "get_global_id(0) * (vectors + 1) + v;"},

    Mutant{"lower end to nearest", "lo = lanes_scaled_down(scaled_lo, factor, inverse);", ""},
    Mutant{"upper end to nearest", "hi = -lanes_scaled_down(-scaled_hi, factor, inverse);", ""},
    Mutant{"upper end rounded down", "hi = -lanes_scaled_down(-scaled_hi, factor, inverse);",
           "hi = lanes_scaled_down(scaled_hi, factor, inverse);"},
    Mutant{"lower ends are always exact", "MASK(lo * factor == scaled_lo) & MASK(hi * factor == scaled_hi)",
           "MASK(hi * factor == scaled_hi)"},
    Mutant{"upper ends are always exact", "MASK(lo * factor == scaled_lo) & MASK(hi * factor == scaled_hi)",
           "MASK(lo * factor == scaled_lo)"},
    Mutant{"ends are always exact", "!any(~(good & exact))", "!any(~good)"},
    Mutant{"overflow is infinite", "if (isinf(y)) return y > 0.0 ? DBL_MAX : y;", "if (isinf(y)) return y;"},
    Mutant{"overflow ends at the largest number", "if (isinf(y)) return y > 0.0 ? DBL_MAX : y;",
           "if (isinf(y)) return y > 0.0 ? DBL_MAX : -DBL_MAX;"},
    Mutant{"what was rounded to 2^-1022 is exact", "if (fabs(y) > SMALLEST_NORMAL) return y;",
           "if (fabs(y) >= SMALLEST_NORMAL) return y;"},
    Mutant{"what is below 2^-1022 is exact", "if (fabs(y) > SMALLEST_NORMAL) return y;",
           "if (fabs(y) > 0.0) return y;"},
    Mutant{"negative numbers cut off", "exact ? count : count + 1", "count"},
    Mutant{"positive numbers rounded away", "if (x > 0.0) return as_double(count);",
           "if (x > 0.0) return as_double(exact ? count : count + 1);"},
    Mutant{"exact where nothing is left", "*exact = digits == 0;", "*exact = 1;"},
    Mutant{"exact whatever is cut off", "*exact = shift <= 0 || count << shift == digits;", "*exact = 1;"},
    Mutant{"no hidden bit", "(magnitude & (HIDDEN_BIT - 1)) | HIDDEN_BIT", "magnitude & (HIDDEN_BIT - 1)"},
    Mutant{"subnormal numbers have a hidden bit", "biased > 0 ? (magnitude", "biased >= 0 ? (magnitude"},
    Mutant{"subnormal numbers of the wrong power", "(max(biased, 1) - 1); // ", "(biased - 1); // "},
    Mutant{"normal numbers of the wrong power", "(max(biased, 1) - 1); // ", "max(biased, 1); // "},
    Mutant{"shift to the wrong side", "digits >> shift : digits << -shift", "digits << shift : digits >> -shift"},
    Mutant{"a wrong sign", "(exact ? count : count + 1) | SIGN_BIT", "(exact ? count : count + 1)"},

    Mutant{"verified: an empty row", "return MASK(lo <= hi) & MASK(hi - lo <= tolerance);",
           "return MASK(hi - lo <= tolerance);"},
    Mutant{"verified: of any width", "return MASK(lo <= hi) & MASK(hi - lo <= tolerance);", "return MASK(lo <= hi);"},
    Mutant{"verified: the tightest whatever was asked for", "if (tolerance == 0.0) {", "if (tolerance >= 0.0) {"},
    Mutant{"verified: as tight as the methods get", "tolerance == 0.0 ? tightest : verified_rows",
           "tolerance >= 0.0 ? tightest : verified_rows"},
    Mutant{"tightest: inside as outside", "select(of_outside, REAL(inside), MASK(hi < 0.0))", "of_outside"},
    Mutant{"tightest: outside as inside", "select(of_outside, REAL(inside), MASK(hi < 0.0))", "REAL(inside)"},
    Mutant{"tightest: what may be outside as inside", "REAL(inside), MASK(hi < 0.0))",
           "REAL(inside), MASK(hi < inside))"},
    Mutant{"tightest: without the radius", "outside * fmax(largest, REAL(radius))", "outside * largest"},
    Mutant{"tightest: without the coordinate", "outside * fmax(largest, REAL(radius))", "outside * REAL(radius)"},
    Mutant{"tightest: coordinates in the device's unit", "fabs(LOAD(group, zs))) * inverse;",
           "fabs(LOAD(group, zs)));"},
    Mutant{"status: all that are whole are good", "count == VECTOR_WIDTH && !any(~(good & exact))",
           "count == VECTOR_WIDTH"},
    Mutant{"status: of whole vectors alone", "if (!all) {", "if (false) {"},
    Mutant{"status: all are good", "lanes[lane] ? DEVICE_VERIFIED : WIDE", "DEVICE_VERIFIED"},
    Mutant{"rows beyond the end",
           "for (uint lane = 0; lane < count; ++lane) memory[first + lane * stride] = lanes[lane];",
           "for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) memory[first + lane * stride] = lanes[lane];"},
    Mutant{"rows: whole vectors alone", "  if (count < VECTOR_WIDTH) {\n    store_first",
           "  if (false) {\n    store_first"},
    Mutant{"rows: hi beside the other's", "strided_store(hi, memory_hi, offset_hi + first * stride_hi",
           "strided_store(hi, memory_hi, offset_hi + group * stride_hi"},
    Mutant{"rows: lo for hi", "strided_store(hi, memory_hi", "strided_store(lo, memory_hi"},

    Mutant{"sums: open rows are in the minimum", "select(REAL(INFINITY), lo, settled)", "lo"},
    Mutant{"sums: the greatest lower end", "minimum_lo = fmin(minimum_lo,", "minimum_lo = fmax(minimum_lo,"},
    Mutant{"sums: of hi the last", "minimum_hi = fmin(minimum_hi, select(REAL(INFINITY), hi, settled));",
           "minimum_hi = select(REAL(INFINITY), hi, settled);"},
    Mutant{"sums: the smallest width", "own.largest_width = -least_lane(negative_width);",
           "own.largest_width = least_lane(negative_width);"},
    Mutant{"sums: the first work-item's alone", "own = sum_of(own, of_items[other]);", ""},
    Mutant{"sums: one work-item's widths", "fmax(a.largest_width, b.largest_width)", "a.largest_width"},
    Mutant{"sums: lanes beyond the end", "settled = known & (good | tightest);", "settled = good | tightest;"},
    Mutant{"sums: open rows are passed over", "own.open += lanes_in(known & ~settled);", ""},
    Mutant{"sums: wide rows are open", "settled = known & (good | tightest);", "settled = known & good;"},
    Mutant{"sums: wide rows are inside", "lanes_in(settled & ~good & MASK(lo < 0.0))", "lanes_in(settled & ~good)"},
    Mutant{"sums: the first lane's", "least = fmin(least, lanes[lane]);", ""},
    Mutant{"sums: lanes once", "count -= (int)lanes[lane];", "count = -(int)lanes[lane];"},
};

}  // namespace

std::span<const Mutant> row_mutants() {
  return rows;
}

}  // namespace verisq::mutation
