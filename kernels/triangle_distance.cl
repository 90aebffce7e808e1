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
