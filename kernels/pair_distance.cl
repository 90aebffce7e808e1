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
