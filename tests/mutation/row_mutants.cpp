/// Mutants of row_verdict.clh, point_rows.cl and point_map.cl: what lies between
/// the caller's memory and the kernels of distances.

#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array rows{
    Mutant{"columns: not scaled", "select(REAL(FAR_AWAY), y * factor, finite)", "select(REAL(FAR_AWAY), y, finite)"},
    Mutant{"columns: a coordinate twice", "strided_load(memory.z, memory.offset_z",
           "strided_load(memory.y, memory.offset_z"},
    Mutant{"columns: another one's offset", "strided_load(memory.z, memory.offset_z",
           "strided_load(memory.z, memory.offset_y"},
    Mutant{"columns: another one's stride", "first * memory.stride_z, memory.stride_z",
           "first * memory.stride_z, memory.stride_x"},
    Mutant{"columns: every stride is 1", "if (stride == 1) return LOAD(0, memory + first);",
           "return LOAD(0, memory + first);"},
    Mutant{"columns: whole vectors alone",
           "if (last < VECTOR_WIDTH - 1) return load_repeating(memory, first, stride, last);", ""},
    Mutant{"columns: lanes beyond the end", "memory[first + min(lane, last) * stride]", "memory[first]"},
    Mutant{"columns: NaN in x is passed on", "MASK(isfinite(x)) & MASK(isfinite(y))", "MASK(isfinite(y))"},
    Mutant{"columns: what is not finite is not told", "if (any(~all_finite)) atomic_or(refused, 1);", ""},
    Mutant{"columns: only the last vector is told of", "all_finite &= point.finite;", "all_finite = point.finite;"},
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
    Mutant{"verified: the tightest whatever was asked for",
           "if (tolerance == 0.0) limit =", "if (tolerance >= 0.0) limit ="},
    Mutant{"verified: as tight as the methods get", "tolerance == 0.0 ? tightest : verified_rows",
           "tolerance >= 0.0 ? tightest : verified_rows"},
    Mutant{"tightest: inside as outside", "select(of_outside, REAL(criterion.inside), MASK(hi < 0.0))", "of_outside"},
    Mutant{"tightest: outside as inside", "select(of_outside, REAL(criterion.inside), MASK(hi < 0.0))",
           "REAL(criterion.inside)"},
    Mutant{"tightest: what may be outside as inside", "REAL(criterion.inside), MASK(hi < 0.0))",
           "REAL(criterion.inside), MASK(hi < criterion.inside))"},
    Mutant{"tightest: without the radius", "criterion.outside * fmax(largest, REAL(criterion.radius))",
           "criterion.outside * largest"},
    Mutant{"tightest: without the coordinate", "criterion.outside * fmax(largest, REAL(criterion.radius))",
           "criterion.outside * REAL(criterion.radius)"},
    Mutant{"tightest: coordinates in the device's unit", "fabs(point.z)) * inverse;", "fabs(point.z));"},
    Mutant{"status: all that are whole are good", "count == VECTOR_WIDTH && !any(~(good & exact))",
           "count == VECTOR_WIDTH"},
    Mutant{"status: of whole vectors alone", "if (!all) {", "if (false) {"},
    Mutant{"status: all are good", "lanes[lane] ? DEVICE_VERIFIED : WIDE", "DEVICE_VERIFIED"},
    Mutant{"rows beyond the end",
           "for (uint lane = 0; lane < count; ++lane) memory[first + lane * stride] = lanes[lane];",
           "for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) memory[first + lane * stride] = lanes[lane];"},
    Mutant{"rows: whole vectors alone", "  if (count < VECTOR_WIDTH) {\n    store_first",
           "  if (false) {\n    store_first"},
    Mutant{"rows: hi beside the other's", "memory.offset_hi + first * memory.stride_hi",
           "memory.offset_hi + first * memory.stride_lo"},
    Mutant{"rows: lo for hi", "strided_store(hi, memory.hi", "strided_store(lo, memory.hi"},

    Mutant{"sums: open rows are in the minimum", "select(REAL(INFINITY), lo, settled)", "lo"},
    Mutant{"sums: the greatest lower end", "fmin(sums->minimum_lo,", "fmax(sums->minimum_lo,"},
    Mutant{"sums: of hi the last", "fmin(sums->minimum_hi, select(REAL(INFINITY), hi, settled))",
           "select(REAL(INFINITY), hi, settled)"},
    Mutant{"sums: the smallest width", "-least_lane(known.negative_width)", "least_lane(known.negative_width)"},
    Mutant{"sums: the first work-item's alone", "all = sum_of(all, of_items[other]);", ""},
    Mutant{"sums: one work-item's widths", "fmax(a.largest_width, b.largest_width)", "a.largest_width"},
    Mutant{"sums: lanes beyond the end", "settled = present & (good | tightest);", "settled = good | tightest;"},
    Mutant{"sums: open rows are passed over", "sums->counted.open += lanes_in(present & ~settled);", ""},
    Mutant{"sums: wide rows are open", "settled = present & (good | tightest);", "settled = present & good;"},
    Mutant{"sums: wide rows are inside", "lanes_in(settled & ~good & MASK(lo < 0.0))", "lanes_in(settled & ~good)"},
    Mutant{"sums: what is open is inside", "lanes_in(present & ~settled & MASK(!(lo > 0.0)))",
           "lanes_in(present & ~settled)"},
    Mutant{"sums: what is open is outside", "lanes_in(present & ~settled & MASK(!(lo > 0.0)))",
           "lanes_in(present & ~settled & MASK(lo <= 0.0))"},
    Mutant{"sums: the first lane's", "least = fmin(least, lanes[lane]);", ""},
    Mutant{"sums: lanes once", "count -= (int)lanes[lane];", "count = -(int)lanes[lane];"},
};

constexpr std::array map{
    Mutant{"another point's vector", "load_point(first, count - 1, factor, points)",
           "load_point(first + 1, count - 1, factor, points)"},
    Mutant{"points as they are", "load_point(first, count - 1, factor, points)",
           "load_point(first, count - 1, 1.0, points)"},
    Mutant{"one end alone", "deliver_rows(known.lo, known.hi,", "deliver_rows(known.lo, known.lo,"},
    Mutant{"each work-item skips a vector", "(get_group_id(0) * vectors + v) * get_local_size(0)",
           "(get_group_id(0) * (vectors + 1) + v) * get_local_size(0)"},
    Mutant{"all work-items take one vector", "* get_local_size(0) + get_local_id(0);", "* get_local_size(0);"},
    Mutant{"what is not finite is not told", "if (any(~all_finite)) atomic_or(refused, 1);", ""},
    Mutant{"only the last vector is told of", "all_finite &= point.finite;", "all_finite = point.finite;"},
    Mutant{"the last vector's rows alone are summed", "first, count, criterion, rows, &own);",
           "first, count, criterion, rows, &own);\n    if (first + count < size) own = no_rows_yet();"},
};

}  // namespace

std::span<const Mutant> point_map_mutants() {
  return map;
}

std::span<const Mutant> row_mutants() {
  return rows;
}

}  // namespace verisq::mutation
