// This file implements the enclosure of the signed distance of points to one superquadric: both ends tight for points
// outside; inside, a first direction and the trivial upper bound, which interior_depth tightens.
//
// Arrays hold one number a point: `los`, `his` the enclosure for this primitive, `normal_*` the direction that proves
// the lower end, in the primitive's own frame (where no rotation rounds it: it is a certificate), and `nearest` the
// smallest upper end of the primitives so far, which lets later primitives be passed over.

// Relative to the size of the numbers: what is wider is proposed again in binary64.
#define LOOSE 1e-14

typedef struct {
  real lo, hi;
  vector3 normal; // which proves the lower end
} proven_distance;

// Whatever v and x in the octant are, these are bounds.
ALWAYS_INLINE proven_distance distance_by_contact(vector3 q, vector3 v, vector3 x, MODEL_SPACE const superquadric* s) {
  const proven_distance proven = {distance_down(q, v, s), distance_up(q, x, s), v};
  return proven;
}

// Both bounds by what one evaluation tells.
ALWAYS_INLINE proven_distance distance_by_evaluation(vector3 q, contact c, MODEL_SPACE const superquadric* s) {
  const contact_bounds bounds = bounds_of_contact(c, s);
  const vector3 v = normal_of_contact(c);
  const proven_distance proven = {distance_by_support_down(q, v, bounds.support),
                                  distance_by_scale_up(q, c.point, scale_into_solid(bounds)), v};
  return proven;
}

// By Newton's method in binary64, where binary32 went astray: exponents near 2, coordinates that vanish.
ALWAYS_INLINE proven_distance distance_by_projection(vector3 q, MODEL_SPACE const superquadric* s) {
  const vector3 log_q = {log_or_lowest(q.x), log_or_lowest(q.y), log_or_lowest(q.z)};
  const radial_start start = start_radially(log_q, s);
  const double enough = TIGHT_STEP / fmax(s->p[0], s->p[1]);
  const projection found = project(log_q, start.unknowns, ~start.inside, enough, s);
  const vector3 v = select_vector(vector_from_closest_point(q, found), start.normal, start.inside);
  const vector3 x = {fmax(q.x - v.x, REAL(0.0)), fmax(q.y - v.y, REAL(0.0)), fmax(q.z - v.z, REAL(0.0))};
  return distance_by_contact(q, v, x, s);
}

// Both hold: the higher lower end with its normal, the lower upper end. NaN proves nothing.
ALWAYS_INLINE proven_distance tighter(proven_distance a, proven_distance b) {
  const integer b_higher = MASK(!(a.lo >= b.lo)) & MASK(b.lo == b.lo);
  const integer b_lower = MASK(!(a.hi <= b.hi)) & MASK(b.hi == b.hi);
  const proven_distance both = {select(a.lo, b.lo, b_higher), select(a.hi, b.hi, b_lower),
                                select_vector(a.normal, b.normal, b_higher)};
  return both;
}

// Of the enclosure of a point's signed distance to one primitive: NaN proves nothing.
ALWAYS_INLINE proven_distance enclosure_at(local_point q, MODEL_SPACE const superquadric* s) {
  const single_projection found = project_in_single(q.point, s);
  const contact proposed = propose_contact(q.point, found, s);
#ifdef SOLVER_ONLY // for the benchmark that shows what the proof costs
  const vector3 v = proposed.normal;
  const real lo = v.x + v.y + v.z;
  const real hi = proposed.point.x + proposed.point.y + proposed.point.z;
#else
  proven_distance proven = distance_by_evaluation(q.point, proposed, s);
  const real wide = LOOSE * fmax(REAL(s->circumradius_up), fmax(q.point.x, fmax(q.point.y, q.point.z)));
  if (any(MASK(!(proven.hi - proven.lo <= wide)) & ~SINGLE_MASK_TO_MASK(found.inside))) {
    proven = tighter(proven, distance_by_projection(q.point, s));
  }
  const vector3 v = proven.normal;
  const real lo = sub_down(proven.lo, q.error);
  const real hi = add_up(proven.hi, q.error);
#endif
  const proven_distance known = {select(REAL(-INFINITY), lo, MASK(lo >= -DBL_MAX)),
                                 select(REAL(INFINITY), hi, MASK(hi <= DBL_MAX)), out_of_octant(v, q.sign)};
  return known;
}

// A lower bound without a search: the farther of a sphere and of the box about the solid. h(q) <= reach |q|, so that q
// is the normal which proves the sphere's, for points inside, too; h(v) <= v.a, a the box's corner, so that v = max(q -
// a, 0) proves the box's where it is not 0.
ALWAYS_INLINE proven_distance enclosure_from_afar(local_point q, MODEL_SPACE const superquadric* s) {
  const real sphere = sub_down(length_down(q.point), REAL(s->reach_up));
  const vector3 v = {positive_part(sub_down(q.point.x, REAL(s->semi_axes[0]))),
                     positive_part(sub_down(q.point.y, REAL(s->semi_axes[1]))),
                     positive_part(sub_down(q.point.z, REAL(s->semi_axes[2])))};
  const real box = length_down(v); // |v|^2 <= v.(q - a), v rounded down
  const integer by_box = MASK(box > sphere) & MASK(box > 0.0);
  const proven_distance known = {sub_down(select(sphere, box, by_box), q.error), REAL(INFINITY),
                                 out_of_octant(select_vector(q.point, v, by_box), q.sign)};
  return known;
}

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
