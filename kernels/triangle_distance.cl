// This layer proposes where a triangle comes closest to a superquadric (docs/mathematics.md §6). Like projection.clh it
// proves nothing.
//
// Half the squared distance of a point of the triangle t(w) = t0 + w1 e1 + w2 e2 to the solid is convex in w, its
// gradient is v.e_i with v the vector from the closest point, and its Hessian e_i.H e_j has 0 <= H <= 1: Newton's
// method on the triangle, each step a quadratic program that has a closed form.

typedef struct {
  vector3 corner, edge1, edge2; // t0, t1 - t0, t2 - t0 in the primitive's frame, to nearest
} local_triangle;

// w1, w2 >= 0 with w1 + w2 <= 1.
typedef struct {
  real w1, w2;
} triangle_weights;

ALWAYS_INLINE vector3 point_of(local_triangle t, triangle_weights w) {
  const vector3 p = {fma(w.w1, t.edge1.x, fma(w.w2, t.edge2.x, t.corner.x)),
                     fma(w.w1, t.edge1.y, fma(w.w2, t.edge2.y, t.corner.y)),
                     fma(w.w1, t.edge1.z, fma(w.w2, t.edge2.z, t.corner.z))};
  return p;
}

// Gradient and Hessian of a function of the weights at some w.
typedef struct {
  real g1, g2, h11, h12, h22;
} quadratic_model;

ALWAYS_INLINE real clamp_unit(real x) { return clamp(x, 0.0, 1.0); } // NaN where x is

// The least value over the triangle of the quadratic function with gradient (g1, g2) at w = 0 and a Hessian that is
// positive semidefinite: inside where the Hessian is definite, else on the best of the three edges.
ALWAYS_INLINE triangle_weights least_of(quadratic_model m) {
  const real determinant = m.h11 * m.h22 - m.h12 * m.h12;
  const real inverse = 1.0 / fmax(determinant, SMALLEST_NORMAL);
  const real inner1 = (m.h12 * m.g2 - m.h22 * m.g1) * inverse;
  const real inner2 = (m.h12 * m.g1 - m.h11 * m.g2) * inverse;
  const integer inside = MASK(determinant > 1e-14 * m.h11 * m.h22) & MASK(inner1 > 0.0) & MASK(inner2 > 0.0) &
                         MASK(inner1 + inner2 < 1.0);
  const real on1 = clamp_unit(-m.g1 / fmax(m.h11, SMALLEST_NORMAL));
  const real on2 = clamp_unit(-m.g2 / fmax(m.h22, SMALLEST_NORMAL));
  const real along = clamp_unit((m.g1 - m.g2 + m.h11 - m.h12) / fmax(m.h11 - 2.0 * m.h12 + m.h22, SMALLEST_NORMAL));
  const real value1 = on1 * (m.g1 + 0.5 * m.h11 * on1);
  const real value2 = on2 * (m.g2 + 0.5 * m.h22 * on2);
  const real opposite = 1.0 - along;
  const real value3 = opposite * (m.g1 + 0.5 * m.h11 * opposite) + along * (m.g2 + 0.5 * m.h22 * along) +
                      m.h12 * opposite * along;
  const integer second = MASK(value2 < value1);
  const integer third = MASK(value3 < fmin(value1, value2));
  triangle_weights w;
  w.w1 = select(select(select(on1, REAL(0.0), second), opposite, third), inner1, inside);
  w.w2 = select(select(select(REAL(0.0), on2, second), along, third), inner2, inside);
  return w;
}

// The same function with a changed Hessian: value and gradient at `at` stay.
ALWAYS_INLINE quadratic_model changed_hessian(quadratic_model m, triangle_weights at, real h11, real h12, real h22) {
  const quadratic_model changed = {m.g1 - (h11 * at.w1 + h12 * at.w2), m.g2 - (h12 * at.w1 + h22 * at.w2),
                                   m.h11 + h11, m.h12 + h12, m.h22 + h22};
  return changed;
}

// The point of the triangle nearest to the centre where lengths are measured in semi-axes: where the search starts.
ALWAYS_INLINE triangle_weights nearest_to_centre(local_triangle t, MODEL_SPACE const superquadric* s) {
  const real x = REAL(s->inverse_axes_up[0]);
  const real y = REAL(s->inverse_axes_up[1]);
  const real z = REAL(s->inverse_axes_up[2]);
  const vector3 c = {t.corner.x * x, t.corner.y * y, t.corner.z * z};
  const vector3 e1 = {t.edge1.x * x, t.edge1.y * y, t.edge1.z * z};
  const vector3 e2 = {t.edge2.x * x, t.edge2.y * y, t.edge2.z * z};
  const quadratic_model m = {dot_nearest(c, e1), dot_nearest(c, e2), dot_nearest(e1, e1), dot_nearest(e1, e2),
                             dot_nearest(e2, e2)};
  return least_of(m);
}

ALWAYS_INLINE triangle_weights select_weights(triangle_weights a, triangle_weights b, integer take_b) {
  const triangle_weights w = {select(a.w1, b.w1, take_b), select(a.w2, b.w2, take_b)};
  return w;
}

// A point of the triangle and half its squared distance as a function of the weights.
typedef struct {
  triangle_weights weights;
  vector3 vector;           // from the closest point of the solid; 0 inside
  vector3 change1, change2; // of the vector with the weights: H e1, H e2
  real value;
  quadratic_model model;    // at w = 0
  integer inside;
  log_unknowns unknowns;    // of the closest point
} contact_probe;

ALWAYS_INLINE contact_probe contact_at(local_triangle t, triangle_weights w, distance_probe at,
                                       MODEL_SPACE const superquadric* s) {
  contact_probe c;
  c.weights = w;
  c.vector = at.gradient;
  c.change1 = hessian_times(at, t.edge1, s);
  c.change2 = hessian_times(at, t.edge2, s);
  c.value = at.value;
  c.model.h11 = dot_nearest(c.change1, t.edge1);
  c.model.h12 = dot_nearest(c.change1, t.edge2);
  c.model.h22 = dot_nearest(c.change2, t.edge2);
  c.model.g1 = dot_nearest(c.vector, t.edge1) - (c.model.h11 * w.w1 + c.model.h12 * w.w2);
  c.model.g2 = dot_nearest(c.vector, t.edge2) - (c.model.h12 * w.w1 + c.model.h22 * w.w2);
  c.inside = at.inside;
  c.unknowns = at.closest.unknowns;
  return c;
}

ALWAYS_INLINE contact_probe select_contact(contact_probe a, contact_probe b, integer take_b) {
  contact_probe c;
  c.weights = select_weights(a.weights, b.weights, take_b);
  c.vector = select_vector(a.vector, b.vector, take_b);
  c.change1 = select_vector(a.change1, b.change1, take_b);
  c.change2 = select_vector(a.change2, b.change2, take_b);
  c.value = select(a.value, b.value, take_b);
  c.model.g1 = select(a.model.g1, b.model.g1, take_b);
  c.model.g2 = select(a.model.g2, b.model.g2, take_b);
  c.model.h11 = select(a.model.h11, b.model.h11, take_b);
  c.model.h12 = select(a.model.h12, b.model.h12, take_b);
  c.model.h22 = select(a.model.h22, b.model.h22, take_b);
  c.inside = select_mask(a.inside, b.inside, take_b);
  c.unknowns = select_unknowns(a.unknowns, b.unknowns, take_b);
  return c;
}

// What moving over the whole triangle can still gain at most, by convexity.
ALWAYS_INLINE real promised_gain(local_triangle t, contact_probe p) {
  const real g1 = dot_nearest(p.vector, t.edge1);
  const real g2 = dot_nearest(p.vector, t.edge2);
  return g1 * p.weights.w1 + g2 * p.weights.w2 - fmin(REAL(0.0), fmin(g1, g2));
}

// The Hessian less what makes Newton's method stop on the surface of the solid: of half the square of distance + depth
// instead, whose minima are the same, so that a triangle that meets the solid is followed into it.
ALWAYS_INLINE quadratic_model aimed_inside(local_triangle t, contact_probe p, real depth) {
  const real g1 = dot_nearest(p.vector, t.edge1);
  const real g2 = dot_nearest(p.vector, t.edge2);
  const real distance = sqrt(2.0 * p.value);
  const real part = depth / (fmax(2.0 * p.value, SMALLEST_NORMAL) * (distance + depth));
  return changed_hessian(p.model, p.weights, -part * g1 * g1, -part * g1 * g2, -part * g2 * g2);
}

#define CONTACT_ROUNDS 24
// Converged when the gain promised is this part of the squared distance: the step then taken leaves about its square.
#define CONVERGED_GAIN 1e-12
#define ROUNDING_GAIN 1e-14 // of distance times edge: below it there is nothing but rounding error
#define SAME_VALUE 1e-13
#define AIMED_DEPTH 0.0625  // of the inradius

// Newton's method with the Hessian blended towards its upper bound, 1, after a step that gains nothing: with the bound
// itself every step gains.
ALWAYS_INLINE contact_probe triangle_contact(local_triangle t, MODEL_SPACE const superquadric* s) {
  const quadratic_model bound = {REAL(0.0), REAL(0.0), dot_nearest(t.edge1, t.edge1), dot_nearest(t.edge1, t.edge2),
                                 dot_nearest(t.edge2, t.edge2)};
  const real rounding_gain = ROUNDING_GAIN * sqrt(fmax(bound.h11, bound.h22));
  const real depth = REAL(AIMED_DEPTH * s->inradius_down);
  const triangle_weights start = nearest_to_centre(t, s);
  contact_probe best = contact_at(t, start, first_probe(point_of(t, start), s), s);
  real blend = REAL(1e-14);
  for (int round = 0; round < CONTACT_ROUNDS; ++round) {
    const quadratic_model aimed = aimed_inside(t, best, depth);
    const quadratic_model blended =
        changed_hessian(aimed, best.weights, blend * (bound.h11 - aimed.h11), blend * (bound.h12 - aimed.h12),
                        blend * (bound.h22 - aimed.h22));
    const integer converged =
        best.inside | MASK(promised_gain(t, best) <= 2.0 * CONVERGED_GAIN * best.value +
                                                         rounding_gain * sqrt(2.0 * best.value));
    const triangle_weights w = select_weights(least_of(blended), best.weights, best.inside);
    const contact_probe next = contact_at(t, w, next_probe(point_of(t, w), best.unknowns, s), s);
    // Where only rounding tells the values apart, the gain promised says which is nearer to the optimum.
    const integer better = ~best.inside & (MASK(next.value < best.value) |
                                           (MASK(next.value <= best.value * (1.0 + SAME_VALUE)) &
                                            MASK(promised_gain(t, next) < promised_gain(t, best))));
    best = select_contact(best, next, better);
    blend = select(fmin(fmax(4.0 * blend, REAL(0.05)), REAL(1.0)), fmax(0.1 * blend, REAL(1e-14)), better);
    if (!any(~converged)) break;
  }
  return best;
}

// This file implements the enclosure of the distance of triangles to one superquadric (docs/mathematics.md §6), 0 where
// they meet.
//
// For any v every point of the triangle is at least (min_i v.t_i - h(v)) / |v| away from the solid; a point of the
// triangle and one of the solid bound the distance from above.

typedef struct {
  vector3 corners[3]; // in the primitive's own frame
  real error;         // distance of a computed from an exact corner, at most
} posed_triangle;

// `corners` holds nine columns of `stride` numbers: x, y, z of the first corners, then of the second, of the third.
ALWAYS_INLINE posed_triangle load_triangle(ulong group, ulong stride, global const double* corners,
                                           MODEL_SPACE const superquadric* s) {
  posed_triangle t;
  t.error = REAL(0.0);
  for (int k = 0; k < 3; ++k) {
    const vector3 x = {LOAD(group, corners + (3 * k) * stride), LOAD(group, corners + (3 * k + 1) * stride),
                       LOAD(group, corners + (3 * k + 2) * stride)};
    const local_point q = to_local(x, s);
    t.corners[k] = out_of_octant(q.point, q.sign);
    t.error = greatest_or_nan(t.error, q.error);
  }
  return t;
}

// A lower bound without a search: the first corner's distance from the centre less the longer edge at it and the
// circumradius of the solid.
ALWAYS_INLINE real sphere_distance_down(posed_triangle t, MODEL_SPACE const superquadric* s) {
  real reach = REAL(0.0);
  for (int k = 1; k < 3; ++k) {
    const vector3 a = t.corners[0];
    const vector3 b = t.corners[k];
    const vector3 edge = {greatest_or_nan(sub_up(a.x, b.x), sub_up(b.x, a.x)),
                          greatest_or_nan(sub_up(a.y, b.y), sub_up(b.y, a.y)),
                          greatest_or_nan(sub_up(a.z, b.z), sub_up(b.z, a.z))};
    reach = greatest_or_nan(reach, length_up(edge));
  }
  const real from_centre = length_down(magnitudes(t.corners[0]));
  return sub_down(sub_down(sub_down(from_centre, reach), REAL(s->circumradius_up)), t.error);
}

// Where on the triangle a point lies: on an edge but at none of its ends, or on none.
typedef struct {
  integer edge1, edge2, edge3, face;
} contact_feature;

ALWAYS_INLINE contact_feature feature_of(triangle_weights w) {
  const real w0 = 1.0 - w.w1 - w.w2;
  const integer on1 = MASK(w.w1 > 0.0);
  const integer on2 = MASK(w.w2 > 0.0);
  const integer on0 = MASK(w0 > 1e-15); // rounding error
  const contact_feature f = {on0 & on1 & ~on2, on0 & on2 & ~on1, on1 & on2 & ~on0, on0 & on1 & on2};
  return f;
}

// What makes v orthogonal to the edge when v changes by multiples of `change`.
ALWAYS_INLINE vector3 made_orthogonal(vector3 v, vector3 edge, vector3 change, integer wanted) {
  const real rate = dot_nearest(change, edge);
  const real step = dot_nearest(v, edge) / rate;
  const real part = select(REAL(0.0), step, wanted & MASK(isfinite(step)));
  const vector3 u = {fma(-part, change.x, v.x), fma(-part, change.y, v.y), fma(-part, change.z, v.z)};
  return u;
}

// The vector of the contact made orthogonal to its edge or face, of whose share in v the lower bound loses the first
// power. It changes as it does when the point moves on the triangle, along the normals of the solid: where a solid is
// nearly flat, others lose as much as they gain.
ALWAYS_INLINE vector3 orthogonal_to_contact(contact_probe contact, local_triangle t) {
  const contact_feature f = feature_of(contact.weights);
  vector3 v = contact.vector;
  v = made_orthogonal(v, t.edge1, contact.change1, f.edge1 | f.face);
  v = made_orthogonal(v, t.edge2, contact.change2, f.edge2);
  const vector3 edge3 = vector_difference(t.edge2, t.edge1);
  v = made_orthogonal(v, edge3, vector_difference(contact.change2, contact.change1), f.edge3);
  // Of the changes, that which leaves v orthogonal to the first edge.
  const vector3 change = made_orthogonal(contact.change2, t.edge1, contact.change1, f.face);
  return made_orthogonal(v, t.edge2, change, f.face);
}

// Lower bound of the distance that the vector v proves, whatever it is: not below 0, also for NaN.
ALWAYS_INLINE real triangle_distance_down(posed_triangle t, vector3 v, MODEL_SPACE const superquadric* s) {
  const real nearest_corner =
      least_or_nan(dot_down(v, t.corners[0]), least_or_nan(dot_down(v, t.corners[1]), dot_down(v, t.corners[2])));
  const real numerator = sub_down(nearest_corner, support_up(magnitudes(v), s));
  const real bound = div_down(numerator, length_up(magnitudes(v))); // where the numerator is below 0, 0 is the bound
  return fmax(sub_down(bound, t.error), REAL(0.0));
}

// Weights that are certainly those of a point of the triangle: w1 + w2 <= 1 exactly.
ALWAYS_INLINE triangle_weights certain_weights(triangle_weights w) {
  triangle_weights certain;
  certain.w2 = clamp_unit(w.w2);
  const real largest = select(fmax(sub_down(REAL(1.0), certain.w2), REAL(0.0)), REAL(1.0), MASK(certain.w2 == 0.0));
  certain.w1 = fmin(clamp_unit(w.w1), largest);
  return certain;
}

// Upper bounds of |coordinates| of the triangle's point at exactly these weights.
ALWAYS_INLINE real coordinate_magnitude_up(real c0, real c1, real c2, triangle_weights w) {
  const real up = fma_up(w.w2, sub_up(c2, c0), fma_up(w.w1, sub_up(c1, c0), c0));
  const real down = fma_down(w.w2, sub_down(c2, c0), fma_down(w.w1, sub_down(c1, c0), c0));
  return greatest_or_nan(up, -down);
}

ALWAYS_INLINE vector3 magnitudes_up(posed_triangle t, triangle_weights w) {
  const vector3 q = {coordinate_magnitude_up(t.corners[0].x, t.corners[1].x, t.corners[2].x, w),
                     coordinate_magnitude_up(t.corners[0].y, t.corners[1].y, t.corners[2].y, w),
                     coordinate_magnitude_up(t.corners[0].z, t.corners[1].z, t.corners[2].z, w)};
  return q;
}

// Upper bound of the distance, by the triangle's point at w and the solid's near that point less v. 0 where the former
// is proven to lie in the solid, wherever in reach of `error` the exact triangle has it: by the gauge's triangle
// inequality g rises by at most error / inradius.
ALWAYS_INLINE real triangle_distance_up(posed_triangle t, triangle_weights w, vector3 v,
                                        MODEL_SPACE const superquadric* s) {
  const vector3 q = magnitudes_up(t, w);
  const real gauge = exp_up(log_gauge_up(q, s));
  const integer meets = MASK(add_up(gauge, div_up(t.error, REAL(s->inradius_down))) <= 1.0);
  const vector3 size = magnitudes(v);
  const vector3 closest = {fmax(q.x - size.x, REAL(0.0)), fmax(q.y - size.y, REAL(0.0)), fmax(q.z - size.z, REAL(0.0))};
  return select(add_up(distance_up(q, closest, s), t.error), REAL(0.0), meets);
}

// Arrays as in point_distance, with the `weights` of the point that proves the upper end.
kernel void triangle_distance(ulong groups, ulong stride, global const double* corners,
                              MODEL_SPACE const superquadric* primitives, uint index, global double* nearest,
                              global double* los, global double* his, global double* normal_xs,
                              global double* normal_ys, global double* normal_zs, global double* weights_1,
                              global double* weights_2) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  MODEL_SPACE const superquadric* s = primitives + index;
  const posed_triangle t = load_triangle(group, stride, corners, s);
  const real known = index == 0 ? REAL(INFINITY) : LOAD(group, nearest);

  const real beyond_sphere = sphere_distance_down(t, s);
  if (!any(MASK(!(beyond_sphere > known)))) {
    STORE(beyond_sphere, group, los);
    STORE(REAL(INFINITY), group, his);
    STORE(REAL(0.0), group, normal_xs); // proves nothing: the sphere does
    STORE(REAL(0.0), group, normal_ys);
    STORE(REAL(0.0), group, normal_zs);
    return;
  }

  const local_triangle local_t = {t.corners[0], vector_difference(t.corners[1], t.corners[0]),
                                  vector_difference(t.corners[2], t.corners[0])};
  const contact_probe contact = triangle_contact(local_t, s);
  const triangle_weights w = certain_weights(contact.weights);
  const vector3 v = orthogonal_to_contact(contact, local_t);
  const real hi = triangle_distance_up(t, w, v, s);
  const real proven_hi = select(REAL(INFINITY), hi, MASK(hi <= DBL_MAX)); // NaN proves nothing
  STORE(triangle_distance_down(t, v, s), group, los);
  STORE(proven_hi, group, his);
  STORE(fmin(known, proven_hi), group, nearest);
  STORE(v.x, group, normal_xs);
  STORE(v.y, group, normal_ys);
  STORE(v.z, group, normal_zs);
  STORE(w.w1, group, weights_1);
  STORE(w.w2, group, weights_2);
}

// The distance to a union is the least of the primitives', also where they overlap. `stride` numbers a primitive in
// `los` and `his`, one primitive after the other.
kernel void triangle_union_distance(ulong groups, ulong stride, uint count, global const double* los,
                                    global const double* his, global double* union_los, global double* union_his) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  real lo = REAL(INFINITY);
  real hi = REAL(INFINITY);
  for (uint i = 0; i < count; ++i) {
    lo = fmin(lo, LOAD(group, los + i * stride));
    hi = fmin(hi, LOAD(group, his + i * stride));
  }
  STORE(lo, group, union_los);
  STORE(hi, group, union_his);
}
