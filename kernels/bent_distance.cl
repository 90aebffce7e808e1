// This file implements the enclosure of the signed distance of points to one bent superquadric by a single certificate:
// outside where the squared distance lies above a tangent plane, inside by bent_depth.clh.
//
// Let K be the unbent solid, convex, and in units of 1 / k let W and gamma = k z be the polar coordinates of a point of
// the bent space about the centre of curvature, those of the query W_q and gamma_q. The squared distance to the query,
// f = (W^2 + W_q^2 - 2 W W_q cos(gamma - gamma_q)) / k^2 + (s - s_q)^2, lies above its tangent plane at x_0 in all of
// K,
//   f(x) >= f(x_0) + 2 v.(x - x_0) >= f(x_0) - 2 (h(-v) + v.x_0), v = grad f(x_0) / 2, h the support function of K,
// if with D = gamma_0 - gamma_q for all turns d from gamma_0 to a gamma of K
//   W_0 (cos D - sin D phi(d)) >= W_q sin^2(D + d / 2), phi(d) = (d - sin d) / (1 - cos d)
// (docs/mathematics.md §9). Tight, to second order, where x_0 is the closest point. Points whose closest one is an end
// that turns away from them do not satisfy the condition; they are left to the branch and bound.
//
// x_0 is given by the point p of the bent space that unbends to it: then f(x_0) = |p - q|^2, and the derivatives of the
// bend at x_0 are cosine and sine of the angle of p.

#define BEND_STEPS 16
#define BEND_CONVERGED 1e-9
#define NEIGHBOURHOOD 0x1p-20 // x_0 may lie outside of K by this, relatively: so far upper ends are wanted

// The point of K closest to t, both in the axes of the bend.
NEVER_INLINE vector3 closest_in_solid(vector3 t, MODEL_SPACE const box_primitive* p) {
  return to_bend_axes(closest_of_solid(to_own_axes(t, p), &p->solid), p);
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

// Upper bound of sin^2 of all angles up to t: t^2 - t^4 / 3 + 2 t^6 / 45 breaks the alternating series of
// (1 - cos 2t) / 2 off after a positive term, and rises with t.
ALWAYS_INLINE real squared_sine_up(real t) {
  const real square = mul_up(t, t);
  const real square_down = mul_down(t, t);
  const real fourth_down = mul_down(mul_down(square_down, square_down), REAL(0x1.5555555555555p-2)); // below 1/3
  const real sixth = mul_up(mul_up(square, mul_up(square, square)), REAL(0x1.6c16c16c16c17p-5)); // above 2/45
  return fmin(add_up(sub_up(square, fourth_down), sixth), REAL(1.0));
}

// Upper bound of phi(d) = (d - sin d) / (1 - cos d) for the d in [0, turn], in which it rises: d - sin d <= d^3 / 6 and
// 1 - cos d >= d^2 / 2 - d^4 / 24. Only where turn^2 < 12.
ALWAYS_INLINE real turn_quotient_up(real turn) {
  const real fall = sub_down(REAL(1.0), mul_up(mul_up(turn, turn), REAL(0x1.5555555555556p-4))); // above 1/12
  const real quotient = div_up(mul_up(turn, REAL(0x1.5555555555556p-2)), fall);
  return select(REAL(INFINITY), quotient, MASK(fall > 0.0));
}

// How far K lies along gamma from where it is looked at.
typedef struct {
  real turn;    // away from the query: largest |d| with the sign of D
  real between; // largest |D + d / 2|
} angles_of_solid;

// |gamma| of K is at most this: a rounded focus may move its ends by as much as the solid differs.
ALWAYS_INLINE real along_up(MODEL_SPACE const box_primitive* p) {
  const real end = add_up(REAL(p->solid.semi_axes[2]), REAL(p->solid.taper_error));
  return mul_up(REAL(p->curvature), end);
}

ALWAYS_INLINE angles_of_solid angles_of_all(interval gamma_0, interval gamma_q, interval apart,
                                            MODEL_SPACE const box_primitive* p) {
  const real along = along_up(p);
  const real ahead = select(REAL(0.0), sub_up(along, gamma_0.lo), MASK(apart.hi > 0.0));
  const real behind = select(REAL(0.0), add_up(along, gamma_0.hi), MASK(apart.lo < 0.0));
  const interval halved = interval_mul(gamma_0, interval_of(REAL(0.5), REAL(0.5)));
  const angles_of_solid all = {fmax(fmax(ahead, behind), REAL(0.0)),
                               add_up(interval_abs(interval_sub(halved, gamma_q)).hi, 0.5 * along)};
  return all;
}

#define WHOLE_TURN 6.5
#define BELOW_HALF_A_TURN 3.0
#define THREE_QUARTERS_OF_A_TURN 4.712388980384689 // 3 pi / 2, rounded down

// Of the points of K within `upper` of q: |sin(gamma - gamma_q)| <= k upper / W_q where that is below 1, and then the
// cosine is positive. Every |gamma - gamma_q| of K is below three quarters of a turn, hence those are within a quarter,
// and at most the tangent.
ALWAYS_INLINE angles_of_solid angles_nearby(angles_of_solid all, interval apart, interval gamma_q, real w_q, real upper,
                                            MODEL_SPACE const box_primitive* p) {
  const real along = along_up(p);
  const real sine = div_up(mul_up(REAL(p->curvature), upper), w_q);
  const real cosine = sqrt_down(sub_down(REAL(1.0), mul_up(sine, sine)));
  const real angle = div_up(sine, cosine);
  const integer holds = MASK(sine < 1.0) & MASK(cosine > 0.0) &
                        MASK(add_up(along, interval_abs(gamma_q).hi) <= THREE_QUARTERS_OF_A_TURN);
  const interval size = interval_abs(apart);
  const angles_of_solid near = {
      select(all.turn, fmin(all.turn, positive_part(sub_up(angle, size.lo))), holds),
      select(all.between, fmin(all.between, mul_up(REAL(0.5), add_up(angle, size.hi))), holds)};
  return near;
}

// Whether f lies above its tangent plane at x_0 in all points of K within `upper` of q.
ALWAYS_INLINE integer above_tangent(unbent x, unbent q, real upper, MODEL_SPACE const box_primitive* p) {
  const interval k = interval_of(REAL(p->curvature), REAL(p->curvature));
  const interval gamma_0 = interval_mul(k, x.z);
  const interval gamma_q = interval_mul(k, q.z);
  const interval apart = interval_mul(k, interval_sub(x.z, q.z));
  const interval cosine = interval_add(interval_mul(x.cosine, q.cosine), interval_mul(x.sine, q.sine));
  const interval sine = interval_sub(interval_mul(x.sine, q.cosine), interval_mul(x.cosine, q.sine));
  const angles_of_solid all = angles_of_all(gamma_0, gamma_q, apart, p);
  const angles_of_solid near = angles_nearby(all, apart, gamma_q, q.w.lo, upper, p);
  // Near the cut of the angle z is any number, or none. Within half a turn the sine has the sign of D.
  const integer known = MASK(interval_abs(gamma_0).hi <= WHOLE_TURN) & MASK(interval_abs(gamma_q).hi <= WHOLE_TURN) &
                        MASK(interval_abs(apart).hi <= BELOW_HALF_A_TURN);
  const real curving = sub_down(cosine.lo, mul_up(interval_abs(sine).hi, turn_quotient_up(near.turn)));
  return known & MASK(curving > 0.0) & MASK(mul_down(x.w.lo, curving) >= mul_up(q.w.hi, squared_sine_up(near.between)));
}

// What p proves about the distance of q to the bent solid, both in the axes of the bend.
ALWAYS_INLINE interval distance_by_point(vector3 q, unbent unbent_q, vector3 at, MODEL_SPACE const box_primitive* p) {
  const unbent x = unbend_point(at, p->curvature);
  const interval3 d = difference_of(at, q);
  const interval3 gradient = half_gradient_enclosed(d, x);
  const interval3 place = about_focus_enclosed(unbent_place(x, at.y), &p->solid);
  const interval along =
      interval_add(interval_mul(gradient.x, place.x),
                   interval_add(interval_mul(gradient.y, place.y), interval_mul(gradient.z, place.z)));
  const interval3 v = enclosed_in_own_axes(opposite_of(gradient), p);
  const interval3 own = enclosed_in_own_axes(place, p);
  const interval3 apart = sizes_of(d);

  const real excess = excess_up_at(own, &p->solid);
  // (1 - e) x_0 lies in K for e = max(excess, 0) <= 1, and bending moves it from p by at most twice its way from x_0:
  // 1 - k r <= 2 near K.
  const real outside = fmax(excess, REAL(0.0));
  const real moved = mul_up(REAL(2.0), mul_up(outside, length_up(upper_ends(sizes_of(own)))));
  const real farthest = add_up(length_up(upper_ends(apart)), moved);
  const integer near = MASK(excess <= 0.5 * NEIGHBOURHOOD) & MASK(farthest <= DBL_MAX);
  const real upper = select(REAL(INFINITY), farthest, near);

  const real loss = mul_up(REAL(2.0), add_up(support_over_up(v, own, &p->solid), along.hi));
  const vector3 least = lower_ends(apart);
  const real square = sub_down(dot_down(least, least), loss);
  const integer valid = above_tangent(x, unbent_q, upper, p) & MASK(square >= 0.0) & MASK(square <= DBL_MAX);
  return interval_of(select(REAL(0.0), sqrt_down(square), valid), upper);
}

// Column by column: ends of enclosures, and normals.
typedef struct {
  global double *los, *his, *normal_xs, *normal_ys, *normal_zs;
} evidence_columns;

// Nothing is known of them.
ALWAYS_INLINE void forget_group(ulong group, evidence_columns columns) {
  STORE(REAL(-INFINITY), group, columns.los);
  STORE(REAL(INFINITY), group, columns.his);
  STORE(REAL(0.0), group, columns.normal_xs);
  STORE(REAL(0.0), group, columns.normal_ys);
  STORE(REAL(0.0), group, columns.normal_zs);
}

// How many points of a block are proven to lie outside, and inside.
typedef struct {
  uint outside, inside;
} block_counts;

// Lists those outside from the first place on, those inside from the last place back. `size` is that of the block.
ALWAYS_INLINE block_counts list_by_side(ulong first, uint size, global const double* xs, global const double* ys,
                                        global const double* zs, MODEL_SPACE const box_primitive* p,
                                        evidence_columns columns, global uint* listed) {
  block_counts counts = {0, 0};
  for (ulong group = first; group < first + size / VECTOR_WIDTH; ++group) {
    forget_group(group, columns);
    const cube here = {point_at(group, xs, ys, zs), REAL(0.0)};
    const colour own = bent_colour(here, p);
    long is_outside[VECTOR_WIDTH], is_inside[VECTOR_WIDTH];
    STORE(own.white, 0, is_outside);
    STORE(own.black, 0, is_inside);
    for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) {
      const uint point = (uint)(group * VECTOR_WIDTH + lane);
      if (is_outside[lane] != 0) listed[counts.outside++] = point;
      if (is_inside[lane] != 0) listed[size - ++counts.inside] = point;
    }
  }
  return counts;
}

// Of those outside from `start` on, or of those inside; lanes beyond the last repeat it.
ALWAYS_INLINE void take_outside(uint start, block_counts counts, global const uint* listed, lane_indices* indices) {
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane)
    indices->of_lane[lane] = listed[min(start + lane, counts.outside - 1)];
}
ALWAYS_INLINE void take_inside(uint start, uint size, block_counts counts, global const uint* listed,
                               lane_indices* indices) {
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane)
    indices->of_lane[lane] = listed[size - 1 - min(start + lane, counts.inside - 1)];
}

// A point in the frame of the bend, and unbent.
typedef struct {
  vector3 q;
  real error; // of distances: of the frame, and of what is bent
  unbent u;
  vector3 middle; // of u
  integer usable;
} bent_query;

ALWAYS_INLINE bent_query query_at(vector3 x, MODEL_SPACE const box_primitive* p) {
  const vector3 d = {x.x - p->solid.translation[0], x.y - p->solid.translation[1], x.z - p->solid.translation[2]};
  const vector3 q = {dot3(p->frame[0], p->frame[1], p->frame[2], d), dot3(p->frame[3], p->frame[4], p->frame[5], d),
                     dot3(p->frame[6], p->frame[7], p->frame[8], d)};
  const real size = add_up(fabs(d.x), add_up(fabs(d.y), fabs(d.z)));
  const real of_frame = fma_up(REAL(p->frame_error), size, REAL(0x1p-1000));
  const unbent u = unbend_point(q, p->curvature);
  const vector3 middle = {middle_of(u.r), q.y, middle_of(u.z)};
  const integer usable = MASK(fabs(middle.x) <= DBL_MAX) & MASK(fabs(middle.z) <= DBL_MAX);
  const bent_query query = {q, add_up(of_frame, bent_solid_error(&p->solid)), u, middle, usable};
  return query;
}

// Of the first `count` lanes, where usable.
ALWAYS_INLINE void scatter_evidence(interval distance, vector3 normal, bent_query query, uint count,
                                    const lane_indices* indices, evidence_columns columns) {
  const integer usable = query.usable;
  scatter(select(REAL(-INFINITY), sub_down(distance.lo, query.error), usable), count, indices, columns.los);
  scatter(select(REAL(INFINITY), add_up(distance.hi, query.error), usable), count, indices, columns.his);
  const vector3 known = where(usable, normal);
  scatter(known.x, count, indices, columns.normal_xs);
  scatter(known.y, count, indices, columns.normal_ys);
  scatter(known.z, count, indices, columns.normal_zs);
}

// For points proven to lie outside or inside; others get nothing (-infinity, infinity), as do those inside of which no
// ball is proven. Normals lead from the closest point to the query in the frame of the bend, inside from the query. A
// work-item owns a block of groups; the points on either side are gathered from it, because what is proven of them is
// different. `listed` has room for all points.
kernel void bent_distance(ulong groups, uint groups_per_block, global const double* xs, global const double* ys,
                          global const double* zs, MODEL_SPACE const box_primitive* primitives, uint index,
                          global uint* listed, global double* los, global double* his, global double* normal_xs,
                          global double* normal_ys, global double* normal_zs) {
  MODEL_SPACE const box_primitive* p = primitives + index;
  const ulong first = get_global_id(0) * groups_per_block;
  if (first >= groups) return;
  const uint size = (uint)(min(first + groups_per_block, groups) - first) * VECTOR_WIDTH;
  const evidence_columns columns = {los, his, normal_xs, normal_ys, normal_zs};
  global uint* own = listed + first * VECTOR_WIDTH;
  const block_counts counts = list_by_side(first, size, xs, ys, zs, p, columns, own);
  lane_indices indices;
  for (uint start = 0; start < counts.outside; start += VECTOR_WIDTH) {
    take_outside(start, counts, own, &indices);
    const bent_query x = query_at(gathered_point(&indices, xs, ys, zs), p);
    const vector3 at = bend_nearest(closest_unbent(x.q, where(x.usable, x.middle), x.u.w.hi, p), p->curvature);
    const interval found = distance_by_point(x.q, x.u, at, p);
    const vector3 apart = {x.q.x - at.x, x.q.y - at.y, x.q.z - at.z};
    scatter_evidence(found, apart, x, min(counts.outside - start, (uint)VECTOR_WIDTH), &indices, columns);
  }
  if (!has_depths_by_balls(p)) return;
  for (uint start = 0; start < counts.inside; start += VECTOR_WIDTH) {
    take_inside(start, size, counts, own, &indices);
    const bent_query x = query_at(gathered_point(&indices, xs, ys, zs), p);
    const proven_depth found = depth_by_ball(x.q, x.u, x.usable, p);
    scatter_evidence(found.distance, found.way, x, min(counts.inside - start, (uint)VECTOR_WIDTH), &indices, columns);
  }
}
