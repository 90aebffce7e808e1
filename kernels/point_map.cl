// This file implements a map of points to one superquadric in one step, from the caller's points to his rows: what
// point_columns, point_distance and point_rows do one after the other, with nothing written in between. It finds no
// depths.

// As point_rows; `refused` as point_columns.
kernel void point_map(ulong size, uint vectors, double factor, double inverse, double tolerance, double inside,
                      double outside, double radius, MODEL_SPACE const superquadric* primitives,
                      global const double* memory_x, global const double* memory_y, global const double* memory_z,
                      ulong offset_x, ulong offset_y, ulong offset_z, ulong stride_x, ulong stride_y, ulong stride_z,
                      global double* memory_lo, global double* memory_hi, global uchar* memory_status, ulong offset_lo,
                      ulong offset_hi, ulong offset_status, ulong stride_lo, ulong stride_hi, ulong stride_status,
                      global uint* refused, global row_sums* sums, local row_sums* of_items) {
  const point_memory points = {memory_x, memory_y, memory_z, offset_x, offset_y, offset_z, stride_x, stride_y, stride_z};
  const row_criterion criterion = {factor, inverse, tolerance, inside, outside, radius};
  const row_memory rows = {memory_lo,     memory_hi, memory_status, offset_lo,    offset_hi,
                           offset_status, stride_lo, stride_hi,     stride_status};
  integer all_finite = INTEGER(-1);
  running_sums own = no_rows_yet();
  for (uint v = 0; v < vectors; ++v) {
    const ulong group = (get_group_id(0) * vectors + v) * get_local_size(0) + get_local_id(0);
    const ulong first = group * VECTOR_WIDTH;
    if (first >= size) break;
    const uint count = min((ulong)VECTOR_WIDTH, size - first);
    const caller_point point = load_point(first, count - 1, factor, points);
    const real largest = largest_coordinate(point.at, inverse);
    const proven_distance known = enclosure_at(to_local(point.at, primitives), primitives);
    deliver_rows(known.lo, known.hi, largest, first, count, criterion, rows, &own);
    all_finite &= point.finite;
  }
  if (any(~all_finite)) atomic_or(refused, 1);
  sum_up(own, sums, of_items);
}
