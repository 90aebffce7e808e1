// This file implements the objective of a fit (paper Eq. (4)) for many candidates at once: signed distances of all
// points to each candidate, the sum of weight * f(distance), its gradient by the candidate's pose and semi-axes, and an
// upper bound of the sum over a cell of poses. Floating point: nothing here is proven. Where primitives are tapered,
// tapered_distance_gradient.clh before it says what the distance to one is.

#ifndef CANDIDATES_ARE_TAPERED
// By how much the widest section is larger than that in the middle.
ALWAYS_INLINE double widening_of(MODEL_SPACE const superquadric* s) { return 1.0; }

ALWAYS_INLINE signed_distance primitive_distance_at(vector3 q, integer wanted, MODEL_SPACE const superquadric* s) {
  return signed_distance_at(q, wanted, s);
}
#endif

// The signed distance to a union, in the cavity's frame and unit.
typedef struct {
  real distance;
  vector3 normal;        // gradient by the point
  integer primitive;     // that decides
  vector3 size_gradient; // by that primitive's semi-axes
} union_distance;

// The point in the primitive's own frame and unit.
ALWAYS_INLINE vector3 to_scaled_frame(vector3 x, MODEL_SPACE const superquadric* s) {
  const vector3 d = {x.x - s->translation[0], x.y - s->translation[1], x.z - s->translation[2]};
  const vector3 q = {dot3(s->rotation[0], s->rotation[1], s->rotation[2], d),
                     dot3(s->rotation[3], s->rotation[4], s->rotation[5], d),
                     dot3(s->rotation[6], s->rotation[7], s->rotation[8], d)};
  return q;
}

// The distance to the primitive's box: a lower bound for points outside the box, 0 in it.
ALWAYS_INLINE real distance_to_box(vector3 q, MODEL_SPACE const superquadric* s) {
  const double widening = widening_of(s);
  const vector3 apart = {fmax(fabs(q.x) - widening * s->semi_axes[0], REAL(0.0)),
                         fmax(fabs(q.y) - widening * s->semi_axes[1], REAL(0.0)),
                         fmax(fabs(q.z) - s->semi_axes[2], REAL(0.0))};
  return sqrt(dot_nearest(apart, apart));
}

ALWAYS_INLINE double first_lane(real a) {
  double lanes[VECTOR_WIDTH];
  STORE(a, 0, lanes);
  return lanes[0];
}

// The primitive whose box is nearest to the first point: found first, it lets most others be passed over, since the
// points of a vector lie close together.
ALWAYS_INLINE uint likely_nearest(vector3 x, MODEL_SPACE const scaled_superquadric* primitives, uint count) {
  uint nearest = 0;
  double least = INFINITY;
  for (uint i = 0; count > 1 && i < count; ++i) {
    const double apart = first_lane(distance_to_box(to_scaled_frame(x, &primitives[i].solid), &primitives[i].solid)) *
                         primitives[i].unit;
    if (apart < least) {
      least = apart;
      nearest = i;
    }
  }
  return nearest;
}

ALWAYS_INLINE union_distance nearer(union_distance a, union_distance b) {
  const integer take_b = MASK(b.distance < a.distance);
  union_distance least;
  least.distance = select(a.distance, b.distance, take_b);
  least.normal = select_vector(a.normal, b.normal, take_b);
  least.primitive = select_mask(a.primitive, b.primitive, take_b);
  least.size_gradient = select_vector(a.size_gradient, b.size_gradient, take_b);
  return least;
}

// The primitives' least signed distance: inside an overlap the depth is underestimated.
ALWAYS_INLINE union_distance union_distance_at(vector3 x, MODEL_SPACE const scaled_superquadric* primitives,
                                               uint count) {
  const uint first = likely_nearest(x, primitives, count);
  union_distance least;
  least.distance = REAL(INFINITY);
  least.normal = (vector3){REAL(0.0), REAL(0.0), REAL(0.0)};
  least.primitive = INTEGER(0);
  least.size_gradient = least.normal;
  for (uint n = 0; n < count; ++n) {
    const uint i = n == 0 ? first : n <= first ? n - 1 : n;
    MODEL_SPACE const superquadric* s = &primitives[i].solid;
    const double unit = primitives[i].unit;
    const vector3 q = to_scaled_frame(x, s);
    const integer wanted = MASK(distance_to_box(q, s) * unit <= fmax(least.distance, REAL(0.0)));
    if (!any(wanted)) continue;
    const signed_distance own = primitive_distance_at(q, wanted, s);
    union_distance other;
    other.distance = select(REAL(INFINITY), own.distance * unit, wanted);
    const vector3 turned = to_model_direction(own.normal, s); // the frame's rotation is divided by the unit
    other.normal = (vector3){turned.x * unit, turned.y * unit, turned.z * unit};
    other.primitive = INTEGER((long)i);
    // The support function h(n) rises by n_i x_i / a_i with a_i, x the closest point; with a taper too, which scales as
    // the semi-axes do.
    other.size_gradient.x = -own.normal.x * fma(-own.distance, own.normal.x, q.x) / s->semi_axes[0];
    other.size_gradient.y = -own.normal.y * fma(-own.distance, own.normal.y, q.y) / s->semi_axes[1];
    other.size_gradient.z = -own.normal.z * fma(-own.distance, own.normal.z, q.z) / s->semi_axes[2];
    least = nearer(least, other);
  }
  return least;
}

// f of include/verisq/clearance.hpp and its derivative.
typedef struct {
  real value, slope;
} fitness;

ALWAYS_INLINE fitness fitness_at(real distance, double target, double scale) {
  const real apart = (distance - target) / scale;
  const real pressed = fmin(distance, REAL(0.0)) / scale;
  const real peak = 1.0 / fma(apart, apart, REAL(1.0));
  fitness f;
  f.value = fma(-pressed, pressed, peak);
  f.slope = -2.0 * fma(apart * peak, peak, pressed) / scale;
  return f;
}

ALWAYS_INLINE double sum_of_lanes(real a) {
  double lanes[VECTOR_WIDTH];
  STORE(a, 0, lanes);
  double sum = lanes[0];
  for (int i = 1; i < VECTOR_WIDTH; ++i) sum += lanes[i];
  return sum;
}

ALWAYS_INLINE double least_of_lanes(real a) {
  double lanes[VECTOR_WIDTH];
  STORE(a, 0, lanes);
  double least = lanes[0];
  for (int i = 1; i < VECTOR_WIDTH; ++i) least = fmin(least, lanes[i]);
  return least;
}

// What is summed of each point, by its place: COLUMNS_OF_POSE numbers, then three a primitive.
#define OBJECTIVE 0
#define BOUND 1
#define TRANSLATION 2
#define ROTATION 5
#define SMALLEST_DISTANCE 8 // of which the least is taken
#define COLUMNS_OF_POSE 9

// The derivatives by semi-axes go to the sums of the primitives that decide: few of them in a vector.
ALWAYS_INLINE void add_size_gradient(union_distance at, real weighted_slope, uint count, global double* sums) {
  for (uint i = 0; i < count; ++i) {
    const integer decides = MASK(at.primitive == INTEGER((long)i));
    if (!any(decides)) continue;
    const real slope = select(REAL(0.0), weighted_slope, decides);
    sums[3 * i] += sum_of_lanes(slope * at.size_gradient.x);
    sums[3 * i + 1] += sum_of_lanes(slope * at.size_gradient.y);
    sums[3 * i + 2] += sum_of_lanes(slope * at.size_gradient.z);
  }
}

// A work-item sums over one slice of the points, vectors `slice`, `slice` + `slices` and so on of `groups`, for one
// candidate: `primitives` has `count` of each candidate, `pivots` three numbers, `partials` COLUMNS_OF_POSE + 3 `count`
// of each slice of each candidate. Within `cell_translation` and `cell_rotation` lie the poses that bounds hold for.
kernel void pose_objective(uint candidates, uint slices, uint groups, global const double* xs, global const double* ys,
                           global const double* zs, global const double* weights,
                           MODEL_SPACE const scaled_superquadric* primitives, uint count, global const double* pivots,
                           double target, double scale, double cell_translation, double cell_rotation,
                           global double* partials) {
  const ulong item = get_global_id(0);
  if (item >= (ulong)candidates * slices) return;
  const uint candidate = (uint)(item / slices);
  const uint slice = (uint)(item - (ulong)candidate * slices); // as a remainder Oclgrind could not read it
  MODEL_SPACE const scaled_superquadric* own = primitives + (ulong)candidate * count;
  const vector3 pivot = {REAL(pivots[3 * candidate]), REAL(pivots[3 * candidate + 1]),
                         REAL(pivots[3 * candidate + 2])};
  global double* sums = partials + item * (COLUMNS_OF_POSE + 3 * count);
  for (uint column = COLUMNS_OF_POSE; column < COLUMNS_OF_POSE + 3 * count; ++column) sums[column] = 0.0;

  real objective = REAL(0.0);
  real bound = REAL(0.0);
  real smallest_distance = REAL(INFINITY);
  vector3 translation = {REAL(0.0), REAL(0.0), REAL(0.0)};
  vector3 rotation = translation;
  for (uint group = slice; group < groups; group += slices) {
    const vector3 c = {LOAD(group, xs), LOAD(group, ys), LOAD(group, zs)};
    const real weight = LOAD(group, weights);
    const union_distance at = union_distance_at(c, own, count);
    const fitness f = fitness_at(at.distance, target, scale);
    const real slope = weight * f.slope;
    const vector3 arm = {c.x - pivot.x, c.y - pivot.y, c.z - pivot.z};
    objective = fma(weight, f.value, objective);
    translation.x = fma(-slope, at.normal.x, translation.x);
    translation.y = fma(-slope, at.normal.y, translation.y);
    translation.z = fma(-slope, at.normal.z, translation.z);
    rotation.x = fma(slope, arm.z * at.normal.y - arm.y * at.normal.z, rotation.x);
    rotation.y = fma(slope, arm.x * at.normal.z - arm.z * at.normal.x, rotation.y);
    rotation.z = fma(slope, arm.y * at.normal.x - arm.x * at.normal.y, rotation.z);
    smallest_distance = fmin(smallest_distance, at.distance);
    // f rises up to the target and falls beyond it: its largest value is at the reachable distance next to the target.
    const real reach = fma(REAL(cell_rotation), sqrt(dot_nearest(arm, arm)), REAL(cell_translation));
    const real best_reachable = clamp(REAL(target), at.distance - reach, at.distance + reach);
    bound = fma(weight, fitness_at(best_reachable, target, scale).value, bound);
    add_size_gradient(at, slope, count, sums + COLUMNS_OF_POSE);
  }
  sums[OBJECTIVE] = sum_of_lanes(objective);
  sums[BOUND] = sum_of_lanes(bound);
  sums[TRANSLATION] = sum_of_lanes(translation.x);
  sums[TRANSLATION + 1] = sum_of_lanes(translation.y);
  sums[TRANSLATION + 2] = sum_of_lanes(translation.z);
  sums[ROTATION] = sum_of_lanes(rotation.x);
  sums[ROTATION + 1] = sum_of_lanes(rotation.y);
  sums[ROTATION + 2] = sum_of_lanes(rotation.z);
  sums[SMALLEST_DISTANCE] = least_of_lanes(smallest_distance);
}

// A work-item sums one column of one candidate over a block of its slices, always in the same order: `sums` is laid out
// as `partials`, each block a slice, so that sums of sums follow until one is left.
kernel void sum_slices(uint candidates, uint slices, uint columns, uint block, global const double* partials,
                       global double* sums) {
  const ulong item = get_global_id(0);
  const uint blocks = (slices + block - 1) / block;
  if (item >= (ulong)candidates * blocks * columns) return;
  const ulong row = item / columns;
  const uint column = (uint)(item - row * columns);
  const ulong candidate = row / blocks;
  const uint first = (uint)(row - candidate * blocks) * block;
  global const double* own = partials + (candidate * slices + first) * columns + column;
  double sum = own[0];
  for (uint slice = 1; slice < block && slice < slices - first; ++slice) {
    const double next = own[(ulong)slice * columns];
    sum = column == SMALLEST_DISTANCE ? fmin(sum, next) : sum + next;
  }
  sums[item] = sum;
}

// Of every point for the first candidate: distance, normal, deciding primitive, size gradient, each in a column of
// `capacity` numbers.
kernel void pose_distance(uint groups, ulong capacity, global const double* xs, global const double* ys,
                          global const double* zs, MODEL_SPACE const scaled_superquadric* primitives, uint count,
                          global double* columns) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 c = {LOAD(group, xs), LOAD(group, ys), LOAD(group, zs)};
  const union_distance at = union_distance_at(c, primitives, count);
  STORE(at.distance, group, columns);
  STORE(at.normal.x, group, columns + capacity);
  STORE(at.normal.y, group, columns + 2 * capacity);
  STORE(at.normal.z, group, columns + 3 * capacity);
  STORE(TO_REAL(at.primitive), group, columns + 4 * capacity);
  STORE(at.size_gradient.x, group, columns + 5 * capacity);
  STORE(at.size_gradient.y, group, columns + 6 * capacity);
  STORE(at.size_gradient.z, group, columns + 7 * capacity);
}
