// This file implements the union of primitives: for points outside the minimum; inside, an enclosure that is honest
// about overlap.
//
// Signed distances of a union S of bodies S_i: sd(q) <= min sd_i(q) always, and sd(q) = min sd_i(q) where every sd_i(q)
// is positive. (Not where one is 0: a point on a face that two bodies share lies inside.) Elsewhere sd(q) >= -|w - q|
// for any witness w that is proven outside of every S_i. Witnesses are sought on the rays from q along the directions
// that prove the depths.

#define WITNESS_ROUNDS 8
#define WITNESS_MARGIN 0x1p-48 // of the size of the numbers: enough to be proven outside of what was just left

ALWAYS_INLINE vector3 to_local_direction(vector3 v, MODEL_SPACE const superquadric* s) {
  const vector3 u = {dot3(s->rotation[0], s->rotation[1], s->rotation[2], v),
                     dot3(s->rotation[3], s->rotation[4], s->rotation[5], v),
                     dot3(s->rotation[6], s->rotation[7], s->rotation[8], v)};
  return u;
}

// Of a tapered one.
ALWAYS_INLINE real tapered_separation_down(local_point own, MODEL_SPACE const superquadric* s) {
  const focal_point q = about_focus(own, s);
  const real side = copysign(REAL(1.0), q.point.z);
  const vector3 octant_q = {q.point.x, q.point.y, fabs(q.point.z)};
  const vector3 log_q = {log_or_lowest(octant_q.x), log_or_lowest(octant_q.y), log_or_lowest(octant_q.z)};
  const vector3 n = start_radially(log_q, s).normal;
  const tilted_normal tilted = tilted_up(n, support_up(n, s), side * s->taper, s);
  return sub_down(distance_by_support_down(octant_q, tilted.normal, tilted.support), q.error);
}

// Lower bound of the signed distance of w to one primitive, by the normal at its radial projection: positive, up to
// rounding, exactly where w is outside.
CALLED_ON_PROCESSORS real separation_down(vector3 w, MODEL_SPACE const superquadric* s) {
  const local_point q = to_local(w, s);
  if (s->taper != 0.0) return tapered_separation_down(q, s);
  const vector3 log_q = {log_or_lowest(q.point.x), log_or_lowest(q.point.y), log_or_lowest(q.point.z)};
  return sub_down(distance_down(q.point, start_radially(log_q, s).normal, s), q.error);
}

// Where the ray from x along the unit direction v has certainly left the primitive, to nearest: h(v) - v.(x - centre);
// a tapered solid reaches at most 1 + |k| times as far along x and y, and no farther along z.
ALWAYS_INLINE real ray_exit(vector3 x, vector3 v, MODEL_SPACE const superquadric* s) {
  const vector3 local_v = to_local_direction(v, s);
  const vector3 d = {x.x - s->translation[0], x.y - s->translation[1], x.z - s->translation[2]};
  const vector3 octant_v = {fabs(local_v.x), fabs(local_v.y), fabs(local_v.z)};
  return (1.0 + fabs(s->taper)) * support_up(octant_v, s) - dot_nearest(v, d);
}

// A point proven outside of all primitives, and an upper bound of its distance from where it was sought; infinite where
// none was found.
typedef struct {
  vector3 point;
  real distance;
} escape;

ALWAYS_INLINE escape nearer_escape(escape known, vector3 point, real distance, integer valid) {
  const integer nearer = valid & MASK(distance < known.distance);
  escape nearest;
  nearest.point.x = select(known.point.x, point.x, nearer);
  nearest.point.y = select(known.point.y, point.y, nearer);
  nearest.point.z = select(known.point.z, point.z, nearer);
  nearest.distance = select(known.distance, distance, nearer);
  return nearest;
}

// Sought from x along v, from `start` on.
CALLED_ON_PROCESSORS escape escape_along(vector3 x, vector3 v, real start, uint count,
                                         MODEL_SPACE const superquadric* primitives) {
  const real inverse_length = 1.0 / sqrt(dot_nearest(v, v));
  const vector3 u = {v.x * inverse_length, v.y * inverse_length, v.z * inverse_length};
  real margin = WITNESS_MARGIN * (fabs(x.x) + fabs(x.y) + fabs(x.z) + fabs(start) + 1.0);
  real t = start + margin;
  escape found = {x, REAL(INFINITY)};
  for (uint round = 0; round < WITNESS_ROUNDS; ++round) {
    const vector3 w = {fma(t, u.x, x.x), fma(t, u.y, x.y), fma(t, u.z, x.z)};
    real next = t;
    integer outside_all = INTEGER(-1);
    for (uint j = 0; j < count; ++j) {
      const integer outside = MASK(separation_down(w, primitives + j) > 0.0);
      outside_all &= outside;
      if (any(~outside)) next = select(fmax(next, ray_exit(x, u, primitives + j)), next, outside);
    }
    const vector3 apart = {fmax(sub_up(w.x, x.x), sub_up(x.x, w.x)), fmax(sub_up(w.y, x.y), sub_up(x.y, w.y)),
                           fmax(sub_up(w.z, x.z), sub_up(x.z, w.z))};
    found = nearer_escape(found, w, length_up(apart), outside_all);
    if (!any(~outside_all & MASK(isfinite(t)))) break;
    t = next + margin;
    margin *= 4.0;
  }
  return found;
}

// `stride` numbers a primitive in `los`, `his` and `normal_*`, one primitive after the other. `escape_*` is the point
// outside that proves the lower end, written where that end is not positive.
kernel void union_distance(ulong groups, ulong stride, global const double* xs, global const double* ys,
                           global const double* zs, MODEL_SPACE const superquadric* primitives, uint count,
                           global const double* los, global const double* his, global const double* normal_xs,
                           global const double* normal_ys, global const double* normal_zs, global double* union_los,
                           global double* union_his, global double* escape_xs, global double* escape_ys,
                           global double* escape_zs) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 x = {LOAD(group, xs), LOAD(group, ys), LOAD(group, zs)};
  real lo = REAL(INFINITY);
  real hi = REAL(INFINITY);
  for (uint i = 0; i < count; ++i) {
    lo = fmin(lo, LOAD(group, los + i * stride));
    hi = fmin(hi, LOAD(group, his + i * stride));
  }
  const integer maybe_inside = MASK(!(lo > 0.0));
  if (any(maybe_inside)) {
    escape nearest = {x, REAL(INFINITY)};
    for (uint i = 0; i < count; ++i) {
      const real own_lo = LOAD(group, los + i * stride);
      const integer candidate = MASK(own_lo <= 0.0) & MASK(own_lo > -DBL_MAX);
      if (!any(candidate)) continue;
      const vector3 normal = {LOAD(group, normal_xs + i * stride), LOAD(group, normal_ys + i * stride),
                              LOAD(group, normal_zs + i * stride)};
      const vector3 v = to_model_direction(normal, primitives + i);
      const escape found = escape_along(x, v, -own_lo, count, primitives);
      nearest = nearer_escape(nearest, found.point, found.distance, candidate);
    }
    lo = select(lo, -nearest.distance, maybe_inside);
    STORE(nearest.point.x, group, escape_xs);
    STORE(nearest.point.y, group, escape_ys);
    STORE(nearest.point.z, group, escape_zs);
  }
  STORE(lo, group, union_los);
  STORE(hi, group, union_his);
}
