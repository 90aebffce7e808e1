// This file implements the enclosures of the signed distances of points to one superquadric. It stands behind one of the
// two layers that say what the enclosure of a point is, point_enclosure.clh or tapered_enclosure.clh.
//
// Arrays hold one number a point: `los`, `his` the enclosure for this primitive, `normal_*` the direction that proves
// the lower end, in the primitive's own frame (where no rotation rounds it: it is a certificate), and `nearest` the
// smallest upper end of the primitives so far, which lets later primitives be passed over.

// The columns of one primitive's results, and the smallest upper end of the primitives so far.
typedef struct {
  global double *nearest, *los, *his, *normal_xs, *normal_ys, *normal_zs;
} distance_columns;

ALWAYS_INLINE void store_enclosure(proven_distance known, ulong group, distance_columns columns) {
  STORE(known.lo, group, columns.los);
  STORE(known.hi, group, columns.his);
  STORE(known.normal.x, group, columns.normal_xs);
  STORE(known.normal.y, group, columns.normal_ys);
  STORE(known.normal.z, group, columns.normal_zs);
}

ALWAYS_INLINE void scatter_enclosure(proven_distance known, uint count, const lane_indices* indices,
                                     distance_columns columns) {
  scatter(known.lo, count, indices, columns.los);
  scatter(known.hi, count, indices, columns.his);
  scatter(known.normal.x, count, indices, columns.normal_xs);
  scatter(known.normal.y, count, indices, columns.normal_ys);
  scatter(known.normal.z, count, indices, columns.normal_zs);
}

// Stores what is known from afar about the points of a block; lists those for which a later primitive may yet be the
// nearest, and returns how many.
ALWAYS_INLINE uint list_near_points(ulong first, ulong last, global const double* xs, global const double* ys,
                                    global const double* zs, MODEL_SPACE const superquadric* s,
                                    distance_columns columns, global uint* listed) {
  uint count = 0;
  for (ulong group = first; group < last; ++group) {
    const proven_distance known = enclosure_from_afar(to_local(point_at(group, xs, ys, zs), s), s);
    store_enclosure(known, group, columns);
    const integer near = MASK(!(known.lo > LOAD(group, columns.nearest)));
    if (!any(near)) continue;
    long is_near[VECTOR_WIDTH];
    STORE(near, 0, is_near);
    for (uint lane = 0; lane < VECTOR_WIDTH; ++lane)
      if (is_near[lane] != 0) listed[count++] = (uint)(group * VECTOR_WIDTH + lane);
  }
  return count;
}

// Of the listed points from `start` on; lanes beyond the last repeat it.
ALWAYS_INLINE void take_near(uint start, uint count, global const uint* listed, lane_indices* indices) {
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) indices->of_lane[lane] = listed[min(start + lane, count - 1)];
}

// A work-item owns a block of groups. Of the first primitive (index 0) all points are searched for, of the others those
// for which it may be the nearest, gathered from the block so that all lanes have one. `listed` has room for all points.
kernel void point_distance(ulong groups, uint groups_per_block, global const double* xs, global const double* ys,
                           global const double* zs, MODEL_SPACE const superquadric* primitives, uint index,
                           global uint* listed, global double* nearest, global double* los, global double* his,
                           global double* normal_xs, global double* normal_ys, global double* normal_zs) {
  MODEL_SPACE const superquadric* s = primitives + index;
  const ulong first = get_global_id(0) * groups_per_block;
  const ulong last = min(first + groups_per_block, groups);
  const distance_columns columns = {nearest, los, his, normal_xs, normal_ys, normal_zs};
  global uint* near = listed + first * VECTOR_WIDTH;
  const uint size = first < last ? (uint)(last - first) * VECTOR_WIDTH : 0;
  const uint count = index == 0 ? size : list_near_points(first, last, xs, ys, zs, s, columns, near);
  const bool all = count == size;
  for (uint start = 0; start < count; start += VECTOR_WIDTH) {
    const ulong group = first + start / VECTOR_WIDTH;
    lane_indices indices;
    vector3 x;
    if (all) {
      x = point_at(group, xs, ys, zs);
    } else {
      take_near(start, count, near, &indices);
      x = gathered_point(&indices, xs, ys, zs);
    }
    const proven_distance known = enclosure_at(to_local(x, s), s);
    if (all) {
      store_enclosure(known, group, columns);
      STORE(index == 0 ? known.hi : fmin(LOAD(group, nearest), known.hi), group, nearest);
    } else {
      const uint filled = min(count - start, (uint)VECTOR_WIDTH);
      scatter_enclosure(known, filled, &indices, columns);
      scatter(fmin(gathered(nearest, &indices), known.hi), filled, &indices, nearest);
    }
  }
}
