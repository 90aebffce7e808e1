// This file implements the enclosure of the signed distance of points inside one superquadric, by branch and bound.
//
// The depth of q is at least t when the ball B(q, t) lies in the solid K. A cell of directions with corners w_i and a
// vector c, |c| <= 1, is proven when q + s_i w_i lies in K for s_i = t / (c.w_i): a point v of the ball in the cell's
// cone is v = sum l_i s_i w_i with l_i >= 0, and t sum l_i = c.v <= |v| <= t gives sum l_i <= 1, so q + v lies in the
// hull of q and the corners, hence in K. Directions of the octant suffice: the gauge is monotone in each |coordinate|
// and |q + v| <= q + |v|. The gap of a cell of radius r is about t r^2 / 2, whatever the curvature of K: about the
// nearest tangent plane's normal, where there is little room, a cap of directions is proven otherwise
// (interior.clh), and cells in it are passed over.
//
// Upper bounds of the depth: the tangent plane at any boundary point. Cells proven for some t stay proven when a nearer
// plane lowers t. A work-item owns a block of points; each of its lanes takes the block's next open point when it has
// finished one, so that lanes stay busy.

#define DESCENT_LIMIT 10
#define DESCENT_REMAINDER 0.3 // of the allowance: what another step would gain is about half the residual
#define SPLIT_LIMIT 4096
#define STACK_SIZE (3 * DEEPEST_LEVEL + 4)

// a + by (b - a), folded, of length 1.
ALWAYS_INLINE vector3 unit_between(vector3 a, vector3 b, real by) {
  const vector3 v = {fmax(fma(by, b.x - a.x, a.x), REAL(0.0)), fmax(fma(by, b.y - a.y, a.y), REAL(0.0)),
                     folded(fma(by, b.z - a.z, a.z))};
  const real inverse_length = 1.0 / sqrt(dot_nearest(v, v));
  const vector3 unit = {v.x * inverse_length, v.y * inverse_length, v.z * inverse_length};
  return unit;
}

// A few steps direction -> normal at the foot on the nearest plane, each extrapolated by the secant through the last
// two (Anderson acceleration of depth 1); the nearest plane met.
CALLED_ON_PROCESSORS tangent_plane descend(vector3 q, gauge_terms g, integer wanted, double allowance,
                                           MODEL_SPACE const superquadric* s) {
  tangent_plane nearest = first_plane(q, g, s);
  vector3 way = nearest.unit_normal;
  vector3 earlier = way;
  vector3 earlier_turn = {REAL(0.0), REAL(0.0), REAL(0.0)};
#pragma nounroll
  for (int step = 0; step < DESCENT_LIMIT; ++step) {
    const vector3 foot = {fma(nearest.distance, way.x, q.x), fma(nearest.distance, way.y, q.y),
                          fma(nearest.distance, way.z, q.z)};
    const tangent_plane plane = tangent_at(q, foot, interior_terms_up(foot, s), s);
    nearest = nearer_plane(nearest, plane);
    const vector3 turn = {plane.unit_normal.x - way.x, plane.unit_normal.y - way.y, plane.unit_normal.z - way.z};
    const real residual = nearest.distance * dot_nearest(turn, turn);
    if (!any(wanted & MASK(residual > DESCENT_REMAINDER * allowance))) break;
    const vector3 change = {turn.x - earlier_turn.x, turn.y - earlier_turn.y, turn.z - earlier_turn.z};
    const real secant = dot_nearest(turn, change) / fmax(dot_nearest(change, change), REAL(1e-30));
    way = unit_between(plane.unit_normal, earlier, step == 0 ? REAL(0.0) : clamp(secant, REAL(-1.0), REAL(0.5)));
    earlier = plane.unit_normal;
    earlier_turn = turn;
  }
  return nearest;
}

// The test of the four quarters of a cell, for the ball of radius t about q.
typedef struct {
  integer open;         // bit i set: quarter i (numbered as in split_cell) is not proven
  real worst;           // log-gauge of the farthest of the six points
  tangent_plane plane;  // at the worst point
} quarters_test;

// Components of c, |c| <= 1: those of centre / |centre|, >= 0, are rounded down.
ALWAYS_INLINE vector3 direction_down(vector3 centre) {
  const real inverse_length = div_down(REAL(1.0), length_up(centre));
  const vector3 c = {mul_down(centre.x, inverse_length), mul_down(centre.y, inverse_length),
                     mul_down(centre.z, inverse_length)};
  return c;
}

ALWAYS_INLINE vector3 add3(vector3 a, vector3 b) {
  const vector3 sum = {a.x + b.x, a.y + b.y, a.z + b.z};
  return sum;
}

// One of the six points that the quarters share, pushed out along its direction w as far as the most demanding of its
// quarters needs: along <= c.w for each of their c.
typedef struct {
  integer outside;      // not proven to lie in the solid
  gauge_terms gauge;
  vector3 position;
} tested_point;

ALWAYS_INLINE tested_point test_point(vector3 q, real t, vector3 w, real along, MODEL_SPACE const superquadric* s) {
  const real reach = div_up(t, along); // rounded up: c.(reach w) >= t
  tested_point p;
  p.position = moved_out(q, reach, w);
  p.gauge = interior_terms_up(p.position, s);
  p.outside = ~MASK(p.gauge.power <= 1.0);
  return p;
}

ALWAYS_INLINE tested_point farther_out(tested_point a, tested_point b) {
  const integer b_farther = MASK(b.gauge.power > a.gauge.power);
  a.gauge.log_x = select(a.gauge.log_x, b.gauge.log_x, b_farther);
  a.gauge.log_y = select(a.gauge.log_y, b.gauge.log_y, b_farther);
  a.gauge.log_z = select(a.gauge.log_z, b.gauge.log_z, b_farther);
  a.gauge.log_r = select(a.gauge.log_r, b.gauge.log_r, b_farther);
  a.gauge.power = select(a.gauge.power, b.gauge.power, b_farther);
  a.position.x = select(a.position.x, b.position.x, b_farther);
  a.position.y = select(a.position.y, b.position.y, b_farther);
  a.position.z = select(a.position.z, b.position.z, b_farther);
  return a;
}

// The directions w >= 0 with w.axis >= cosine |w|, for axis >= 0: those of a proven cap. A quarter whose three corners
// are among them lies in the cap, for a cone of less than a right angle is convex.
typedef struct {
  vector3 axis;
  real cosine;
} cone;

ALWAYS_INLINE integer in_cone(vector3 w, cone c) {
  return MASK(dot_down(w, c.axis) >= mul_up(c.cosine, length_up(w)));
}

// Corners 1, 2, 3 of the cell and the midpoints a, b, c of the sides opposite to them, all times two: exact integers.
CALLED_ON_PROCESSORS quarters_test test_quarters(vector3 q, real t, vector3 base, real inverted, real side, cone cap,
                                                 MODEL_SPACE const superquadric* s) {
  const vector3 on = {base.x + 1.0 - inverted, base.y + 1.0 - inverted, base.z + 1.0 - inverted};
  const vector3 off = {base.x + inverted, base.y + inverted, base.z + inverted};
  const vector3 corner_1 = {2.0 * on.x, 2.0 * off.y, 2.0 * off.z};
  const vector3 corner_2 = {2.0 * off.x, 2.0 * on.y, 2.0 * off.z};
  const vector3 corner_3 = {2.0 * off.x, 2.0 * off.y, 2.0 * on.z};
  const vector3 midpoint_a = {2.0 * off.x, on.y + off.y, on.z + off.z};
  const vector3 midpoint_b = {on.x + off.x, 2.0 * off.y, on.z + off.z};
  const vector3 midpoint_c = {on.x + off.x, on.y + off.y, 2.0 * off.z};

  const vector3 c_1 = direction_down(add3(corner_1, add3(midpoint_b, midpoint_c)));
  const vector3 c_2 = direction_down(add3(corner_2, add3(midpoint_c, midpoint_a)));
  const vector3 c_3 = direction_down(add3(corner_3, add3(midpoint_a, midpoint_b)));
  const vector3 c_4 = direction_down(add3(midpoint_a, add3(midpoint_b, midpoint_c)));
  // Of each of the six points: its direction, what the quarters that it belongs to demand of it, and these as bits.
  const vector3 directions[6] = {corner_1, corner_2, corner_3, midpoint_a, midpoint_b, midpoint_c};
  const real alongs[6] = {
      dot_down(c_1, corner_1),
      dot_down(c_2, corner_2),
      dot_down(c_3, corner_3),
      fmin(dot_down(c_4, midpoint_a), fmin(dot_down(c_2, midpoint_a), dot_down(c_3, midpoint_a))),
      fmin(dot_down(c_4, midpoint_b), fmin(dot_down(c_3, midpoint_b), dot_down(c_1, midpoint_b))),
      fmin(dot_down(c_4, midpoint_c), fmin(dot_down(c_1, midpoint_c), dot_down(c_2, midpoint_c)))};
  const long quarters[6] = {1, 2, 4, 2 | 4 | 8, 1 | 4 | 8, 1 | 2 | 8};

  quarters_test test;
  const vector3 first = on_side(directions[0], side);
  tested_point worst = test_point(q, t, first, alongs[0], s);
  test.open = worst.outside & quarters[0];
  integer not_in_cap = ~in_cone(first, cap) & quarters[0];
#pragma nounroll // six copies spill registers: a third slower to run, and to compile
  for (int i = 1; i < 6; ++i) {
    const vector3 w = on_side(directions[i], side);
    const tested_point p = test_point(q, t, w, alongs[i], s);
    test.open |= p.outside & quarters[i];
    not_in_cap |= ~in_cone(w, cap) & quarters[i];
    worst = farther_out(worst, p);
  }
  test.open &= not_in_cap;
  test.worst = log_interior_gauge(worst.position, worst.gauge, s);
  test.plane = tangent_at(q, worst.position, worst.gauge, s);
  return test;
}

// `scratch` holds twelve numbers for each open point of a block, one after the other from the block's start: which one
// of all it is, its local coordinates, the unit normal of the nearest tangent plane, the gauge (afterwards the proven
// radius), the distance of that plane, or one of two marks, the radius to prove, the cosine of the cap about that normal
// which is proven for it, and the level of the nearest plane.
#define SCRATCH_SIZE 12
#define INDEX 0
#define COORDINATES 1
#define NORMAL 4
#define GAUGE 7
#define RADIUS 7
#define DISTANCE 8
#define TARGET 9
#define CAP_COSINE 10
#define LEVEL 11
#define NOT_OPEN -1.0
#define SEARCHED -2.0

// Lists the points from group `first` to before `last` that may lie inside and whose enclosure is wider than the
// tolerance; returns how many.
ALWAYS_INLINE uint list_open_points(ulong first, ulong last, global const double* los, global const double* his,
                                    double tolerance, global double* block) {
  uint count = 0;
  for (ulong group = first; group < last; ++group) {
    const real lo = LOAD(group, los);
    const real hi = LOAD(group, his);
    const integer open = MASK(lo < 0.0) & MASK(!(hi - lo <= tolerance));
    if (!any(open)) continue;
    long is_open[VECTOR_WIDTH];
    STORE(open, 0, is_open);
    for (uint lane = 0; lane < VECTOR_WIDTH; ++lane)
      if (is_open[lane] != 0) block[count++ * SCRATCH_SIZE + INDEX] = (double)(group * VECTOR_WIDTH + lane);
  }
  return count;
}

// Of the listed points from `start` on; lanes beyond the last repeat it.
ALWAYS_INLINE void take_listed(uint start, uint count, global const double* block, lane_indices* indices) {
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane)
    indices->of_lane[lane] = (ulong)block[min(start + lane, count - 1) * SCRATCH_SIZE + INDEX];
}

// Which of a vector of listed points are proven inside; a first tangent plane for each, and a cap.
CALLED_ON_PROCESSORS void prepare_points(uint start, uint count, vector3 q, double allowance,
                                         MODEL_SPACE const superquadric* s, global double* block) {
  const gauge_terms g = interior_terms_up(q, s);
  const integer inside = MASK(g.power <= 1.0) & MASK(q.x + q.y + fabs(q.z) < INFINITY);
  const tangent_plane plane = descend(q, g, inside, allowance, s);
  const real depth = fmax(plane.distance, REAL(0.0));
  const real target = fmax(depth - allowance, REAL(0.0));
  lanes3 coordinates, normals;
  double gauges[VECTOR_WIDTH], distances[VECTOR_WIDTH], targets[VECTOR_WIDTH], cosines[VECTOR_WIDTH],
      levels[VECTOR_WIDTH];
  store3(q, &coordinates);
  store3(plane.unit_normal, &normals);
  STORE(interior_gauge_up(q, s), 0, gauges);
  STORE(select(REAL(NOT_OPEN), depth, inside), 0, distances);
  STORE(target, 0, targets);
  STORE(cap_cosine(q, target, plane.unit_normal, inside, s), 0, cosines);
  STORE(plane.level, 0, levels);
  for (uint lane = 0; lane < min(count - start, (uint)VECTOR_WIDTH); ++lane) {
    global double* state = block + (start + lane) * SCRATCH_SIZE;
    state[COORDINATES] = coordinates.x[lane];
    state[COORDINATES + 1] = coordinates.y[lane];
    state[COORDINATES + 2] = coordinates.z[lane];
    state[NORMAL] = normals.x[lane];
    state[NORMAL + 1] = normals.y[lane];
    state[NORMAL + 2] = normals.z[lane];
    state[GAUGE] = gauges[lane];
    state[DISTANCE] = distances[lane];
    state[TARGET] = targets[lane];
    state[CAP_COSINE] = cosines[lane];
    state[LEVEL] = levels[lane];
  }
}

// One point in the hands of a lane.
typedef struct {
  uint point;           // its place in the block's list; NO_POINT when idle
  double depth;         // distance of the nearest tangent plane known: at least the depth, up to rounding
  double target;        // the radius to prove
  double gauge;         // of the point, for the lowering of the target
  double axis[3];       // of the cap that is proven, also when a nearer plane is found
  double cosine;
  uint splits;          // so far
  uint stacked;
  double side;          // of the section z = 0: 1, then -1 where both are searched
  ulong cell;           // whose quarters are under test
  ulong stack[STACK_SIZE];
} search;

#define NO_POINT (~0U)

ALWAYS_INLINE double target_of(double depth, double allowance) { return fmax(depth - allowance, 0.0); }

ALWAYS_INLINE void finish(search* own, double radius, global double* block) {
  global double* state = block + own->point * SCRATCH_SIZE;
  state[RADIUS] = radius;
  state[DISTANCE] = SEARCHED;
  own->point = NO_POINT;
}

// Gives an idle lane the next open point from `next` on; returns where to go on.
ALWAYS_INLINE uint take_point(search* own, uint next, uint count, MODEL_SPACE const superquadric* s,
                              global double* block) {
  for (; own->point == NO_POINT && next < count; ++next) {
    global const double* state = block + next * SCRATCH_SIZE;
    if (!(state[DISTANCE] >= 0.0)) continue;
    own->point = next;
    own->depth = state[DISTANCE];
    own->target = state[TARGET];
    own->gauge = state[GAUGE];
    for (uint i = 0; i < 3; ++i) own->axis[i] = state[NORMAL + i];
    own->cosine = state[CAP_COSINE];
    own->splits = 0;
    own->stacked = 0;
    own->side = 1.0;
    own->cell = WHOLE_OCTANT;
    // A ball about the origin lies in K, so the one of radius (1 - g) times that about q does; five roundings.
    const double known = fmax((1.0 - own->gauge) * inner_radius(s) * (1.0 - 0x1p-50), 0.0);
    if (known >= own->target) finish(own, known, block);
    else if (own->cosine < 0.0) finish(own, own->target, block); // the cap is all of the ball
  }
  return next;
}

// Puts the quarters that are not proven on the stack.
ALWAYS_INLINE void split(search* own, long open, double worst) {
  const spherical_cell cell = unpack_cell(own->cell);
  if (++own->splits < SPLIT_LIMIT && cell.level + 1 < DEEPEST_LEVEL) {
    ulong quarters[4];
    split_cell(cell, quarters);
    for (uint i = 0; i < 4; ++i)
      if (open & (1L << i)) own->stack[own->stacked++] = quarters[i];
    own->cell = own->stack[--own->stacked];
    return;
  }
  // No more splitting: the gauge is convex along the way from q to a point outside, so it crosses 1 no sooner than the
  // chord does; the next test proves this cell or lowers the target again.
  const double fraction = (1.0 - own->gauge) / (exp(worst) - own->gauge);
  own->target *= fmin(fraction, 1.0) * (1.0 - 0x1p-30);
  if (!(own->target > 0x1p-100)) own->target = 0.0;
}

// After the last cell of a side.
ALWAYS_INLINE void leave_side(search* own, global double* block) {
  if (SIDES == 1 || own->side < 0.0) {
    finish(own, own->target, block);
  } else {
    own->side = -1.0;
    own->cell = WHOLE_OCTANT;
  }
}

// Branch and bound over the listed points of a block, a point a lane.
ALWAYS_INLINE void search_block(uint count, double allowance, MODEL_SPACE const superquadric* s,
                                global double* block) {
  search searches[VECTOR_WIDTH];
  uint next = 0;
  lanes3 q, base, normal, axis;
  double target[VECTOR_WIDTH], inverted[VECTOR_WIDTH], side[VECTOR_WIDTH], worst[VECTOR_WIDTH], distance[VECTOR_WIDTH],
      level[VECTOR_WIDTH], cosine[VECTOR_WIDTH];
  long open[VECTOR_WIDTH];
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) {
    searches[lane].point = NO_POINT;
    q.x[lane] = q.y[lane] = q.z[lane] = base.x[lane] = base.y[lane] = base.z[lane] = 0.0;
    axis.x[lane] = axis.y[lane] = axis.z[lane] = target[lane] = inverted[lane] = side[lane] = cosine[lane] = 0.0;
  }
  for (;;) {
    bool busy = false;
    for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) {
      search* own = &searches[lane];
      next = take_point(own, next, count, s, block);
      if (own->point == NO_POINT) continue;
      busy = true;
      global const double* state = block + own->point * SCRATCH_SIZE;
      const spherical_cell cell = unpack_cell(own->cell);
      q.x[lane] = state[COORDINATES];
      q.y[lane] = state[COORDINATES + 1];
      q.z[lane] = state[COORDINATES + 2];
      base.x[lane] = (double)cell.a;
      base.y[lane] = (double)cell.b;
      base.z[lane] = (double)cell.c;
      inverted[lane] = (double)cell.inverted;
      side[lane] = own->side;
      target[lane] = own->target;
      axis.x[lane] = own->axis[0];
      axis.y[lane] = own->axis[1];
      axis.z[lane] = own->axis[2];
      cosine[lane] = own->cosine;
    }
    if (!busy) return;

    const cone cap = {load3(&axis), LOAD(0, cosine)};
    const quarters_test test =
        test_quarters(load3(&q), LOAD(0, target), load3(&base), LOAD(0, inverted), LOAD(0, side), cap, s);
    STORE(test.open, 0, open);
    STORE(test.worst, 0, worst);
    STORE(test.plane.distance, 0, distance);
    STORE(test.plane.level, 0, level);
    store3(test.plane.unit_normal, &normal);

    for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) {
      search* own = &searches[lane];
      if (own->point == NO_POINT) continue;
      if (open[lane] != 0 && distance[lane] < own->depth) {
        global double* state = block + own->point * SCRATCH_SIZE;
        own->depth = fmax(distance[lane], 0.0);
        own->target = fmin(own->target, target_of(own->depth, allowance));
        state[NORMAL] = normal.x[lane];
        state[NORMAL + 1] = normal.y[lane];
        state[NORMAL + 2] = normal.z[lane];
        state[LEVEL] = level[lane];
      }
      if (open[lane] != 0) split(own, open[lane], worst[lane]);
      else if (own->stacked > 0) own->cell = own->stack[--own->stacked];
      else leave_side(own, block);
      // With target 0 nothing is left to prove but that q lies in K, which it does.
      if (own->point != NO_POINT && own->target == 0.0) finish(own, 0.0, block);
    }
  }
}

// Writes what was found of a vector of listed points, where it is better than what was known.
CALLED_ON_PROCESSORS void deliver_points(uint start, uint count, const lane_indices* indices, local_point q,
                                         MODEL_SPACE const superquadric* s, global const double* block,
                                         global double* los, global double* his, global double* normal_xs,
                                         global double* normal_ys, global double* normal_zs) {
  lanes3 normals;
  double radii[VECTOR_WIDTH], marks[VECTOR_WIDTH], levels[VECTOR_WIDTH];
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) {
    global const double* state = block + min(start + lane, count - 1) * SCRATCH_SIZE;
    normals.x[lane] = state[NORMAL];
    normals.y[lane] = state[NORMAL + 1];
    normals.z[lane] = state[NORMAL + 2];
    radii[lane] = state[RADIUS];
    marks[lane] = state[DISTANCE];
    levels[lane] = state[LEVEL];
  }
  const integer searched = MASK(LOAD(0, marks) == SEARCHED);
  const proven_distance by_plane = distance_by_plane(q.point, load3(&normals), LOAD(0, levels), s);
  const real lo = sub_down(by_plane.lo, q.error);
  const real hi = add_up(-LOAD(0, radii), q.error);
  const real known_lo = gathered(los, indices);
  const real known_hi = gathered(his, indices);
  const integer better = searched & MASK(lo > known_lo);
  const uint size = min(count - start, (uint)VECTOR_WIDTH);
  scatter(select(known_lo, lo, better), size, indices, los);
  scatter(select(known_hi, fmin(known_hi, hi), searched), size, indices, his);
  const vector3 normal = out_of_octant(by_plane.normal, q.sign);
  scatter(select(gathered(normal_xs, indices), normal.x, better), size, indices, normal_xs);
  scatter(select(gathered(normal_ys, indices), normal.y, better), size, indices, normal_ys);
  scatter(select(gathered(normal_zs, indices), normal.z, better), size, indices, normal_zs);
}

kernel void interior_depth(ulong groups, uint groups_per_block, global const double* xs, global const double* ys,
                           global const double* zs, MODEL_SPACE const superquadric* primitives, uint index,
                           double tolerance, global double* scratch, global double* los, global double* his,
                           global double* normal_xs, global double* normal_ys, global double* normal_zs) {
  MODEL_SPACE const superquadric* s = primitives + index;
  const ulong first = get_global_id(0) * groups_per_block;
  const ulong last = min(first + groups_per_block, groups);
  global double* block = scratch + first * VECTOR_WIDTH * SCRATCH_SIZE;
  const uint count = list_open_points(first, last, los, his, tolerance, block);
  if (count == 0) return;

  const double allowance = 0.95 * tolerance; // leaves room for rounding
  for (uint start = 0; start < count; start += VECTOR_WIDTH) {
    lane_indices indices;
    take_listed(start, count, block, &indices);
    const local_point q = interior_point(to_local(gathered_point(&indices, xs, ys, zs), s), s);
    prepare_points(start, count, q.point, allowance, s, block);
  }
  search_block(count, allowance, s, block);

  for (uint start = 0; start < count; start += VECTOR_WIDTH) {
    lane_indices indices;
    take_listed(start, count, block, &indices);
    const local_point q = interior_point(to_local(gathered_point(&indices, xs, ys, zs), s), s);
    deliver_points(start, count, &indices, q, s, block, los, his, normal_xs, normal_ys, normal_zs);
  }
}
