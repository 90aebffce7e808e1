// This file implements the enclosure of the signed distance of points to one superquadric: both ends tight for points
// outside; inside, a first direction and the trivial upper bound, which interior_depth tightens.
//
// Arrays hold one number a point: `los`, `his` the enclosure for this primitive, `normal_*` the direction that proves
// the lower end, in the primitive's own frame (where no rotation rounds it: it is a certificate), and `nearest` the
// smallest upper end of the primitives so far, which lets far primitives be passed over.

kernel void point_distance(ulong groups, global const double* xs, global const double* ys, global const double* zs,
                           MODEL_SPACE const superquadric* primitives, uint index, global double* nearest,
                           global double* los, global double* his, global double* normal_xs,
                           global double* normal_ys, global double* normal_zs) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  MODEL_SPACE const superquadric* s = primitives + index;
  const vector3 x = {LOAD(group, xs), LOAD(group, ys), LOAD(group, zs)};
  const local_point q = to_local(x, s);
  const real known = index == 0 ? REAL(INFINITY) : LOAD(group, nearest);

  const real beyond_sphere = sub_down(sub_down(length_down(q.point), REAL(s->circumradius_up)), q.error);
  if (!any(MASK(!(beyond_sphere > known)))) {
    STORE(beyond_sphere, group, los);
    STORE(REAL(INFINITY), group, his);
    STORE(REAL(0.0), group, normal_xs); // proves nothing: the sphere does
    STORE(REAL(0.0), group, normal_ys);
    STORE(REAL(0.0), group, normal_zs);
    return;
  }

  const vector3 log_q = {log_or_lowest(q.point.x), log_or_lowest(q.point.y), log_or_lowest(q.point.z)};
  const radial_start start = start_radially(log_q, s);
  const double enough = TIGHT_STEP / fmax(s->p[0], s->p[1]);
  const projection found = project(log_q, start.unknowns, ~start.inside, enough, s);
  const vector3 v = select_vector(vector_from_closest_point(q.point, found), start.normal, start.inside);

#ifdef SOLVER_ONLY // for the benchmark that shows what the proof costs
  const real lo = v.x + v.y;
  const real hi = v.y + v.z;
#else
  // Whatever v is, a point of the octant, where distance_up holds.
  const vector3 closest = {fmax(q.point.x - v.x, REAL(0.0)), fmax(q.point.y - v.y, REAL(0.0)),
                           fmax(q.point.z - v.z, REAL(0.0))};
  const real lo = sub_down(distance_down(q.point, v, s), q.error);
  const real hi = add_up(distance_up(q.point, closest, s), q.error);
#endif
  const real proven_hi = select(REAL(INFINITY), hi, MASK(hi <= DBL_MAX)); // NaN proves nothing
  STORE(select(REAL(-INFINITY), lo, MASK(lo >= -DBL_MAX)), group, los);
  STORE(proven_hi, group, his);
  STORE(fmin(known, proven_hi), group, nearest);
  const vector3 normal = out_of_octant(v, q.sign);
  STORE(normal.x, group, normal_xs);
  STORE(normal.y, group, normal_ys);
  STORE(normal.z, group, normal_zs);
}
