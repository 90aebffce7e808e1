// This file implements the enclosure of the signed distance of points to one superquadric: both ends tight for points
// outside; inside, a first direction and the trivial upper bound, which interior_depth tightens.
//
// Arrays hold one number a point: `los`, `his` the enclosure for this primitive, `normal_*` the direction that proves
// the lower end, in the primitive's own frame (where no rotation rounds it: it is a certificate), and `nearest` the
// smallest upper end of the primitives so far, which lets far primitives be passed over.

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
  const real proven_hi = select(REAL(INFINITY), hi, MASK(hi <= DBL_MAX)); // NaN proves nothing
  STORE(select(REAL(-INFINITY), lo, MASK(lo >= -DBL_MAX)), group, los);
  STORE(proven_hi, group, his);
  STORE(fmin(known, proven_hi), group, nearest);
  const vector3 normal = out_of_octant(v, q.sign);
  STORE(normal.x, group, normal_xs);
  STORE(normal.y, group, normal_ys);
  STORE(normal.z, group, normal_zs);
}
