// This layer proposes the closest points of two superquadrics (docs/mathematics.md §7). Like projection.clh it proves
// nothing.
//
// The midpoint m of the shortest segment minimises half the squared distance to A plus that to B, which is convex:
// there the vectors from the two closest points cancel. Where A and B overlap, the minima are their common points.

// B in the frame of A: a point x of B is at rotation x + centre.
typedef struct {
  matrix3 rotation;
  vector3 centre;
} relative_pose;

// A symmetric matrix: Hessians stay alive through the search, where every number counts.
typedef struct {
  real xx, xy, xz, yy, yz, zz;
} symmetric3;

ALWAYS_INLINE matrix3 full_matrix(symmetric3 h) {
  const matrix3 m = {{h.xx, h.xy, h.xz}, {h.xy, h.yy, h.yz}, {h.xz, h.yz, h.zz}};
  return m;
}

// R H R^T
ALWAYS_INLINE symmetric3 turned_matrix(matrix3 rotation, symmetric3 h) {
  const matrix3 rows = product(rotation, full_matrix(h));
  const symmetric3 t = {dot_nearest(rows.x, rotation.x), dot_nearest(rows.x, rotation.y),
                        dot_nearest(rows.x, rotation.z), dot_nearest(rows.y, rotation.y),
                        dot_nearest(rows.y, rotation.z), dot_nearest(rows.z, rotation.z)};
  return t;
}

// a H + b v v^T
ALWAYS_INLINE symmetric3 with_square(real a, symmetric3 h, real b, vector3 v) {
  const vector3 w = {b * v.x, b * v.y, b * v.z};
  const symmetric3 m = {fma(a, h.xx, w.x * v.x), fma(a, h.xy, w.x * v.y), fma(a, h.xz, w.x * v.z),
                        fma(a, h.yy, w.y * v.y), fma(a, h.yz, w.y * v.z), fma(a, h.zz, w.z * v.z)};
  return m;
}

// The midpoint and what both solids say there, in the frame of A.
typedef struct {
  vector3 point;
  vector3 from_a, from_b;     // vectors from their closest points
  real value_a, value_b;      // half their squares
  symmetric3 hessian_a, hessian_b;
  integer inside_a, inside_b;
  log_unknowns unknowns_a, unknowns_b;
} midpoint_probe;

ALWAYS_INLINE symmetric3 hessian_of(distance_probe at, MODEL_SPACE const superquadric* s) {
  const vector3 ex = {REAL(1.0), REAL(0.0), REAL(0.0)};
  const vector3 ey = {REAL(0.0), REAL(1.0), REAL(0.0)};
  const vector3 ez = {REAL(0.0), REAL(0.0), REAL(1.0)};
  const vector3 x = hessian_times(at, ex, s);
  const vector3 y = hessian_times(at, ey, s);
  const symmetric3 h = {x.x, x.y, x.z, y.y, y.z, hessian_times(at, ez, s).z};
  return h;
}

ALWAYS_INLINE midpoint_probe midpoint_at(vector3 m, distance_probe a, distance_probe b, relative_pose pose,
                                         MODEL_SPACE const superquadric* solid_a,
                                         MODEL_SPACE const superquadric* solid_b) {
  midpoint_probe p;
  p.point = m;
  p.from_a = a.gradient;
  p.from_b = matrix_times(pose.rotation, b.gradient);
  p.value_a = a.value;
  p.value_b = b.value;
  p.hessian_a = hessian_of(a, solid_a);
  p.hessian_b = turned_matrix(pose.rotation, hessian_of(b, solid_b));
  p.inside_a = a.inside;
  p.inside_b = b.inside;
  p.unknowns_a = a.closest.unknowns;
  p.unknowns_b = b.closest.unknowns;
  return p;
}

ALWAYS_INLINE symmetric3 select_matrix(symmetric3 a, symmetric3 b, integer take_b) {
  const symmetric3 m = {select(a.xx, b.xx, take_b), select(a.xy, b.xy, take_b), select(a.xz, b.xz, take_b),
                        select(a.yy, b.yy, take_b), select(a.yz, b.yz, take_b), select(a.zz, b.zz, take_b)};
  return m;
}

ALWAYS_INLINE midpoint_probe select_midpoint(midpoint_probe a, midpoint_probe b, integer take_b) {
  midpoint_probe p;
  p.point = select_vector(a.point, b.point, take_b);
  p.from_a = select_vector(a.from_a, b.from_a, take_b);
  p.from_b = select_vector(a.from_b, b.from_b, take_b);
  p.value_a = select(a.value_a, b.value_a, take_b);
  p.value_b = select(a.value_b, b.value_b, take_b);
  p.hessian_a = select_matrix(a.hessian_a, b.hessian_a, take_b);
  p.hessian_b = select_matrix(a.hessian_b, b.hessian_b, take_b);
  p.inside_a = select_mask(a.inside_a, b.inside_a, take_b);
  p.inside_b = select_mask(a.inside_b, b.inside_b, take_b);
  p.unknowns_a = select_unknowns(a.unknowns_a, b.unknowns_a, take_b);
  p.unknowns_b = select_unknowns(a.unknowns_b, b.unknowns_b, take_b);
  return p;
}

// Gradient and Hessian of one solid's share in the function.
typedef struct {
  vector3 gradient;
  symmetric3 hessian;
} newton_terms;

// Of half the square of distance + depth instead of the distance: the minima are the same, but Newton's method does not
// stop on the surface of solids that overlap. Nothing inside.
ALWAYS_INLINE newton_terms terms_aimed_inside(vector3 v, real value, symmetric3 h, integer inside, real depth) {
  const real squared = fmax(2.0 * value, SMALLEST_NORMAL);
  const real part = depth / sqrt(squared);
  const symmetric3 aimed = with_square(1.0 + part, h, -part / squared, v);
  const vector3 zero = {REAL(0.0), REAL(0.0), REAL(0.0)};
  const symmetric3 flat = {REAL(0.0), REAL(0.0), REAL(0.0), REAL(0.0), REAL(0.0), REAL(0.0)};
  const vector3 gradient = {(1.0 + part) * v.x, (1.0 + part) * v.y, (1.0 + part) * v.z};
  newton_terms terms;
  terms.gradient = select_vector(gradient, zero, inside);
  terms.hessian = select_matrix(aimed, flat, inside);
  return terms;
}

#define PAIR_ROUNDS 64
// Converged when the vectors cancel but for this part of their length.
#define CANCELLED 1e-11
// How deep a step aims: this part of the distance between the solids, and no less than that of their inradius.
#define AIMED_OVERSHOOT 0.25
#define SMALLEST_AIMED_DEPTH 1e-6

// The step of Newton's method, its Hessian blended by `blend` towards the bound 2 of that of the sum.
ALWAYS_INLINE vector3 midpoint_step(midpoint_probe at, real depth, real blend) {
  const newton_terms a = terms_aimed_inside(at.from_a, at.value_a, at.hessian_a, at.inside_a, depth);
  const newton_terms b = terms_aimed_inside(at.from_b, at.value_b, at.hessian_b, at.inside_b, depth);
  const real rest = 1.0 - blend;
  const real bound = 2.0 * blend;
  const symmetric3 h = {fma(rest, a.hessian.xx + b.hessian.xx, bound), rest * (a.hessian.xy + b.hessian.xy),
                        rest * (a.hessian.xz + b.hessian.xz),          fma(rest, a.hessian.yy + b.hessian.yy, bound),
                        rest * (a.hessian.yz + b.hessian.yz),          fma(rest, a.hessian.zz + b.hessian.zz, bound)};
  return solve_symmetric(full_matrix(h), vector_sum(a.gradient, b.gradient));
}

// |vector from A + vector from B|: 0 at the midpoint.
ALWAYS_INLINE real imbalance(midpoint_probe p) {
  const vector3 sum = vector_sum(p.from_a, p.from_b);
  return sqrt(dot_nearest(sum, sum));
}

#define SAME_PAIR_VALUE 1e-13
#define SMALLEST_BLEND 1e-13

// The part of the way from the centre along x that lies in the solid, about.
ALWAYS_INLINE real reach_along(vector3 x, MODEL_SPACE const superquadric* s) {
  const vector3 log_x = {log_or_lowest(fabs(x.x)), log_or_lowest(fabs(x.y)), log_or_lowest(fabs(x.z))};
  return exp_nearest(clamp(-log_gauge_nearest(log_x, s), EXP_LOWEST, 0.0));
}

// Between the centres, where the radial projections leave the gap in the middle.
ALWAYS_INLINE vector3 midpoint_start(relative_pose pose, MODEL_SPACE const superquadric* solid_a,
                                     MODEL_SPACE const superquadric* solid_b) {
  const vector3 c = pose.centre;
  const real reach_b = reach_along(transposed_times(pose.rotation, c), solid_b);
  const real middle = 0.5 * (1.0 + reach_along(c, solid_a) - reach_b);
  const vector3 start = {middle * c.x, middle * c.y, middle * c.z};
  return start;
}

ALWAYS_INLINE vector3 in_frame_of_b(vector3 m, relative_pose pose) {
  return transposed_times(pose.rotation, vector_difference(m, pose.centre));
}

ALWAYS_INLINE midpoint_probe pair_contact(relative_pose pose, MODEL_SPACE const superquadric* solid_a,
                                          MODEL_SPACE const superquadric* solid_b) {
  const vector3 start = midpoint_start(pose, solid_a, solid_b);
  const vector3 start_of_b = in_frame_of_b(start, pose);
  midpoint_probe best =
      midpoint_at(start, first_probe(start, solid_a), first_probe(start_of_b, solid_b), pose, solid_a, solid_b);
  const real smallest_depth = REAL(SMALLEST_AIMED_DEPTH * fmin(solid_a->inradius_down, solid_b->inradius_down));
  real blend = REAL(SMALLEST_BLEND);
  for (int round = 0; round < PAIR_ROUNDS; ++round) {
    const integer common = best.inside_a & best.inside_b;
    const real value = best.value_a + best.value_b;
    const integer converged = common | MASK(imbalance(best) <= CANCELLED * sqrt(value));
    const int aimed = round & 1; // every other round: far from the minimum such a step may gain nothing
    const real distance = sqrt(2.0 * best.value_a) + sqrt(2.0 * best.value_b);
    const real depth = aimed ? fma(REAL(AIMED_OVERSHOOT), distance, smallest_depth) : REAL(0.0);
    const vector3 step = midpoint_step(best, depth, blend);
    const vector3 m = select_vector(vector_difference(best.point, step), best.point, common);
    const vector3 m_of_b = in_frame_of_b(m, pose);
    const midpoint_probe next = midpoint_at(m, next_probe(m, best.unknowns_a, solid_a),
                                            next_probe(m_of_b, best.unknowns_b, solid_b), pose, solid_a, solid_b);
    const real next_value = next.value_a + next.value_b;
    const integer better = ~common & (MASK(next_value < value) | (MASK(next_value <= value * (1.0 + SAME_PAIR_VALUE)) &
                                                                  MASK(imbalance(next) < imbalance(best))));
    best = select_midpoint(best, next, better);
    const real more = aimed ? blend : fmin(fmax(4.0 * blend, REAL(0.05)), REAL(1.0));
    blend = select(more, fmax(0.1 * blend, REAL(SMALLEST_BLEND)), better);
    if (!any(~converged)) break;
  }
  return best;
}

// The vector from A's closest point to B's, extrapolated by the step that is left: each solid's own vector then stays
// one of its normals, which matters where it is nearly flat.
ALWAYS_INLINE vector3 separation_of(midpoint_probe p) {
  const vector3 step = midpoint_step(p, REAL(0.0), REAL(SMALLEST_BLEND));
  const vector3 change_a = matrix_times(full_matrix(p.hessian_a), step);
  const vector3 change_b = matrix_times(full_matrix(p.hessian_b), step);
  const vector3 half_a = vector_difference(p.from_a, change_a);
  const vector3 half_b = vector_difference(p.from_b, change_b);
  const vector3 v = vector_difference(half_a, half_b);
  const vector3 plain = vector_difference(p.from_a, p.from_b);
  const integer usable = MASK(isfinite(v.x)) & MASK(isfinite(v.y)) & MASK(isfinite(v.z)) &
                         MASK(dot_nearest(step, step) <= 1e-4 * (p.value_a + p.value_b));
  return select_vector(plain, v, usable);
}

// This file implements the enclosure of the distance of two superquadrics, the second moved by a pose
// (docs/mathematics.md §7), 0 where they meet.
//
// For any v the distance is at least (v.c - h_A(v) - h_B(v)) / |v|, c from A's centre to B's; a point of each bounds it
// from above. Everything happens in A's own frame; of the numbers that place B in it only a bound of their error is
// known, and the distance is 1-Lipschitz in where B's points are.

// Bounds |computed - exact rotation x| / |x| for the rotation of B relative to A, R = Ra^T Rp Rb, and for its
// transpose. With u = 2^-53: the entries of Ra, Rp, Rb are the exact ones to within u, and each component of a product
// with a vector d carries at most three more roundings, so that a product's error is at most 5.1 u |d|_1 <= 8.9 u |d|.
// A column of Rb is off by at most 1.8 u, its product with Rp by 8.9 u more, that with Ra^T by 8.9 u more: 19.6 u in
// all, and the matrix by 19.6 sqrt(3) u = 34 u in the Frobenius norm. The product with x adds 3.1 sqrt(3) u: 39.4 u and
// terms in u^2.
#define PAIR_ROTATION_ERROR 0x1.4p-48 // 40 u

// Of a product with one given rotation, and of one difference of vectors, in units of |d|_1.
#define VECTOR_ERROR 0x1.8p-51 // 6 u

typedef struct {
  relative_pose pose; // to nearest
  real centre_error;  // distance of the computed from the exact centre, at most
} placed_pair;

ALWAYS_INLINE real norm1_up(vector3 a) { return add_up(fabs(a.x), add_up(fabs(a.y), fabs(a.z))); }

ALWAYS_INLINE matrix3 rotation_to_local(MODEL_SPACE const superquadric* s) {
  const matrix3 m = {{REAL(s->rotation[0]), REAL(s->rotation[1]), REAL(s->rotation[2])},
                     {REAL(s->rotation[3]), REAL(s->rotation[4]), REAL(s->rotation[5])},
                     {REAL(s->rotation[6]), REAL(s->rotation[7]), REAL(s->rotation[8])}};
  return m;
}

ALWAYS_INLINE vector3 translation_of(MODEL_SPACE const superquadric* s) {
  const vector3 t = {REAL(s->translation[0]), REAL(s->translation[1]), REAL(s->translation[2])};
  return t;
}

// `poses` holds twelve columns of `stride` numbers: the rotation row by row, each entry to within 2^-53, and the
// translation that move model B.
ALWAYS_INLINE placed_pair load_pair(ulong group, ulong stride, global const double* poses,
                                    MODEL_SPACE const superquadric* solid_a, MODEL_SPACE const superquadric* solid_b) {
#define POSE_COLUMN(k) LOAD(group, poses + (k) * stride)
  const matrix3 moved = {{POSE_COLUMN(0), POSE_COLUMN(1), POSE_COLUMN(2)},
                         {POSE_COLUMN(3), POSE_COLUMN(4), POSE_COLUMN(5)},
                         {POSE_COLUMN(6), POSE_COLUMN(7), POSE_COLUMN(8)}};
  const vector3 shift = {POSE_COLUMN(9), POSE_COLUMN(10), POSE_COLUMN(11)};
#undef POSE_COLUMN
  const matrix3 to_a = rotation_to_local(solid_a);
  const vector3 centre_b = translation_of(solid_b);
  const vector3 rotated = matrix_times(moved, centre_b);
  const vector3 shifted = vector_sum(rotated, shift);
  const vector3 apart = vector_difference(shifted, translation_of(solid_a));
  placed_pair p;
  p.pose.rotation = product(to_a, product(moved, transposed(rotation_to_local(solid_b))));
  p.pose.centre = matrix_times(to_a, apart);
  // Each of the four operations errs by at most VECTOR_ERROR of the 1-norm of its result or operand.
  const real sizes = add_up(add_up(norm1_up(centre_b), norm1_up(shifted)), add_up(norm1_up(apart), norm1_up(apart)));
  p.centre_error = fma_up(REAL(VECTOR_ERROR), sizes, REAL(0x1p-1000));
  return p;
}

// Lower bound of the distance that the vector v proves, whatever it is: not below 0, also for NaN. The support function
// of B is Lipschitz with its circumradius.
ALWAYS_INLINE real pair_distance_down(placed_pair p, vector3 v, MODEL_SPACE const superquadric* solid_a,
                                      MODEL_SPACE const superquadric* solid_b) {
  const vector3 v_of_b = transposed_times(p.pose.rotation, v);
  const real supports = add_up(support_up(magnitudes(v), solid_a), support_up(magnitudes(v_of_b), solid_b));
  const real numerator = sub_down(dot_down(v, p.pose.centre), supports);
  const real length = length_up(magnitudes(v));
  const real bound = div_down(numerator, length); // where the numerator is below 0, 0 is the bound
  const real error = fma_up(REAL(PAIR_ROTATION_ERROR), REAL(solid_b->circumradius_up), p.centre_error);
  // The errors of products are relative: underflow must be out of their reach.
  return select(REAL(0.0), fmax(sub_down(bound, error), REAL(0.0)), MASK(length >= 0x1p-500));
}

// The solid's point near x, exactly: (1 - L) |x| with L >= log g(x), rounded towards the centre (see distance_up).
ALWAYS_INLINE vector3 point_in_solid(vector3 x, MODEL_SPACE const superquadric* s) {
  const vector3 size = magnitudes(x);
  const real scale = sub_down(REAL(1.0), log_gauge_up(size, s)); // below 0 it gives the centre
  const vector3 b = {copysign(fmax(mul_down(size.x, scale), REAL(0.0)), x.x),
                     copysign(fmax(mul_down(size.y, scale), REAL(0.0)), x.y),
                     copysign(fmax(mul_down(size.z, scale), REAL(0.0)), x.z)};
  return b;
}

// Upper bound of the distance by the points of both solids near those given, each in its own frame.
ALWAYS_INLINE real pair_distance_up(placed_pair p, vector3 near_a, vector3 near_b,
                                    MODEL_SPACE const superquadric* solid_a, MODEL_SPACE const superquadric* solid_b) {
  const vector3 a = point_in_solid(near_a, solid_a);
  const vector3 b = matrix_times(p.pose.rotation, point_in_solid(near_b, solid_b));
  // b + centre - a, either way round.
  const vector3 c = p.pose.centre;
  const vector3 apart = {greatest_or_nan(sub_up(add_up(b.x, c.x), a.x), sub_up(a.x, add_down(b.x, c.x))),
                         greatest_or_nan(sub_up(add_up(b.y, c.y), a.y), sub_up(a.y, add_down(b.y, c.y))),
                         greatest_or_nan(sub_up(add_up(b.z, c.z), a.z), sub_up(a.z, add_down(b.z, c.z)))};
  const real error = fma_up(REAL(PAIR_ROTATION_ERROR), REAL(solid_b->circumradius_up), p.centre_error);
  return add_up(length_up(apart), error);
}

// Whether m is proven to lie in both solids. In B its place is known to within `error`, by which the gauge rises by at
// most error / inradius.
ALWAYS_INLINE integer is_common_point(placed_pair p, vector3 m, MODEL_SPACE const superquadric* solid_a,
                                      MODEL_SPACE const superquadric* solid_b) {
  const vector3 from_centre = vector_difference(m, p.pose.centre);
  const vector3 m_of_b = transposed_times(p.pose.rotation, from_centre);
  const real size = norm1_up(from_centre);
  const real error = fma_up(REAL(PAIR_ROTATION_ERROR + VECTOR_ERROR), size, p.centre_error);
  const real gauge_a = exp_up(log_gauge_up(magnitudes(m), solid_a));
  const real gauge_b = add_up(exp_up(log_gauge_up(magnitudes(m_of_b), solid_b)),
                              div_up(error, REAL(solid_b->inradius_down)));
  return MASK(gauge_a <= 1.0) & MASK(gauge_b <= 1.0);
}

// The least of all pairs so far is in `los` and `his`, unless this pair is the `first`.
kernel void pair_distance(ulong groups, ulong stride, global const double* poses,
                          MODEL_SPACE const superquadric* primitives, uint index_a, uint index_b, uint first,
                          global double* los, global double* his) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  MODEL_SPACE const superquadric* solid_a = primitives + index_a;
  MODEL_SPACE const superquadric* solid_b = primitives + index_b;
  const placed_pair p = load_pair(group, stride, poses, solid_a, solid_b);
  const real known_lo = first ? REAL(INFINITY) : LOAD(group, los);
  const real known_hi = first ? REAL(INFINITY) : LOAD(group, his);

  const real radii = add_up(REAL(solid_a->circumradius_up), REAL(solid_b->circumradius_up));
  const real between_spheres = sub_down(sub_down(length_down(magnitudes(p.pose.centre)), radii), p.centre_error);
  if (!any(MASK(!(between_spheres > known_hi)))) {
    STORE(fmin(known_lo, between_spheres), group, los);
    return;
  }

  const midpoint_probe contact = pair_contact(p.pose, solid_a, solid_b);
  const vector3 v = separation_of(contact);
  const vector3 near_a = vector_along(contact.point, REAL(-0.5), v);
  const vector3 near_b = transposed_times(
      p.pose.rotation, vector_difference(vector_along(contact.point, REAL(0.5), v), p.pose.centre));
  const real lo = pair_distance_down(p, v, solid_a, solid_b);
  const real hi = select(pair_distance_up(p, near_a, near_b, solid_a, solid_b), REAL(0.0),
                         is_common_point(p, contact.point, solid_a, solid_b));
  STORE(fmin(known_lo, lo), group, los);
  STORE(fmin(known_hi, hi), group, his); // NaN proves nothing and is forgotten
}
