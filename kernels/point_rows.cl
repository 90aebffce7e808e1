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

// This file implements the rows of points whose enclosures the other kernels have found.

// A work-group takes `vectors` vectors a work-item; work-items that are neighbours take vectors that are, so that their
// loads are, too. `sums`: one a work-group.
kernel void point_rows(ulong size, uint vectors, double factor, double inverse, double tolerance, double inside,
                       double outside, double radius, global const double* xs, global const double* ys,
                       global const double* zs, global const double* union_los, global const double* union_his,
                       global double* memory_lo, global double* memory_hi, global uchar* memory_status, ulong offset_lo,
                       ulong offset_hi, ulong offset_status, ulong stride_lo, ulong stride_hi, ulong stride_status,
                       global row_sums* sums, local row_sums* of_items) {
  const row_criterion criterion = {factor, inverse, tolerance, inside, outside, radius};
  const row_memory rows = {memory_lo,     memory_hi, memory_status, offset_lo,    offset_hi,
                           offset_status, stride_lo, stride_hi,     stride_status};
  running_sums own = no_rows_yet();
  for (uint v = 0; v < vectors; ++v) {
    const ulong group = (get_group_id(0) * vectors + v) * get_local_size(0) + get_local_id(0);
    const ulong first = group * VECTOR_WIDTH;
    if (first >= size) break;
    const vector3 point = {LOAD(group, xs), LOAD(group, ys), LOAD(group, zs)};
    deliver_rows(LOAD(group, union_los), LOAD(group, union_his), largest_coordinate(point, inverse), first,
                 min((ulong)VECTOR_WIDTH, size - first), criterion, rows, &own);
  }
  sum_up(own, sums, of_items);
}
