// This file implements one level of an interval octree: the colours of the eight children of many cubes, and the list
// of those that stay undecided (docs/mathematics.md §10, §11).
//
// A work-item takes one cube; its children are the lanes. What is decided about a primitive in the cube is therefore
// the same in all lanes, and decided primitives are passed over by scalar branches: Duff's simplification.

#define CHILDREN 8

// Bits of a position, three coordinates in one number.
#define POSITION_BITS 21
#define POSITION_MASK 0x1fffffUL

// Where the lanes of a pass lie from the middle of the parent: -1 or 1 along each axis; bits 0, 1, 2 of the child.
#if VECTOR_WIDTH == 8
#define SIDE_X(pass) ((double8)(-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0))
#define SIDE_Y(pass) ((double8)(-1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0))
#define SIDE_Z(pass) ((double8)(-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0))
#elif VECTOR_WIDTH == 4
#define SIDE_X(pass) ((double4)(-1.0, 1.0, -1.0, 1.0))
#define SIDE_Y(pass) ((double4)(-1.0, -1.0, 1.0, 1.0))
#define SIDE_Z(pass) REAL((pass) == 0 ? -1.0 : 1.0)
#else
#define SIDE_X(pass) (((pass) & 1) != 0 ? 1.0 : -1.0)
#define SIDE_Y(pass) (((pass) & 2) != 0 ? 1.0 : -1.0)
#define SIDE_Z(pass) (((pass) & 4) != 0 ? 1.0 : -1.0)
#endif

// The middle of a cube, and half the width of its children: all exact.
typedef struct {
  double x, y, z;
  double child_half_width;
} parent_cube;

ALWAYS_INLINE cube children_of(parent_cube parent, uint pass) {
  const real h = REAL(parent.child_half_width);
  cube c;
  c.centre.x = fma(SIDE_X(pass), h, REAL(parent.x));
  c.centre.y = fma(SIDE_Y(pass), h, REAL(parent.y));
  c.centre.z = fma(SIDE_Z(pass), h, REAL(parent.z));
  c.half_width = h;
  return c;
}

// Bit i of the result: lane i of a mask.
ALWAYS_INLINE uint bits_of(integer mask) {
#if VECTOR_WIDTH == 8
  const long8 bits = mask & (long8)(1, 2, 4, 8, 16, 32, 64, 128);
  const long4 four = bits.lo | bits.hi;
  const long2 two = four.lo | four.hi;
  return (uint)(two.x | two.y);
#elif VECTOR_WIDTH == 4
  const long4 bits = mask & (long4)(1, 2, 4, 8);
  const long2 two = bits.lo | bits.hi;
  return (uint)(two.x | two.y);
#else
  return (uint)(mask & 1);
#endif
}

#if VECTOR_WIDTH == 8
// Children of a cube whose faces are parallel to the primitive's own planes. Along each axis the nearest and farthest
// |coordinates| take two values each, so that the powers are computed for 12 numbers instead of 48. Each lane is
// rounded towards its own side: -1 down, for nearest corners; 1 up, for farthest ones.
ALWAYS_INLINE double8 step_towards(double8 side, double8 c) {
  return fma(side, fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA)), c);
}
ALWAYS_INLINE double8 mul_towards(double8 side, double8 a, double8 b) { return step_towards(side, a * b); }

// As log_down and log_up of x >= 0, exp_down and exp_up.
ALWAYS_INLINE double8 log_towards(double8 side, double8 x) {
  const double8 l = log_nearest(clamp(x, REAL(SMALLEST_NORMAL), REAL(DBL_MAX)));
  const double8 bound = fma(side * ELEMENTARY_WIDENING, fabs(l), l);
  const double8 low = select(bound, REAL(-INFINITY), (side < 0.0) & (x < SMALLEST_NORMAL));
  return select(low, REAL(INFINITY), (side > 0.0) & ~(x <= DBL_MAX));
}
ALWAYS_INLINE double8 exp_towards(double8 side, double8 y) {
  const double8 e = exp_nearest(clamp(y, REAL(EXP_LOWEST), REAL(EXP_HIGHEST)));
  const double8 bound = fma(e, side * ELEMENTARY_WIDENING, e);
  const double8 low = select(bound, REAL(0.0), (side < 0.0) & ~(y >= EXP_LOWEST));
  return select(low, REAL(INFINITY), (side > 0.0) & ~(y <= EXP_HIGHEST));
}

// The product of a logarithm and a positive factor of which two bounds are known.
ALWAYS_INLINE double8 scaled_towards(double8 side, double8 l, double down, double up) {
  return mul_towards(side, l, select(REAL(down), REAL(up), side * l >= 0.0));
}

// Bounds of |x - t| -+ h, at least 0, times a bound of 1/a: d is off by u |d|, the sum by u of its size, the step by
// as much again: less than 2^-51 (|d| + h).
ALWAYS_INLINE double8 relative_coordinates(double8 side, double8 x, double8 t, double8 h, double8 inverse_axis) {
  const double8 d = fabs(x - t);
  const double8 slack = fma(REAL(0x1p-51), d + h, REAL(2.0 * ROUNDING_ETA));
  return mul_towards(side, fmax(fma(side, slack, fma(side, h, d)), REAL(0.0)), inverse_axis);
}

// The powers of docs/mathematics.md §1, compared with 1: no last root.
ALWAYS_INLINE colour siblings_colour(parent_cube parent, MODEL_SPACE const box_primitive* p) {
  MODEL_SPACE const superquadric* s = &p->solid;
  const double h = parent.child_half_width;
  const double8 pairs = (double8)(-1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0);
  const double8 halves = (double8)(-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0);
  const double8 alternate = (double8)(-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0);

  // (x near, x far, y near, y far), each of the lower and the upper child
  const double8 middle_xy = (double8)((double4)(parent.x), (double4)(parent.y));
  const double8 centre_xy = (double8)((double4)(s->translation[0]), (double4)(s->translation[1]));
  const double8 inverse_xy = (double8)((double2)(p->inverse_axes_down[0]), (double2)(s->inverse_axes_up[0]),
                                       (double2)(p->inverse_axes_down[1]), (double2)(s->inverse_axes_up[1]));
  const double8 xy = relative_coordinates(pairs, fma(alternate, REAL(h), middle_xy), centre_xy, REAL(h), inverse_xy);
  const double8 powers_xy =
      exp_towards(pairs, scaled_towards(pairs, log_towards(pairs, xy), s->p_down[1], p->p_up[1]));

  // Near and far in the x-y section, each for four children.
  const double8 section = step_towards(halves, powers_xy.s01012323 + powers_xy.s44556677);
  const double8 log_r =
      scaled_towards(halves, log_towards(halves, section), p->inverse_p_down[1], s->inverse_p_up[1]);
  const double8 r = exp_towards(halves, scaled_towards(halves, log_r, s->p_down[0], p->p_up[0]));

  const double8 inverse_z = (double8)((double2)(p->inverse_axes_down[2]), (double2)(s->inverse_axes_up[2]),
                                      (double2)(p->inverse_axes_down[2]), (double2)(s->inverse_axes_up[2]));
  const double8 z = relative_coordinates(pairs, fma(alternate, REAL(h), REAL(parent.z)), REAL(s->translation[2]),
                                         REAL(h), inverse_z);
  const double8 power_z = exp_towards(pairs, scaled_towards(pairs, log_towards(pairs, z), s->p_down[0], p->p_up[0]));

  colour c;
  c.white = step_down(r.s01230123 + power_z.s00001111) > 1.0;
  c.black = step_up(r.s45674567 + power_z.s22223333) < 1.0;
  return c;
}

#endif

#if VECTOR_WIDTH == 1
// The same, number by number, for work-items that take the children one after the other: the colours of all of them, a
// bit each. `far` are bounds of farthest corners from above, the others of nearest corners from below.
typedef struct {
  bool shared; // the primitive's planes are parallel to the cube's
  uint black, white;
} siblings;

ALWAYS_INLINE double step_towards(bool far, double c) { return far ? step_up(c) : step_down(c); }

// A positive power of x, by bounds of the exponent.
ALWAYS_INLINE double power_towards(bool far, double x, double down, double up) {
  const double l = far ? log_up(x) : log_down(x);
  const double y = step_towards(far, l * ((far ? l : -l) >= 0.0 ? up : down));
  return far ? exp_up(y) : exp_down(y);
}

// Of a coordinate's bound, for the lower or the upper child.
ALWAYS_INLINE double coordinate_power(bool far, double x, double t, double h, double inverse_axis, double down,
                                      double up) {
  const double d = fabs(x - t);
  const double slack = fma(0x1p-51, d + h, 2.0 * ROUNDING_ETA);
  const double reached = far ? (d + h) + slack : (d - h) - slack;
  return power_towards(far, step_towards(far, fmax(reached, 0.0) * inverse_axis), down, up);
}

ALWAYS_INLINE siblings siblings_of(parent_cube parent, MODEL_SPACE const box_primitive* p) {
  MODEL_SPACE const superquadric* s = &p->solid;
  MODEL_SPACE const double* t = s->translation;
  const double h = parent.child_half_width;
  siblings found = {true, 0, 0};
#pragma nounroll
  for (int side = 0; side < 2; ++side) {
    const bool far = side == 1;
    MODEL_SPACE const double* inverse = far ? s->inverse_axes_up : p->inverse_axes_down;
    double x[2], y[2], z[2];
    for (int child = 0; child < 2; ++child) {
      const double towards = child == 0 ? -h : h;
      x[child] = coordinate_power(far, parent.x + towards, t[0], h, inverse[0], s->p_down[1], p->p_up[1]);
      y[child] = coordinate_power(far, parent.y + towards, t[1], h, inverse[1], s->p_down[1], p->p_up[1]);
      z[child] = coordinate_power(far, parent.z + towards, t[2], h, inverse[2], s->p_down[0], p->p_up[0]);
    }
    for (int pair = 0; pair < 4; ++pair) {
      const double section = step_towards(far, x[pair & 1] + y[pair >> 1]);
      const double l = far ? log_up(section) : log_down(section);
      const double log_r =
          step_towards(far, l * ((far ? l : -l) >= 0.0 ? s->inverse_p_up[1] : p->inverse_p_down[1]));
      const double log_power =
          step_towards(far, log_r * ((far ? log_r : -log_r) >= 0.0 ? p->p_up[0] : s->p_down[0]));
      const double r = far ? exp_up(log_power) : exp_down(log_power);
      for (int child = 0; child < 2; ++child) {
        const double sum = step_towards(far, r + z[child]);
        const uint bit = 1U << (pair + 4 * child);
        if (far && sum < 1.0) found.black |= bit;
        if (!far && sum > 1.0) found.white |= bit;
      }
    }
  }
  return found;
}
#else
typedef struct {
  bool shared;
} siblings;
#endif

// With the gauge of untapered solids, too.
ALWAYS_INLINE bool is_axis_parallel(MODEL_SPACE const box_primitive* p) {
  MODEL_SPACE const double* r = p->solid.rotation;
  return p->curvature == 0.0 && p->solid.taper == 0.0 &&
         fabs(r[1]) + fabs(r[2]) + fabs(r[3]) + fabs(r[5]) + fabs(r[6]) + fabs(r[7]) == 0.0;
}

// What is found out once for all passes.
ALWAYS_INLINE siblings known_siblings(parent_cube parent, MODEL_SPACE const box_primitive* p) {
#if VECTOR_WIDTH == 1 && !defined(NO_SIBLINGS)
  if (is_axis_parallel(p)) return siblings_of(parent, p);
#endif
  siblings none;
  none.shared = false;
  return none;
}

ALWAYS_INLINE colour children_colour(parent_cube parent, uint pass, siblings all,
                                     MODEL_SPACE const box_primitive* p) {
#if VECTOR_WIDTH == 8 && !defined(NO_SIBLINGS)
  if (is_axis_parallel(p)) return siblings_colour(parent, p);
#elif VECTOR_WIDTH == 1
  const colour own = {MASK(all.black >> pass & 1U), MASK(all.white >> pass & 1U)};
  if (all.shared) return own;
#endif
  return primitive_colour(children_of(parent, pass), p);
}

// Colours of the children of one pass, and what is decided in each of them about the primitives.
ALWAYS_INLINE colour pass_colour(parent_cube parent, uint pass, const siblings* all,
                                 MODEL_SPACE const box_primitive* primitives, decided known, decided_lanes* found) {
  colour c[PRIMITIVES];
  integer matters[PRIMITIVES];
  for (uint i = 0; i < PRIMITIVES; ++i)
    c[i] = is_known(known, i) ? known_colour(known, i) : children_colour(parent, pass, all[i], primitives + i);
  none_matter(matters);
  const colour solid = solid_colour(c, matters);
#ifndef NO_SIMPLIFICATION
  *found = simplified(c, matters);
#endif
  return solid;
}

// Exclusive prefix sum over the work-group; `total` is the sum. All work-items must call it.
uint prefix_sum(uint value, local uint* sums, uint* total) {
  const uint self = get_local_id(0);
  const uint size = get_local_size(0);
  sums[self] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint step = 1; step < size; step *= 2) {
    const uint before = self >= step ? sums[self - step] : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    sums[self] += before;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  *total = sums[size - 1];
  return sums[self] - value;
}

// Splits `count` cubes of one level. `counts` receives the numbers of gray, black and white children; the gray ones go
// to `next_*` from `next_begin` on, in any order. `colours` receives the children of each cube, a bit each: x where
// black, y where white. Local memory: a number for each work-item, and one. Work-groups of at most 64.
kernel void split_cubes(uint count, ulong begin, double corner_x, double corner_y, double corner_z,
                        double child_half_width, global const ulong* positions, global const decided* decisions,
                        MODEL_SPACE const box_primitive* primitives, ulong next_begin, global ulong* next_positions,
                        global decided* next_decisions, global uint* counts, global uchar2* colours, local uint* sums) {
  const uint item = get_global_id(0);
  const bool active = item < count;
  const ulong position = active ? positions[begin + item] : 0;
  const ulong x = position & POSITION_MASK;
  const ulong y = (position >> POSITION_BITS) & POSITION_MASK;
  const ulong z = position >> (2 * POSITION_BITS);
  decided decided_children[CHILDREN];
  uint black = 0;
  uint white = 0;
  if (active) {
    const parent_cube parent = {fma((double)(4 * x + 2), child_half_width, corner_x),
                                fma((double)(4 * y + 2), child_half_width, corner_y),
                                fma((double)(4 * z + 2), child_half_width, corner_z), child_half_width};
#ifdef NO_SIMPLIFICATION
    const decided known = {0, 0};
#else
    const decided known = decisions[begin + item];
#endif
    siblings all[PRIMITIVES];
    for (uint i = 0; i < PRIMITIVES; ++i)
      if (!is_known(known, i)) all[i] = known_siblings(parent, primitives + i);
    for (uint pass = 0; pass < CHILDREN / VECTOR_WIDTH; ++pass) {
      decided_lanes found;
      const colour c = pass_colour(parent, pass, all, primitives, known, &found);
      black |= bits_of(c.black) << (pass * VECTOR_WIDTH);
      white |= bits_of(c.white) << (pass * VECTOR_WIDTH);
#ifndef NO_SIMPLIFICATION
      long lanes_black[VECTOR_WIDTH], lanes_white[VECTOR_WIDTH];
      STORE(found.black, 0, lanes_black);
      STORE(found.white, 0, lanes_white);
      for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) {
        const decided child = {(uint)lanes_black[lane], (uint)lanes_white[lane]};
        decided_children[pass * VECTOR_WIDTH + lane] = child;
      }
#endif
    }
    colours[item] = (uchar2)((uchar)black, (uchar)white);
  }
  const uint gray = active ? 0xffU & ~(black | white) : 0;

  // Three sums of at most 8 * 64 at a time, ten bits each.
  uint totals;
  const uint own = popcount(gray) | popcount(black) << 10 | popcount(white) << 20;
  const uint before = prefix_sum(own, sums, &totals) & 0x3ffU;
  local uint* const group_begin = sums + get_local_size(0);
  if (get_local_id(0) == 0) {
    *group_begin = atomic_add(counts, totals & 0x3ffU);
    atomic_add(counts + 1, (totals >> 10) & 0x3ffU);
    atomic_add(counts + 2, totals >> 20);
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  ulong next = next_begin + *group_begin + before;
  for (uint child = 0; child < CHILDREN; ++child) {
    if ((gray >> child & 1U) == 0) continue;
    next_positions[next] = (2 * x + (child & 1U)) | (2 * y + (child >> 1 & 1U)) << POSITION_BITS |
                           (2 * z + (child >> 2)) << (2 * POSITION_BITS);
#ifndef NO_SIMPLIFICATION
    next_decisions[next] = decided_children[child];
#endif
    ++next;
  }
}
