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
