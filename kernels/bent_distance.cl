// This file implements the enclosure of the distance of points to one bent superquadric by a single certificate, where
// that is a convex problem.
//
// In the coordinates rho = 1/k - r, gamma = k z, s of the bend the squared distance of a point with coordinates rho_q,
// gamma_q, s_q is f = rho^2 + rho_q^2 - 2 rho rho_q cos(gamma - gamma_q) + (s - s_q)^2, whose Hessian is positive
// semidefinite where rho cos(gamma - gamma_q) >= rho_q sin^2(gamma - gamma_q). Where that holds on all of the unbent
// solid K, which is convex, f lies above its tangent planes there: for any point x_0, with v = grad f(x_0) / 2,
//   f(x) >= f(x_0) + 2 v.(x - x_0) >= f(x_0) - 2 (h(-v) + v.x_0) for all x in K,
// h the support function of K, symmetric. Tight, to second order, where x_0 is the closest point. Gently bent solids
// and queries not far beyond their ends satisfy the condition; the others are left to the branch and bound.
//
// x_0 is given by the point p of the bent space that unbends to it: then f(x_0) = |p - q|^2, and the derivatives of the
// bend at x_0 are cosine and sine of the angle of p.

#define BEND_STEPS 16
#define BEND_CONVERGED 1e-9
#define NEIGHBOURHOOD 0x1p-20 // x_0 may lie outside of K by this, relatively: convexity is asked for on that much more

// A point in the frame of the bend: R, S, Z; or unbent: r, s, z.
ALWAYS_INLINE vector3 bend_nearest(vector3 x, double curvature) {
  const real k = REAL(curvature);
  const real angle = k * x.z;
  const real half_angle = 0.5 * angle;
  const real half_sine = sin(half_angle);
  const real half_ratio = select(half_sine / half_angle, REAL(1.0), MASK(fabs(half_angle) < 1e-8));
  const real sine = sin(angle);
  const real ratio = select(sine / angle, REAL(1.0), MASK(fabs(angle) < 1e-8));
  const vector3 bent = {fma(x.x, cos(angle), x.z * half_sine * half_ratio), x.y, fma(x.z, ratio, -x.x * sine)};
  return bent;
}

// Half the gradient of f at x, whose bent image is `bent`.
ALWAYS_INLINE vector3 half_gradient(vector3 x, vector3 bent, vector3 q, double curvature) {
  const real k = REAL(curvature);
  const real c = cos(k * x.z);
  const real n = sin(k * x.z);
  const vector3 d = {bent.x - q.x, bent.y - q.y, bent.z - q.z};
  const vector3 v = {d.x * c - d.z * n, d.y, (1.0 - k * x.x) * (d.x * n + d.z * c)};
  return v;
}

// About z by the angle of the bend, and back.
ALWAYS_INLINE vector3 to_own_axes(vector3 x, MODEL_SPACE const box_primitive* p) {
  const vector3 y = {x.x * p->bend_cos - x.y * p->bend_sin, x.x * p->bend_sin + x.y * p->bend_cos, x.z};
  return y;
}
ALWAYS_INLINE vector3 to_bend_axes(vector3 y, MODEL_SPACE const box_primitive* p) {
  const vector3 x = {y.x * p->bend_cos + y.y * p->bend_sin, y.y * p->bend_cos - y.x * p->bend_sin, y.z};
  return x;
}

// The point of K closest to t, both in the axes of the bend.
NEVER_INLINE vector3 closest_in_solid(vector3 t, MODEL_SPACE const box_primitive* p) {
  MODEL_SPACE const superquadric* s = &p->solid;
  const vector3 own = to_own_axes(t, p);
  const vector3 size = magnitudes(own);
  const vector3 log_size = {log_or_lowest(size.x), log_or_lowest(size.y), log_or_lowest(size.z)};
  const radial_start start = start_radially(log_size, s);
  const vector3 v =
      vector_from_closest_point(size, project(log_size, start.unknowns, ~start.inside, CONVERGED_STEP, s));
  const vector3 on_surface = {own.x - copysign(v.x, own.x), own.y - copysign(v.y, own.y), own.z - copysign(v.z, own.z)};
  const vector3 closest = select_vector(on_surface, own, start.inside);
  return to_bend_axes(closest, p);
}

// Proposes the closest point by projected gradient steps: half the Hessian of f has the diagonal 1, 1, W W_q cos.
ALWAYS_INLINE vector3 closest_unbent(vector3 q, vector3 unbent_q, real w_q, MODEL_SPACE const box_primitive* p) {
  const real step = 1.0 / fmax(w_q * (2.0 - p->least_w), REAL(1.0));
  vector3 x = closest_in_solid(unbent_q, p);
  for (int i = 0; i < BEND_STEPS; ++i) {
    const vector3 v = half_gradient(x, bend_nearest(x, p->curvature), q, p->curvature);
    const vector3 next = closest_in_solid(add_scaled(x, -step, v), p);
    const vector3 change = {next.x - x.x, next.y - x.y, next.z - x.z};
    x = next;
    if (!any(MASK(dot_nearest(change, change) > BEND_CONVERGED * BEND_CONVERGED))) break;
  }
  return x;
}

ALWAYS_INLINE interval interval_difference(real a, real b) { return interval_about(a - b, fabs(a - b) * 0x1p-52); }

// Whether f is convex on K and NEIGHBOURHOOD more of it. With the largest |gamma - gamma_q| at most `angle`:
// cos >= 1 - angle^2 / 2 and sin^2 <= angle^2.
ALWAYS_INLINE integer convex_about(unbent q, MODEL_SPACE const box_primitive* p) {
  const real along = mul_up(REAL(p->curvature), REAL(p->solid.semi_axes[2] * (1.0 + 2.0 * NEIGHBOURHOOD)));
  const interval turned = interval_abs(interval_scaled_add(REAL(p->curvature), q.z, interval_of(REAL(0.0), REAL(0.0))));
  const real angle = add_up(turned.hi, along);
  const real square = mul_up(angle, angle);
  const real least_w = REAL(p->least_w - 2.0 * NEIGHBOURHOOD);
  return MASK(mul_down(least_w, sub_down(REAL(1.0), square)) >= mul_up(q.w.hi, square)) & MASK(square < 1.0) &
         MASK(least_w > 0.0);
}

// What p proves about the distance of q to the bent solid, both in the axes of the bend.
ALWAYS_INLINE interval distance_by_point(vector3 q, vector3 at, integer convex, MODEL_SPACE const box_primitive* p) {
  const unbent x = unbend(interval_of(at.x, at.x), interval_of(at.z, at.z), p->curvature);
  const interval dr = interval_difference(at.x, q.x);
  const interval ds = interval_difference(at.y, q.y);
  const interval dz = interval_difference(at.z, q.z);
  const interval v_r = interval_sub(interval_mul(dr, x.cosine), interval_mul(dz, x.sine));
  const interval v_z = interval_mul(x.w, interval_add(interval_mul(dr, x.sine), interval_mul(dz, x.cosine)));
  const interval s = interval_of(at.y, at.y);
  const interval along =
      interval_add(interval_mul(v_r, x.r), interval_add(interval_mul(ds, s), interval_mul(v_z, x.z)));

  // In K's own axes, by a cosine and a sine that were rounded once.
  const interval c = interval_about(REAL(p->bend_cos), REAL(0x1p-53));
  const interval n = interval_about(REAL(p->bend_sin), REAL(0x1p-53));
  const vector3 v = {interval_abs(interval_sub(interval_mul(c, v_r), interval_mul(n, ds))).hi,
                     interval_abs(interval_add(interval_mul(n, v_r), interval_mul(c, ds))).hi, interval_abs(v_z).hi};
  const vector3 own = {interval_abs(interval_sub(interval_mul(c, x.r), interval_mul(n, s))).hi,
                       interval_abs(interval_add(interval_mul(n, x.r), interval_mul(c, s))).hi, interval_abs(x.z).hi};
  const vector3 apart = {interval_abs(dr).hi, interval_abs(ds).hi, interval_abs(dz).hi};
  const vector3 apart_down = {interval_abs(dr).lo, interval_abs(ds).lo, interval_abs(dz).lo};

  const real log_gauge = log_gauge_up(own, &p->solid);
  const real loss = mul_up(REAL(2.0), add_up(support_up(v, &p->solid), along.hi));
  const real square = sub_down(dot_down(apart_down, apart_down), loss);
  const integer valid = convex & MASK(log_gauge <= 0.5 * NEIGHBOURHOOD) & MASK(square >= 0.0) & MASK(square <= DBL_MAX);
  // (1 - L) x_0 lies in K for L = max(log g(x_0), 0) <= 1 (superquadric.clh, distance_up), and bending moves it from p
  // by at most twice its way from x_0: 1 - k r <= 2 near K.
  const real outside = fmax(log_gauge, REAL(0.0));
  const real moved = mul_up(REAL(2.0), mul_up(outside, length_up(own)));
  const real upper = add_up(length_up(apart), moved);
  const integer near = MASK(log_gauge <= 0.5 * NEIGHBOURHOOD) & MASK(upper <= DBL_MAX);
  return interval_of(select(REAL(0.0), sqrt_down(square), valid), select(REAL(INFINITY), upper, near));
}

// For points proven to lie outside; others get nothing (-infinity, infinity). Normals lead from the closest point to
// the query in the frame of the bend.
kernel void bent_distance(ulong groups, global const double* xs, global const double* ys, global const double* zs,
                          MODEL_SPACE const box_primitive* primitives, uint index, global double* los,
                          global double* his, global double* normal_xs, global double* normal_ys,
                          global double* normal_zs) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  MODEL_SPACE const box_primitive* p = primitives + index;
  const vector3 x = {LOAD(group, xs), LOAD(group, ys), LOAD(group, zs)};
  const cube here = {x, REAL(0.0)};
  const colour own = bent_colour(here, p);
  const vector3 d = {x.x - p->solid.translation[0], x.y - p->solid.translation[1], x.z - p->solid.translation[2]};
  const vector3 q = {dot3(p->frame[0], p->frame[1], p->frame[2], d), dot3(p->frame[3], p->frame[4], p->frame[5], d),
                     dot3(p->frame[6], p->frame[7], p->frame[8], d)};
  const real size = add_up(fabs(d.x), add_up(fabs(d.y), fabs(d.z)));
  const real frame_error = fma_up(REAL(p->frame_error), size, REAL(0x1p-1000));
  const unbent u = unbend(interval_of(q.x, q.x), interval_of(q.z, q.z), p->curvature);
  const integer convex = convex_about(u, p);
  const vector3 unbent_q = {middle_of(u.r), q.y, middle_of(u.z)};
  const integer usable = own.white & convex & MASK(fabs(unbent_q.x) <= DBL_MAX) & MASK(fabs(unbent_q.z) <= DBL_MAX);
  interval distance = interval_of(REAL(-INFINITY), REAL(INFINITY));
  vector3 normal = {REAL(0.0), REAL(0.0), REAL(0.0)};
  if (any(usable)) {
    const vector3 at = bend_nearest(closest_unbent(q, where(usable, unbent_q), u.w.hi, p), p->curvature);
    const interval found = distance_by_point(q, at, convex, p);
    distance.lo = select(distance.lo, sub_down(found.lo, frame_error), usable);
    distance.hi = select(distance.hi, add_up(found.hi, frame_error), usable);
    const vector3 apart = {q.x - at.x, q.y - at.y, q.z - at.z};
    normal = where(usable, apart);
  }
  STORE(distance.lo, group, los);
  STORE(distance.hi, group, his);
  STORE(normal.x, group, normal_xs);
  STORE(normal.y, group, normal_ys);
  STORE(normal.z, group, normal_zs);
}
