// This file implements the signed distance of points to any model by branch and bound over cubes
// (docs/mathematics.md §10 and §11).
//
// The solid S lies in the root cube, and so does the point of the closure of its complement that is nearest to any
// point of S. A work-item owns a query and keeps the cubes that may hold the nearest point of its target (S, or that
// closure) on a stack, nearest first; the lanes of a vector are the eight children of one cube. A cube is given up
// when its proven lower bound is not below the upper bound, less the tolerance, and the least of those bounds is
// remembered: nothing is ever dropped without it. The upper bound is the distance of a point that is proven to lie
// strictly in the target.
//
// The functions of the model's own tree (host/device/solid_model) come after this file.

#define CHILDREN 8
#define CHILD_BITS 3
#define DEEPEST_CUBE 40
#define CUBE_STACK (7 * DEEPEST_CUBE + 8)

// A cube of the octree by its integer coordinates at its level, and what is known of it.
typedef struct {
  ulong x, y, z;
  uint level;
  decided known;
  double lower;
} octree_cube;

// Bits of `decided` as they wait on the stack: no more than there are primitives.
#if PRIMITIVES <= 8
typedef uchar remembered_bits;
#elif PRIMITIVES <= 16
typedef ushort remembered_bits;
#else
typedef uint remembered_bits;
#endif

// Cubes that wait, the last to be searched first. Each is a child of the cube that was taken last, or of one that
// contains it: which child, and at which level, says where it lies. Small, because a graphics processor keeps as much
// memory as this takes for every work-item that it could run.
typedef struct {
  double lower[CUBE_STACK];
  ushort place[CUBE_STACK]; // level, then CHILD_BITS
  remembered_bits black[CUBE_STACK], white[CUBE_STACK];
} cube_stack;

typedef struct {
  double x, y, z;
} point;

// The state of one search.
typedef struct {
  point query;
  bool outside;                        // the target is the closure of the complement of S
  double least_inside[PRIMITIVES];     // proven distance to each primitive
  double least_outside[PRIMITIVES];    // and to the closure of its complement
  double upper;                        // proven distance of a point of the target
  double given_up;                     // least lower bound of the cubes that were given up
  double allowance;                    // how far above a lower bound the upper may stay
  uint stacked;
  cube_stack stack;
} search;

ALWAYS_INLINE vector3 broadcast(point p) {
  const vector3 v = {REAL(p.x), REAL(p.y), REAL(p.z)};
  return v;
}

// Margins by which proposals try to lie inside the target, a lane each, in units of the size of the numbers.
constant double margins[CHILDREN] = {0x1p-50, 0x1p-47, 0x1p-44, 0x1p-41, 0x1p-37, 0x1p-33, 0x1p-29, 0x1p-24};

// Of the whole solid.
NEVER_INLINE colour colour_at(vector3 x, decided known, MODEL_SPACE const box_primitive* primitives) {
  const cube here = {x, REAL(0.0)};
  colour c[PRIMITIVES];
  integer matters[PRIMITIVES];
  for (uint i = 0; i < PRIMITIVES; ++i)
    c[i] = is_known(known, i) ? known_colour(known, i) : primitive_colour(here, primitives + i);
  none_matter(matters);
  return solid_colour(c, matters);
}

ALWAYS_INLINE void forget_colours(colour* c) {
  const colour gray = {INTEGER(0), INTEGER(0)};
  for (uint i = 0; i < PRIMITIVES; ++i) c[i] = gray;
}

// Projects a proposal onto the boundaries that are open near it, a little beyond them, and keeps what proves a lower
// upper bound. `known` holds near the proposal; the landing may be anywhere.
NEVER_INLINE void try_proposal(search* own, point proposal, double reach, decided known,
                               MODEL_SPACE const box_primitive* primitives) {
  const decided nothing = {0, 0};
  const double size = fabs(proposal.x) + fabs(proposal.y) + fabs(proposal.z) + reach;
  for (uint part = 0; part < CHILDREN; part += VECTOR_WIDTH) {
    const cube x = {broadcast(proposal), REAL(0.0)};
    const cut_query query = {{REAL(0.0), REAL(0.0), REAL(0.0)}, REAL(reach), size * LOAD(part / VECTOR_WIDTH, margins),
                             true};
    colour colours[PRIMITIVES];
    forget_colours(colours);
    const visit v = {x, query, own->outside, known, own->least_inside, own->least_outside, primitives, colours};
    const vector3 landing = add_scaled(x.centre, REAL(1.0), solid_node(&v).nearest);
    const colour c = colour_on_side(colour_at(landing, nothing, primitives), own->outside);
    const real distance = distance_between_up(landing, broadcast(own->query));
    double distances[VECTOR_WIDTH];
    STORE(select(REAL(INFINITY), distance, c.black & MASK(distance <= DBL_MAX)), 0, distances);
    for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) own->upper = fmin(own->upper, distances[lane]);
  }
}

// What is found out about the eight children of a cube.
typedef struct {
  double lower[CHILDREN];
  double upper[CHILDREN];  // of those that lie in the target, infinite for the others
  double promise[CHILDREN]; // distance of the proposal: in this order children are searched
  double nearest_x[CHILDREN], nearest_y[CHILDREN], nearest_z[CHILDREN];
  long black[CHILDREN], white[CHILDREN];
} children;

NEVER_INLINE void evaluate_children(search* own, octree_cube parent, point corner, double half_width,
                                    MODEL_SPACE const box_primitive* primitives, children* found) {
  for (uint part = 0; part < CHILDREN; part += VECTOR_WIDTH) {
    double xs[VECTOR_WIDTH], ys[VECTOR_WIDTH], zs[VECTOR_WIDTH];
    for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) {
      const uint child = part + lane;
      xs[lane] = corner.x + half_width * (double)(2 * (2 * parent.x + (child & 1)) + 1);
      ys[lane] = corner.y + half_width * (double)(2 * (2 * parent.y + ((child >> 1) & 1)) + 1);
      zs[lane] = corner.z + half_width * (double)(2 * (2 * parent.z + (child >> 2)) + 1);
    }
    const cube x = {{LOAD(0, xs), LOAD(0, ys), LOAD(0, zs)}, REAL(half_width)};
    const vector3 q = between(x.centre, broadcast(own->query));
    const cut_query query = {q, REAL(half_width), REAL(0.0), false};
    colour colours[PRIMITIVES];
    integer matters[PRIMITIVES];
    forget_colours(colours);
    none_matter(matters);
    const visit v = {x, query, own->outside, parent.known, own->least_inside, own->least_outside, primitives, colours};
    const node n = solid_node(&v);
    solid_colour(colours, matters);
    const decided_lanes known = simplified(colours, matters);
    // The coordinates of q from the centre are rounded once.
    const real size = fabs(q.x) + fabs(q.y) + fabs(q.z);
    const real lower = fmax(sub_down(n.lower, 0x1p-51 * size), REAL(parent.lower));
    const vector3 apart = {positive_part(sub_up(step_up(fabs(q.x)), x.half_width)),
                           positive_part(sub_up(step_up(fabs(q.y)), x.half_width)),
                           positive_part(sub_up(step_up(fabs(q.z)), x.half_width))};
    STORE(select(lower, REAL(INFINITY), n.colour.white), 0, found->lower + part);
    STORE(select(REAL(INFINITY), length_up(apart), n.colour.black), 0, found->upper + part);
    STORE(n.promise, 0, found->promise + part);
    STORE(x.centre.x + n.nearest.x, 0, found->nearest_x + part);
    STORE(x.centre.y + n.nearest.y, 0, found->nearest_y + part);
    STORE(x.centre.z + n.nearest.z, 0, found->nearest_z + part);
    STORE(known.black, 0, found->black + part);
    STORE(known.white, 0, found->white + part);
  }
}

ALWAYS_INLINE void give_up(search* own, double lower) { own->given_up = fmin(own->given_up, lower); }

ALWAYS_INLINE void push(search* own, uint level, uint child, decided known, double lower) {
  const uint at = own->stacked++;
  own->stack.place[at] = (ushort)(level << CHILD_BITS | child);
  own->stack.lower[at] = lower;
  own->stack.black[at] = (remembered_bits)known.black;
  own->stack.white[at] = (remembered_bits)known.white;
}

// `last` is the cube that was popped before this one.
ALWAYS_INLINE octree_cube pop(search* own, octree_cube last) {
  const uint at = --own->stacked;
  const uint place = own->stack.place[at];
  octree_cube next;
  next.level = place >> CHILD_BITS;
  const uint up = last.level + 1 - next.level; // from `last` to the parent
  next.x = 2 * (last.x >> up) + (place & 1);
  next.y = 2 * (last.y >> up) + ((place >> 1) & 1);
  next.z = 2 * (last.z >> up) + ((place >> 2) & 1);
  next.known.black = own->stack.black[at];
  next.known.white = own->stack.white[at];
  next.lower = own->stack.lower[at];
  return next;
}

// Pushes the children that may hold the nearest point, the most promising last.
ALWAYS_INLINE void push_children(search* own, octree_cube parent, const children* found) {
  double lower[CHILDREN];
  for (uint i = 0; i < CHILDREN; ++i) {
    lower[i] = found->lower[i];
    if (lower[i] == INFINITY) continue; // nothing of the target
    if (found->upper[i] == INFINITY && lower[i] < own->upper - own->allowance) continue;
    give_up(own, lower[i]);
    lower[i] = INFINITY;
  }
  for (uint n = 0; n < CHILDREN; ++n) {
    uint farthest = CHILDREN;
    for (uint i = 0; i < CHILDREN; ++i)
      if (lower[i] < INFINITY && (farthest == CHILDREN || found->promise[i] > found->promise[farthest])) farthest = i;
    if (farthest == CHILDREN) return;
    const decided known = {(uint)found->black[farthest], (uint)found->white[farthest]};
    push(own, parent.level + 1, farthest, known, lower[farthest]);
    lower[farthest] = INFINITY;
  }
}

ALWAYS_INLINE uint most_promising(const children* found) {
  uint best = 0;
  for (uint i = 1; i < CHILDREN; ++i)
    if (found->lower[i] < INFINITY &&
        (found->lower[best] == INFINITY || found->promise[i] < found->promise[best]))
      best = i;
  return best;
}

// The proven distance to the target, from below; own->upper is that from above.
ALWAYS_INLINE double searched_lower(search* own, point root, double root_half_width, uint round_limit,
                                    MODEL_SPACE const box_primitive* primitives) {
  const point corner = {root.x - root_half_width, root.y - root_half_width, root.z - root_half_width};
  const decided nothing = {0, 0};
  own->stacked = 0;
  push(own, 0, 0, nothing, 0.0);
  own->given_up = INFINITY;
  octree_cube parent = {0, 0, 0, 0, nothing, 0.0};
  uint idle = 0; // proposals in a row that did not help
  for (uint round = 0; own->stacked > 0 && round < round_limit; ++round) {
    parent = pop(own, parent);
    if (!(parent.lower < own->upper - own->allowance) || parent.level >= DEEPEST_CUBE) {
      give_up(own, parent.lower);
      continue;
    }
    const double half_width = ldexp(root_half_width, -(int)(parent.level + 1));
    children found;
    evaluate_children(own, parent, corner, half_width, primitives, &found);
    for (uint i = 0; i < CHILDREN; ++i) own->upper = fmin(own->upper, found.upper[i]);
    const uint nearest = most_promising(&found);
    const bool hopeful = found.lower[nearest] < own->upper - own->allowance;
    if (hopeful && (idle < 4 || (round & 3) == 0)) {
      const double before = own->upper;
      const point proposal = {found.nearest_x[nearest], found.nearest_y[nearest], found.nearest_z[nearest]};
      try_proposal(own, proposal, 2.0 * half_width, parent.known, primitives);
      idle = own->upper == INFINITY || before - own->upper > 0.25 * own->allowance ? 0 : idle + 1;
    }
    push_children(own, parent, &found);
  }
  while (own->stacked > 0) give_up(own, own->stack.lower[--own->stacked]);
  return fmin(own->given_up, own->upper);
}

// What is known about the query and each primitive alone: ends of enclosures, infinite where there is nothing, and
// vectors from the primitive's nearest point in its own frame (that of the bend).
typedef struct {
  ulong index, stride;
  global const double *los, *his, *normal_xs, *normal_ys, *normal_zs;
} parts;

ALWAYS_INLINE double middle_of_part(parts known, uint primitive) {
  const ulong k = primitive * known.stride + known.index;
  return 0.5 * (known.los[k] + known.his[k]);
}

// The nearest point of one primitive alone.
ALWAYS_INLINE void try_part(search* own, parts known, uint primitive, double reach,
                            MODEL_SPACE const box_primitive* primitives) {
  const ulong k = primitive * known.stride + known.index;
  const double nx = known.normal_xs[k], ny = known.normal_ys[k], nz = known.normal_zs[k];
  const double length = sqrt(nx * nx + ny * ny + nz * nz);
  if (!(length > 0.0)) return;
  MODEL_SPACE const double* r = primitives[primitive].frame;
  const double scale = middle_of_part(known, primitive) / length;
  const point proposal = {own->query.x - scale * (r[0] * nx + r[3] * ny + r[6] * nz),
                          own->query.y - scale * (r[1] * nx + r[4] * ny + r[7] * nz),
                          own->query.z - scale * (r[2] * nx + r[5] * ny + r[8] * nz)};
  const decided nothing = {0, 0};
  try_proposal(own, proposal, reach, nothing, primitives);
}

// Those of all primitives, the nearest first: most of the others are then too far to matter.
ALWAYS_INLINE void try_parts(search* own, parts known, double reach, MODEL_SPACE const box_primitive* primitives) {
  uint nearest = 0;
  for (uint i = 1; i < PRIMITIVES; ++i)
    if (fabs(middle_of_part(known, i)) < fabs(middle_of_part(known, nearest))) nearest = i;
  try_part(own, known, nearest, reach, primitives);
  for (uint i = 0; i < PRIMITIVES; ++i)
    if (i != nearest && fabs(middle_of_part(known, i)) < own->upper) try_part(own, known, i, reach, primitives);
}

// Which primitives the query is proven to lie in, or outside of.
ALWAYS_INLINE decided decided_by_parts(parts known) {
  decided d = {0, 0};
  for (uint i = 0; i < PRIMITIVES; ++i) {
    const ulong k = i * known.stride + known.index;
    if (known.his[k] < 0.0) d.black |= bit_of(i);
    if (known.los[k] > 0.0) d.white |= bit_of(i);
  }
  return d;
}

// `part_*` and `normal_*` are what point_distance and interior_depth, or bent_distance, found for each primitive,
// `stride` numbers apart; infinite ends where that is nothing. Makes the enclosures of the signed distance, those of
// set_bounds or infinite ones, as narrow as the tolerance.
kernel void solid_distance(ulong count, ulong stride, global const double* xs, global const double* ys,
                           global const double* zs, MODEL_SPACE const box_primitive* primitives, double root_x,
                           double root_y, double root_z, double root_half_width, double tolerance, uint round_limit,
                           global const double* part_los, global const double* part_his,
                           global const double* normal_xs, global const double* normal_ys,
                           global const double* normal_zs, global double* los, global double* his) {
  const ulong index = get_global_id(0);
  if (index >= count || his[index] - los[index] <= tolerance) return;
  search own;
  own.query.x = xs[index];
  own.query.y = ys[index];
  own.query.z = zs[index];
  own.allowance = 0.95 * tolerance; // leaves room for rounding
  const parts known = {index, stride, part_los, part_his, normal_xs, normal_ys, normal_zs};
  for (uint i = 0; i < PRIMITIVES; ++i) {
    own.least_inside[i] = fmax(part_los[i * stride + index], 0.0);
    own.least_outside[i] = fmax(-part_his[i * stride + index], 0.0);
  }
  const colour c = colour_at(broadcast(own.query), decided_by_parts(known), primitives);
  const bool inside = any(c.black);
  const bool beyond = any(c.white);
  const point root = {root_x, root_y, root_z};

  // On the surface, as far as rounding lets one see, both distances bound the signed one whatever its sign is.
  double lo = 0.0, hi = 0.0;
  for (uint side = 0; side < 2; ++side) {
    own.outside = side == 1;
    if (own.outside ? beyond : inside) continue;
    own.upper = own.outside ? -los[index] : his[index];
    try_parts(&own, known, 0x1p-10 * root_half_width, primitives);
    const double lower = searched_lower(&own, root, root_half_width, round_limit, primitives);
    if (own.outside) {
      lo = -own.upper;
      if (inside) hi = -lower;
    } else {
      hi = own.upper;
      if (beyond) lo = lower;
    }
  }
  los[index] = fmax(los[index], lo);
  his[index] = fmin(his[index], hi);
}
