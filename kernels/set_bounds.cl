// This file implements bounds of the signed distance of points to any model without a search: by what is known of its
// primitives, one by one and two by two (docs/mathematics.md §11).
//
// The target (the solid, or the closure of its complement) is a union of terms, and a term an intersection of literals:
// primitives K and closures of complements K^c. The distance to the target is the least of those to its terms, and that
// to a term at least the largest of those to its literals. Where the foot on that literal, its nearest point, lies in
// the target, this is tight. Where another literal of the term cuts it off, the nearest point lies on an edge, on the
// boundaries of both, as a rule.
//
// Of an edge a foot y is proposed. All points x of a primitive K have n.(x - y) <= o, a half-space; all of K^c have
// |x - c| >= r where the ball with the centre c and the radius r lies in K, which interior_depth proves. With
// d = q - y, multipliers l >= 0 of half-spaces and m >= 0 of balls, sum m < 1, and b = d - sum l n - sum m (c - y),
// every x in both literals has
//   |x - q|^2 >= |x - q|^2 + sum 2 l (n.(x - y) - o) - sum m (|x - c|^2 - r^2)
//             >= |d|^2 - |b|^2 / (1 - sum m) - sum 2 l o - sum m (|c - y|^2 - r^2):
// the right side of the first line is a convex quadratic function of x. At the nearest point of an edge d is a sum of
// both normals (Kuhn, Tucker), b vanishes, and so does what follows.

// Levels of the gauge at which feet lie: so far inside of primitives, or outside of those that are cut away, that
// rounding does not hide it.
#define FOOT_MARGIN 0x1p-44
#define EDGE_STEPS 16
#define EDGE_CONVERGED 1e-8
#define SMALLEST_PROBE 0x1p-16 // along an edge, for the curvatures of both surfaces
#define LEAST_BENDING 0.2      // of the squared distance along an edge, where that is not near its least
// A ball's radius over its share of d: its multiplier is the inverse, and their sum stays below 1.
#define BALL_OF_ONE 1.25
#define BALL_OF_TWO 2.5
#define LARGEST_MULTIPLIER 0.9
#define NOWHERE 0x1p20 // where no ball is wanted: outside of every primitive, in units of the device

#define NO_EDGE (-1.0)
#define COMPLEMENT 64 // of a literal: the closure of the complement of primitive `literal & 63`

// Both literals of an edge, and which target it is of, as one number: the numbers of lanes are looked at one by one.
ALWAYS_INLINE real edge_number(integer literal, integer open, bool complement) {
  return TO_REAL(literal * 128 + open + (complement ? 1L << 14 : 0L));
}
ALWAYS_INLINE uint first_literal(double edge) { return (uint)edge >> 7 & 127U; }
ALWAYS_INLINE uint second_literal(double edge) { return (uint)edge & 127U; }
ALWAYS_INLINE bool is_of_complement(double edge) { return (uint)edge >> 14 != 0; }

// One of the numbers that are left, which is left no more; NO_EDGE where none is.
ALWAYS_INLINE double take_edge(double* edges) {
  double taken = NO_EDGE;
  for (uint lane = 0; lane < VECTOR_WIDTH; ++lane) {
    if (taken != NO_EDGE && edges[lane] != taken) continue;
    taken = edges[lane];
    edges[lane] = NO_EDGE;
  }
  return taken;
}

ALWAYS_INLINE uint primitive_of(uint literal) { return literal & (COMPLEMENT - 1); }

// What is known of each primitive: columns, `stride` numbers apart; infinite ends where that is nothing.
typedef struct {
  ulong stride;
  global const double *los, *his, *normal_xs, *normal_ys, *normal_zs;
} primitive_columns;

ALWAYS_INLINE real low_of(primitive_columns known, uint i, ulong group) {
  return LOAD(group, known.los + i * known.stride);
}
ALWAYS_INLINE real high_of(primitive_columns known, uint i, ulong group) {
  return LOAD(group, known.his + i * known.stride);
}

// The term that is nearest as far as its literals say. Literals are primitives that have a bit (set_tree.clh).
typedef struct {
  real distance;           // lower bound of that to the term
  real others;             // and of those to all other terms
  integer inside, outside; // its literals, a bit for each primitive
  integer literal;         // the farthest
} nearest_term;

// Of the solid, or of the closure of its complement.
ALWAYS_INLINE nearest_term find_nearest_term(primitive_columns known, ulong group, bool complement) {
  nearest_term found = {REAL(INFINITY), REAL(INFINITY), INTEGER(0), INTEGER(0), INTEGER(-1)};
  const uint first = complement ? TERMS_OF_SOLID : 0;
  const uint last = complement ? TERMS_OF_SOLID + TERMS_OF_COMPLEMENT : TERMS_OF_SOLID;
  for (uint t = first; t < last; ++t) {
    real largest = REAL(0.0);
    integer literal = INTEGER(-1);
    for (uint i = 0; i < PRIMITIVES; ++i) {
      const bool is_inside = (term_inside[t] & bit_of(i)) != 0;
      if (!is_inside && (term_outside[t] & bit_of(i)) == 0) continue;
      const real distance = is_inside ? low_of(known, i, group) : -high_of(known, i, group);
      const integer farther = MASK(distance > largest) | (MASK(distance == largest) & MASK(literal < 0));
      largest = select(largest, distance, farther);
      literal = select(literal, INTEGER((long)(is_inside ? i : i | COMPLEMENT)), farther);
    }
    const integer nearer = MASK(largest < found.distance);
    found.others = fmin(found.others, select(largest, found.distance, nearer));
    found.distance = select(found.distance, largest, nearer);
    found.literal = select(found.literal, literal, nearer);
    found.inside = select(found.inside, INTEGER((long)term_inside[t]), nearer);
    found.outside = select(found.outside, INTEGER((long)term_outside[t]), nearer);
  }
  return found;
}

// The foot on the boundary of one literal, a little beyond it: from q by the proven upper end along the normal.
ALWAYS_INLINE vector3 foot_on_literal(vector3 q, integer literal, primitive_columns known, ulong group,
                                      MODEL_SPACE const box_primitive* primitives) {
  vector3 foot = {REAL(NAN), REAL(NAN), REAL(NAN)};
  for (uint i = 0; i < min((uint)PRIMITIVES, REMEMBERED); ++i) {
    const integer is_inside = MASK(literal == (long)i);
    const integer is_outside = MASK(literal == (long)(i | COMPLEMENT));
    const integer wanted = is_inside | is_outside;
    if (!any(wanted)) continue;
    MODEL_SPACE const double* r = primitives[i].frame;
    const real nx = LOAD(group, known.normal_xs + i * known.stride);
    const real ny = LOAD(group, known.normal_ys + i * known.stride);
    const real nz = LOAD(group, known.normal_zs + i * known.stride);
    const real size = fabs(q.x) + fabs(q.y) + fabs(q.z) + 1.0;
    const real beyond = FOOT_MARGIN * size;
    const real reach = select(high_of(known, i, group) + beyond, low_of(known, i, group) - beyond, is_outside);
    const real scale = -reach / sqrt(fma(nx, nx, fma(ny, ny, nz * nz)));
    const vector3 there = {fma(scale, r[0] * nx + r[3] * ny + r[6] * nz, q.x),
                           fma(scale, r[1] * nx + r[4] * ny + r[7] * nz, q.y),
                           fma(scale, r[2] * nx + r[5] * ny + r[8] * nz, q.z)};
    foot = select_vector(foot, there, wanted);
  }
  return foot;
}

// Of every primitive at a point each lane has its own of.
ALWAYS_INLINE void colours_at(vector3 x, colour* c, MODEL_SPACE const box_primitive* primitives) {
  const cube here = {x, REAL(0.0)};
  for (uint i = 0; i < PRIMITIVES; ++i) c[i] = primitive_colour(here, primitives + i);
}

// The distance of a foot that is proven to lie in the target, infinite for others.
ALWAYS_INLINE real distance_of_foot(vector3 q, vector3 foot, const colour* c, bool complement) {
  integer matters[PRIMITIVES];
  none_matter(matters);
  const colour own = colour_on_side(solid_colour(c, matters), complement);
  const real distance = distance_between_up(foot, q);
  return select(REAL(INFINITY), distance, own.black & MASK(distance <= DBL_MAX));
}

// A literal of the term that is not proven to hold at the foot: the nearest point may lie on its boundary, too.
ALWAYS_INLINE integer open_literal(nearest_term term, const colour* c) {
  integer open = INTEGER(-1);
  for (uint i = 0; i < PRIMITIVES; ++i) {
    const long bit = (long)bit_of(i);
    const integer other = MASK((term.literal & (COMPLEMENT - 1)) != (long)i);
    const integer is_inside = MASK((term.inside & bit) != 0) & ~c[i].black;
    const integer is_outside = MASK((term.outside & bit) != 0) & ~c[i].white;
    open = select(open, INTEGER((long)i), is_inside & other);
    open = select(open, INTEGER((long)(i | COMPLEMENT)), is_outside & other);
  }
  return open;
}

// The gauge of a primitive and its gradient in the model's frame; nothing is proven.
typedef struct {
  real gauge;
  vector3 gradient;
} gauge_level;

ALWAYS_INLINE gauge_level level_at(vector3 x, MODEL_SPACE const box_primitive* p) {
  const cube here = {x, REAL(0.0)};
  const local_map y = focal_map(here, p);
  const vector3 size = gauge_gradient(y, &p->solid);
  const gauge_level level = {dot_nearest(size, magnitudes(y.middle)),
                             pull_back(y, unfolded(size, y), REAL(0.0)).normal}; // Euler
  return level;
}

typedef struct {
  real a, b;
} two;

// The combination of both vectors whose products with them are those of `wanted`.
ALWAYS_INLINE two combination(vector3 a, vector3 b, two wanted) {
  const real aa = dot_nearest(a, a);
  const real ab = dot_nearest(a, b);
  const real bb = dot_nearest(b, b);
  const real inverse = 1.0 / (aa * bb - ab * ab);
  const two shares = {(bb * wanted.a - ab * wanted.b) * inverse, (aa * wanted.b - ab * wanted.a) * inverse};
  return shares;
}

// Where two boundaries meet, and d = shares.a * gradient a + shares.b * gradient b there.
typedef struct {
  vector3 foot;
  vector3 gradient_a, gradient_b;
  two shares;
} edge_foot;

// Newton's method for the point of the edge nearest to q: onto both levels by their gradients, along the edge by the
// squared distance and both curvatures, which a second look at the gradients tells.
NEVER_INLINE edge_foot find_edge_foot(vector3 q, vector3 start, integer wanted, uint literal_a, uint literal_b,
                                      MODEL_SPACE const box_primitive* primitives) {
  MODEL_SPACE const box_primitive* p = primitives + primitive_of(literal_a);
  MODEL_SPACE const box_primitive* s = primitives + primitive_of(literal_b);
  const double level_a = (literal_a & COMPLEMENT) != 0 ? 1.0 + 2.0 * FOOT_MARGIN : 1.0 - 2.0 * FOOT_MARGIN;
  const double level_b = (literal_b & COMPLEMENT) != 0 ? 1.0 + 2.0 * FOOT_MARGIN : 1.0 - 2.0 * FOOT_MARGIN;
  edge_foot edge;
  edge.foot = start;
  for (int step = 0; step < EDGE_STEPS; ++step) {
    const gauge_level a = level_at(edge.foot, p);
    const gauge_level b = level_at(edge.foot, s);
    const vector3 d = between(edge.foot, q);
    const two products = {dot_nearest(d, a.gradient), dot_nearest(d, b.gradient)};
    const two missing = {level_a - a.gauge, level_b - b.gauge};
    edge.gradient_a = a.gradient;
    edge.gradient_b = b.gradient;
    edge.shares = combination(a.gradient, b.gradient, products);
    const two onto = combination(a.gradient, b.gradient, missing);
    const vector3 along = add_scaled(add_scaled(d, -edge.shares.a, a.gradient), -edge.shares.b, b.gradient);
    const real length = length_nearest(along);
    const real inverse = 1.0 / fmax(length, REAL(1e-200));
    const vector3 direction = {along.x * inverse, along.y * inverse, along.z * inverse};
    const real probe = fmax(length, REAL(SMALLEST_PROBE));
    const vector3 ahead = add_scaled(edge.foot, probe, direction);
    const vector3 turn_a = between(a.gradient, level_at(ahead, p).gradient);
    const vector3 turn_b = between(b.gradient, level_at(ahead, s).gradient);
    const two turns = {dot_nearest(turn_a, direction) / probe, dot_nearest(turn_b, direction) / probe};
    const real curving = fma(edge.shares.a, turns.a, edge.shares.b * turns.b);
    const real bending = fmax(1.0 + curving, REAL(LEAST_BENDING));
    const vector3 on_both = add_scaled(add_scaled(edge.foot, onto.a, a.gradient), onto.b, b.gradient);
    const vector3 next = add_scaled(on_both, length / bending, direction);
    const real moved = length_nearest(between(edge.foot, next));
    edge.foot = next;
    if (!any(wanted & MASK(moved > EDGE_CONVERGED))) break;
  }
  return edge;
}

ALWAYS_INLINE bool is_complement(uint literal) { return (literal & COMPLEMENT) != 0; }

// The centre of the ball that is to lie in a primitive cut away: it touches the boundary at the foot.
ALWAYS_INLINE vector3 centre_of_ball(vector3 foot, vector3 gradient, real share, double radius_of_share) {
  return add_scaled(foot, radius_of_share * share, gradient); // the share is negative
}

// Lanes in which the shares have the signs of an edge: d leads out of primitives, and into those that are cut away.
ALWAYS_INLINE integer leads_away(real share, uint literal) {
  return is_complement(literal) ? MASK(share <= 0.0) : MASK(share >= 0.0);
}

// What is found out for a vector of points, a column each; `centres` are those of all primitives, one after the other.
typedef struct {
  ulong stride;
  global double *others, *edges;
  global double *foot_xs, *foot_ys, *foot_zs;
  global double *centre_xs, *centre_ys, *centre_zs;
  global double *wanted_balls; // infinity, where the ball about the centre is; below 0 elsewhere
} edge_columns;

ALWAYS_INLINE void store_centre(vector3 centre, integer where_true, uint primitive, ulong group, edge_columns out) {
  const ulong first = primitive * out.stride;
  STORE(select(LOAD(group, out.centre_xs + first), centre.x, where_true), group, out.centre_xs + first);
  STORE(select(LOAD(group, out.centre_ys + first), centre.y, where_true), group, out.centre_ys + first);
  STORE(select(LOAD(group, out.centre_zs + first), centre.z, where_true), group, out.centre_zs + first);
  STORE(select(LOAD(group, out.wanted_balls + first), REAL(INFINITY), where_true), group, out.wanted_balls + first);
}

// Column by column: centres far away, which later proofs of balls pass over.
ALWAYS_INLINE void forget_edges(vector3 q, ulong group, edge_columns out) {
  STORE(REAL(NO_EDGE), group, out.edges);
  STORE(REAL(0.0), group, out.others);
  STORE(q.x, group, out.foot_xs);
  STORE(q.y, group, out.foot_ys);
  STORE(q.z, group, out.foot_zs);
  for (uint i = 0; i < PRIMITIVES; ++i) {
    const ulong first = i * out.stride;
    STORE(REAL(NOWHERE), group, out.centre_xs + first);
    STORE(REAL(NOWHERE), group, out.centre_ys + first);
    STORE(REAL(NOWHERE), group, out.centre_zs + first);
    STORE(REAL(-INFINITY), group, out.wanted_balls + first);
  }
}

ALWAYS_INLINE bool is_bent(uint literal, MODEL_SPACE const box_primitive* primitives) {
  return primitives[primitive_of(literal)].curvature != 0.0;
}

// The nearest points of edges: `edge` says of which, lane by lane. Returns the least proven distance of the target.
ALWAYS_INLINE real find_edges(vector3 q, vector3 start, real edge, bool complement, ulong group, edge_columns out,
                              MODEL_SPACE const box_primitive* primitives) {
  real upper = REAL(INFINITY);
  real found = LOAD(group, out.edges);
  vector3 feet = {LOAD(group, out.foot_xs), LOAD(group, out.foot_ys), LOAD(group, out.foot_zs)};
  double edges[VECTOR_WIDTH];
  STORE(edge, 0, edges);
  for (double name = take_edge(edges); name != NO_EDGE; name = take_edge(edges)) {
    const uint a = first_literal(name);
    const uint b = second_literal(name);
    if (is_bent(a, primitives) || is_bent(b, primitives)) continue;
    const integer same = MASK(edge == name);
    const edge_foot at = find_edge_foot(q, start, same, a, b, primitives);
    const integer usable = same & leads_away(at.shares.a, a) & leads_away(at.shares.b, b);
    const double radius = is_complement(a) && is_complement(b) ? BALL_OF_TWO : BALL_OF_ONE;
    if (is_complement(a)) {
      store_centre(centre_of_ball(at.foot, at.gradient_a, at.shares.a, radius), usable, primitive_of(a), group, out);
    }
    if (is_complement(b)) {
      store_centre(centre_of_ball(at.foot, at.gradient_b, at.shares.b, radius), usable, primitive_of(b), group, out);
    }
    colour c[PRIMITIVES];
    colours_at(at.foot, c, primitives);
    upper = select(upper, distance_of_foot(q, at.foot, c, complement), usable);
    feet = select_vector(feet, at.foot, usable);
    found = select(found, REAL(name), usable);
  }
  STORE(found, group, out.edges);
  STORE(feet.x, group, out.foot_xs);
  STORE(feet.y, group, out.foot_ys);
  STORE(feet.z, group, out.foot_zs);
  return upper;
}

// Bounds of the distance to the target by single literals, and feet of edges where those do not do.
ALWAYS_INLINE interval bounds_by_literals(vector3 q, integer wanted, bool complement, double tolerance,
                                          primitive_columns known, ulong group, edge_columns out,
                                          MODEL_SPACE const box_primitive* primitives) {
  const nearest_term term = find_nearest_term(known, group, complement);
  const vector3 foot = foot_on_literal(q, term.literal, known, group, primitives);
  colour c[PRIMITIVES];
  colours_at(foot, c, primitives);
  real upper = distance_of_foot(q, foot, c, complement);
  const integer open = open_literal(term, c);
  // Of a term of which nothing is known no literal is the farthest.
  const integer missed =
      wanted & MASK(!(upper - term.distance <= tolerance)) & MASK(term.literal >= 0) & MASK(open >= 0);
  if (any(missed)) {
    const real edge = select(REAL(NO_EDGE), edge_number(term.literal, open, complement), missed);
    upper = fmin(upper, find_edges(q, foot, edge, complement, group, out, primitives));
    STORE(select(LOAD(group, out.others), term.others, missed), group, out.others);
  }
  return interval_of(fmin(term.distance, term.others), upper);
}

// Colours of the primitives at the query: by what is known of them, or evaluated.
ALWAYS_INLINE colour colour_of_query(vector3 q, primitive_columns known, ulong group,
                                     MODEL_SPACE const box_primitive* primitives) {
  const cube here = {q, REAL(0.0)};
  colour c[PRIMITIVES];
  for (uint i = 0; i < PRIMITIVES; ++i) {
    c[i].black = MASK(high_of(known, i, group) < 0.0);
    c[i].white = MASK(low_of(known, i, group) > 0.0);
    if (!any(~(c[i].black | c[i].white))) continue;
    const colour evaluated = primitive_colour(here, primitives + i);
    c[i].black |= evaluated.black;
    c[i].white |= evaluated.white;
  }
  integer matters[PRIMITIVES];
  none_matter(matters);
  return solid_colour(c, matters);
}

// Writes what single literals prove, infinite ends for queries too near the surface, and proposes edges for set_bounds.
kernel void set_feet(ulong groups, ulong stride, global const double* xs, global const double* ys,
                     global const double* zs, MODEL_SPACE const box_primitive* primitives, double tolerance,
                     global const double* part_los, global const double* part_his, global const double* normal_xs,
                     global const double* normal_ys, global const double* normal_zs, global double* los,
                     global double* his, global double* others, global double* edges, global double* foot_xs,
                     global double* foot_ys, global double* foot_zs, global double* centre_xs,
                     global double* centre_ys, global double* centre_zs, global double* wanted_balls) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 q = {LOAD(group, xs), LOAD(group, ys), LOAD(group, zs)};
  const primitive_columns known = {stride, part_los, part_his, normal_xs, normal_ys, normal_zs};
  const edge_columns out = {stride, others, edges, foot_xs, foot_ys,
                            foot_zs, centre_xs, centre_ys, centre_zs, wanted_balls};
  forget_edges(q, group, out);
  real lo = REAL(-INFINITY);
  real hi = REAL(INFINITY);
  const colour own = colour_of_query(q, known, group, primitives);
  if (TERMS_OF_SOLID > 0 && any(own.white)) {
    const interval outside = bounds_by_literals(q, own.white, false, tolerance, known, group, out, primitives);
    lo = select(lo, outside.lo, own.white);
    hi = select(hi, outside.hi, own.white);
  }
  if (TERMS_OF_COMPLEMENT > 0 && any(own.black)) {
    const interval inside = bounds_by_literals(q, own.black, true, tolerance, known, group, out, primitives);
    lo = select(lo, -inside.hi, own.black);
    hi = select(hi, -inside.lo, own.black);
  }
  STORE(lo, group, los);
  STORE(hi, group, his);
}

// What one literal of an edge proves, relative to the foot y.
typedef struct {
  interval x, y, z; // n, or c - y
  real slack;       // o, or |c - y|^2 - r^2, rounded up
  bool ball;
} edge_constraint;

// The half-space of a primitive, for its points whose coordinates differ from the foot's by `reach` at most.
ALWAYS_INLINE edge_constraint half_space_of(vector3 foot, real reach, MODEL_SPACE const box_primitive* p) {
  const cube about = {foot, reach};
  const local_map y = focal_map(about, p);
  const half_space h = inside_half_space(y, reach, gauge_gradient(y, &p->solid), &p->solid);
  const edge_constraint found = {interval_of(h.normal.x, h.normal.x), interval_of(h.normal.y, h.normal.y),
                                 interval_of(h.normal.z, h.normal.z), h.offset, false};
  return found;
}

// The ball in a primitive that is cut away: how deep its centre is, interior_depth says.
ALWAYS_INLINE edge_constraint ball_of(vector3 foot, vector3 centre, real depth) {
  const edge_constraint to_centre = {interval_difference(centre.x, foot.x), interval_difference(centre.y, foot.y),
                                     interval_difference(centre.z, foot.z), REAL(0.0), true};
  const interval square = squared_length(to_centre.x, to_centre.y, to_centre.z);
  edge_constraint found = to_centre;
  found.slack = sub_up(square.hi, mul_down(depth, depth));
  return found;
}

ALWAYS_INLINE vector3 middle_of_constraint(edge_constraint c) {
  const vector3 v = {middle_of(c.x), middle_of(c.y), middle_of(c.z)};
  return v;
}

ALWAYS_INLINE interval times(real a, interval b) { return interval_mul(interval_of(a, a), b); }

// d less the multiples of both.
ALWAYS_INLINE interval remainder_of(interval d, two m, interval a, interval b) {
  return interval_sub(interval_sub(d, times(m.a, a)), times(m.b, b));
}

// Lower bound of the distance of q to the points that both constraints admit.
ALWAYS_INLINE real edge_distance_down(vector3 q, vector3 foot, edge_constraint a, edge_constraint b) {
  const interval dx = interval_difference(q.x, foot.x);
  const interval dy = interval_difference(q.y, foot.y);
  const interval dz = interval_difference(q.z, foot.z);
  const vector3 d = {middle_of(dx), middle_of(dy), middle_of(dz)};
  const vector3 along_a = middle_of_constraint(a);
  const vector3 along_b = middle_of_constraint(b);
  const two products = {dot_nearest(d, along_a), dot_nearest(d, along_b)};
  const two shares = combination(along_a, along_b, products);
  // Whatever nonnegative numbers these are; NaN gives NaN.
  const real most = REAL(a.ball && b.ball ? 0.5 * LARGEST_MULTIPLIER : LARGEST_MULTIPLIER);
  const real above_a = positive_part(shares.a);
  const real above_b = positive_part(shares.b);
  const two m = {a.ball ? least_or_nan(above_a, most) : above_a, b.ball ? least_or_nan(above_b, most) : above_b};
  const real balls = add_up(a.ball ? m.a : REAL(0.0), b.ball ? m.b : REAL(0.0));

  const interval left = squared_length(remainder_of(dx, m, a.x, b.x), remainder_of(dy, m, a.y, b.y),
                                       remainder_of(dz, m, a.z, b.z));
  const real slack_a = mul_up(a.ball ? m.a : 2.0 * m.a, a.slack);
  const real slack_b = mul_up(b.ball ? m.b : 2.0 * m.b, b.slack);
  const real loss = add_up(div_up(left.hi, sub_down(REAL(1.0), balls)), add_up(slack_a, slack_b));
  const real square = sub_down(squared_length(dx, dy, dz).lo, loss);
  const integer valid = MASK(m.a <= DBL_MAX) & MASK(m.b <= DBL_MAX) & MASK(square > 0.0) & MASK(square <= DBL_MAX);
  return select(REAL(0.0), sqrt_down(square), valid);
}

// Of the balls in all primitives: centres, and enclosures of their signed distances.
typedef struct {
  ulong stride;
  global const double *xs, *ys, *zs, *his;
} ball_columns;

ALWAYS_INLINE edge_constraint constraint_of(uint literal, vector3 foot, real reach, ball_columns balls, ulong group,
                                            MODEL_SPACE const box_primitive* primitives) {
  const uint i = primitive_of(literal);
  if (!is_complement(literal)) return half_space_of(foot, reach, primitives + i);
  const ulong first = i * balls.stride;
  const vector3 centre = {LOAD(group, balls.xs + first), LOAD(group, balls.ys + first), LOAD(group, balls.zs + first)};
  return ball_of(foot, centre, positive_part(-LOAD(group, balls.his + first)));
}

// Raises the lower bounds of points whose nearest one is on an edge: `ball_his` are upper ends of the signed distances
// of the balls' centres, primitive by primitive.
kernel void set_bounds(ulong groups, ulong stride, global const double* xs, global const double* ys,
                       global const double* zs, MODEL_SPACE const box_primitive* primitives,
                       global const double* others, global const double* edges, global const double* foot_xs,
                       global const double* foot_ys, global const double* foot_zs, global const double* centre_xs,
                       global const double* centre_ys, global const double* centre_zs, global const double* ball_his,
                       global double* los, global double* his) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const real edge = LOAD(group, edges);
  if (!any(MASK(edge != NO_EDGE))) return;
  const vector3 q = {LOAD(group, xs), LOAD(group, ys), LOAD(group, zs)};
  const vector3 foot = {LOAD(group, foot_xs), LOAD(group, foot_ys), LOAD(group, foot_zs)};
  const ball_columns balls = {stride, centre_xs, centre_ys, centre_zs, ball_his};
  real lo = LOAD(group, los);
  real hi = LOAD(group, his);
  double left[VECTOR_WIDTH];
  STORE(edge, 0, left);
  for (double name = take_edge(left); name != NO_EDGE; name = take_edge(left)) {
    const bool complement = is_of_complement(name);
    const real upper = complement ? -lo : hi;
    // No point of the target within `upper` is farther from the foot.
    const real reach = add_up(upper, distance_between_up(foot, q));
    const edge_constraint a = constraint_of(first_literal(name), foot, reach, balls, group, primitives);
    const edge_constraint b = constraint_of(second_literal(name), foot, reach, balls, group, primitives);
    const real of_edge = edge_distance_down(q, foot, a, b);
    const real lower = fmin(of_edge, LOAD(group, others));
    const integer same = MASK(edge == name);
    if (complement) hi = select(hi, fmin(hi, -lower), same);
    else lo = select(lo, fmax(lo, lower), same);
  }
  STORE(lo, group, los);
  STORE(hi, group, his);
}
