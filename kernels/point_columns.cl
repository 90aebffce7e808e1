// This file implements the way of points from the caller's memory, wherever their coordinates lie there, into the
// columns that the other kernels read.

#define FAR_AWAY 0x1p20 // of the unit model: in place of what is not finite, and is refused by the host

// Of the last points, which do not fill a vector.
CALLED_ON_PROCESSORS real load_repeating(global const double* memory, ulong first, ulong stride, uint last) {
  double lanes[VECTOR_WIDTH];
#pragma nounroll
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) lanes[lane] = memory[first + min(lane, last) * stride];
  return LOAD(0, lanes);
}

// The numbers of a vector of points, `first` the one of the first point; lanes beyond `last` repeat that one.
ALWAYS_INLINE real strided_load(global const double* memory, ulong first, ulong stride, uint last) {
  if (last < VECTOR_WIDTH - 1) return load_repeating(memory, first, stride, last);
  if (stride == 1) return LOAD(0, memory + first);
  double lanes[VECTOR_WIDTH];
#pragma unroll
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) lanes[lane] = memory[first + lane * stride];
  return LOAD(0, lanes);
}

// Coordinate i of point n is memory_i[offset_i + n * stride_i], in sums that wrap: a stride may be negative. Columns are
// scaled by `factor`; their lanes beyond the last of `size` points repeat it. A work-item takes `vectors` vectors.
// `refused` is not 0 afterwards where a coordinate is not finite.
kernel void point_columns(ulong size, uint vectors, double factor, global const double* memory_x,
                          global const double* memory_y, global const double* memory_z, ulong offset_x, ulong offset_y,
                          ulong offset_z, ulong stride_x, ulong stride_y, ulong stride_z, global double* xs,
                          global double* ys, global double* zs, global uint* refused) {
  integer all_finite = INTEGER(-1);
  for (uint v = 0; v < vectors; ++v) {
    const ulong group = get_global_id(0) * vectors + v;
    const ulong first = group * VECTOR_WIDTH;
    if (first >= size) break;
    const uint last = min((ulong)VECTOR_WIDTH, size - first) - 1;
    const real x = strided_load(memory_x, offset_x + first * stride_x, stride_x, last);
    const real y = strided_load(memory_y, offset_y + first * stride_y, stride_y, last);
    const real z = strided_load(memory_z, offset_z + first * stride_z, stride_z, last);
    const integer finite = MASK(isfinite(x)) & MASK(isfinite(y)) & MASK(isfinite(z));
    STORE(select(REAL(FAR_AWAY), x * factor, finite), group, xs);
    STORE(select(REAL(FAR_AWAY), y * factor, finite), group, ys);
    STORE(select(REAL(FAR_AWAY), z * factor, finite), group, zs);
    all_finite &= finite;
  }
  if (any(~all_finite)) atomic_or(refused, 1);
}
