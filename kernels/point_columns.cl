// This file implements the way of points from the caller's memory, wherever their coordinates lie there, into the
// columns that the other kernels read.

// Columns are scaled by `factor`; their lanes beyond the last of `size` points repeat it. A work-item takes `vectors`
// vectors. `refused` is not 0 afterwards where a coordinate is not finite.
kernel void point_columns(ulong size, uint vectors, double factor, global const double* memory_x,
                          global const double* memory_y, global const double* memory_z, ulong offset_x, ulong offset_y,
                          ulong offset_z, ulong stride_x, ulong stride_y, ulong stride_z, global double* xs,
                          global double* ys, global double* zs, global uint* refused) {
  const point_memory points = {memory_x, memory_y, memory_z, offset_x, offset_y, offset_z, stride_x, stride_y, stride_z};
  integer all_finite = INTEGER(-1);
  for (uint v = 0; v < vectors; ++v) {
    const ulong group = get_global_id(0) * vectors + v;
    const ulong first = group * VECTOR_WIDTH;
    if (first >= size) break;
    const caller_point point = load_point(first, min((ulong)VECTOR_WIDTH, size - first) - 1, factor, points);
    STORE(point.at.x, group, xs);
    STORE(point.at.y, group, ys);
    STORE(point.at.z, group, zs);
    all_finite &= point.finite;
  }
  if (any(~all_finite)) atomic_or(refused, 1);
}
