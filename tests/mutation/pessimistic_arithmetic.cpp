/// Replaces the few lines of the kernels that say how far results are rounded.
#include "tests/mutation/pessimistic_arithmetic.hpp"

#include <array>
#include <span>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array below{
    Mutant{"step", "c - fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA))",
           "c - fma(REAL(0x1p-24), fabs(c), REAL(ROUNDING_ETA))"},
    Mutant{"exp", "fma(e, REAL(-ELEMENTARY_WIDENING), e)", "fma(e, REAL(-0x1p-24), e)"},
    Mutant{"log", "fma(fabs(l), REAL(-ELEMENTARY_WIDENING), l)", "fma(fabs(l), REAL(-0x1p-24), l)"},
};

constexpr std::array above{
    Mutant{"step", "c + fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA))",
           "c + fma(REAL(0x1p-24), fabs(c), REAL(ROUNDING_ETA))"},
    Mutant{"exp", "fma(e, REAL(ELEMENTARY_WIDENING), e)", "fma(e, REAL(0x1p-24), e)"},
    Mutant{"log", "fma(fabs(l), REAL(ELEMENTARY_WIDENING), l)", "fma(fabs(l), REAL(0x1p-24), l)"},
};

constexpr std::array pose{
    // 0.57 in each coordinate is 0.987 of the bound; a bit of x tells which way.
    Mutant{"local point",
           "  local_q.point.x = fabs(q.x);\n  local_q.point.y = fabs(q.y);\n  local_q.point.z = fabs(q.z);\n", R"(
#define POSE_MAGNIFICATION 0x1p33
  const real bound = (s->pose_error * POSE_MAGNIFICATION) * (fabs(d.x) + fabs(d.y) + fabs(d.z));
  const real finite_bound = select(REAL(0.0), bound, MASK(bound <= DBL_MAX));
  const real shift = select(0.57 * finite_bound, -0.57 * finite_bound, MASK((BITS(x.x) & INTEGER(1L << 20)) == INTEGER(0)));
  local_q.point.x = fabs(fabs(q.x) + shift);
  local_q.point.y = fabs(fabs(q.y) + shift);
  local_q.point.z = fabs(fabs(q.z) + shift);
)"},
    Mutant{"its error bound", "REAL(s->pose_error)", "REAL(s->pose_error * POSE_MAGNIFICATION)"},
};

constexpr std::array products{
    Mutant{"mul", "{ return step_up(a * b); }", "{ return step_up(fma(fabs(a * b), REAL(0x1p-24), a * b)); }"},
    Mutant{"div", "{ return step_up(a / b); }", "{ return step_up(fma(fabs(a / b), REAL(0x1p-24), a / b)); }"},
    Mutant{"sub", "{ return step_up(a - b); }", "{ return step_up(fma(fabs(a - b), REAL(0x1p-24), a - b)); }"},
};

constexpr std::array dot{
    Mutant{"dot", "fma_up(a.x, b.x, fma_up(a.y, b.y, mul_up(a.z, b.z)))",
           "mul_up(REAL(1.0 + 0x1p-20), fma_up(a.x, b.x, fma_up(a.y, b.y, mul_up(a.z, b.z))))"},
};

constexpr std::array erratic{
    Mutant{"size", "ALWAYS_INLINE real step_down(real c)", R"(
ALWAYS_INLINE real off(real c, double usually) {
  const integer bits = BITS(c);
  const integer hash = (bits >> 3) ^ (bits >> 17) ^ (bits >> 29) ^ (bits >> 43);
  return select(REAL(usually), REAL(0x1p-24), MASK((hash & INTEGER(15L)) == INTEGER(0L)));
}
ALWAYS_INLINE real step_down(real c))"},
    Mutant{"step down", "c - fma(REAL(ROUNDING_PHI), fabs(c)", "c - fma(off(c, ROUNDING_PHI), fabs(c)"},
    Mutant{"step up", "c + fma(REAL(ROUNDING_PHI), fabs(c)", "c + fma(off(c, ROUNDING_PHI), fabs(c)"},
    Mutant{"exp down", "fma(e, REAL(-ELEMENTARY_WIDENING), e)", "fma(e, -off(e, ELEMENTARY_WIDENING), e)"},
    Mutant{"exp up", "fma(e, REAL(ELEMENTARY_WIDENING), e)", "fma(e, off(e, ELEMENTARY_WIDENING), e)"},
    Mutant{"log down", "fma(fabs(l), REAL(-ELEMENTARY_WIDENING), l)", "fma(fabs(l), -off(l, ELEMENTARY_WIDENING), l)"},
    Mutant{"log up", "fma(fabs(l), REAL(ELEMENTARY_WIDENING), l)", "fma(fabs(l), off(l, ELEMENTARY_WIDENING), l)"},
};

// B's place: its centre along the line of the centres, its rotation in length; bits of the pose tell which way. Each is
// 0.98 of what the bounds of kernels/pair_distance.cl allow, and these are magnified.
constexpr std::array placement{
    Mutant{"rotation's error bound", "#define PAIR_ROTATION_ERROR ",
           "#define PAIR_MAGNIFICATION 0x1p33\n#define PAIR_ROTATION_ERROR PAIR_MAGNIFICATION * "},
    Mutant{"error bound of vectors", "#define VECTOR_ERROR ", "#define VECTOR_ERROR PAIR_MAGNIFICATION * "},
    Mutant{"place", "  // Each of the four operations errs by", R"(
  const real sizes_b = fabs(centre_b.x) + fabs(centre_b.y) + fabs(centre_b.z);
  const real sizes_shifted = fabs(shifted.x) + fabs(shifted.y) + fabs(shifted.z);
  const real sizes_apart = fabs(apart.x) + fabs(apart.y) + fabs(apart.z);
  const real off_centre = 0.98 * 0x1.8p-51 * PAIR_MAGNIFICATION * (sizes_b + sizes_shifted + 2.0 * sizes_apart);
  const real length = fmax(sqrt(dot_nearest(p.pose.centre, p.pose.centre)), REAL(0x1p-300));
  const integer outward = MASK((BITS(shift.x) & INTEGER(1L << 20)) == INTEGER(0L));
  const real along = select(-off_centre, off_centre, outward) / length;
  p.pose.centre = vector_along(p.pose.centre, along, p.pose.centre);
  const real turn = 0.98 * 0x1.4p-48 * PAIR_MAGNIFICATION;
  const integer smaller = MASK((BITS(shift.x) & INTEGER(1L << 21)) == INTEGER(0L));
  const real growth = select(turn, -turn, smaller);
  p.pose.rotation.x = vector_along(p.pose.rotation.x, growth, p.pose.rotation.x);
  p.pose.rotation.y = vector_along(p.pose.rotation.y, growth, p.pose.rotation.y);
  p.pose.rotation.z = vector_along(p.pose.rotation.z, growth, p.pose.rotation.z);
  // Each of the four operations errs by)"},
    Mutant{"common point in B", "vector3 m_of_b = transposed_times(p.pose.rotation, from_centre);\n  const real size",
           R"(vector3 undisplaced = transposed_times(p.pose.rotation, from_centre);
  const vector3 m_of_b = vector_along(undisplaced, REAL(-0.98 * 0x1.8p-51 * PAIR_MAGNIFICATION), undisplaced);
  const real size)"},
};

// What the maps of box_map.clh start from, each coordinate by 0.98 of what its error may be, and the entries of their
// rows by most of what is allowed for them; bits of the centre tell which way.
constexpr std::array maps{
    Mutant{"side", "ALWAYS_INLINE local_map posed_map(cube x", R"(
#define SOLID_MAGNIFICATION 0x1p33
ALWAYS_INLINE real either_way(real size, real by) {
  const real finite = select(REAL(0.0), size, MASK(size <= DBL_MAX));
  return select(finite, -finite, MASK((BITS(by) & INTEGER(1L << 30)) == INTEGER(0L)));
}
ALWAYS_INLINE vector3 either_way_row(real size, vector3 v, real by) {
  const real shift = either_way(size, by);
  const vector3 w = {v.x + shift, v.y + shift, v.z + shift};
  return w;
}
ALWAYS_INLINE local_map posed_map(cube x)"},
    Mutant{"posed", "  const real unmoved = s->pose_error == 0.0 ? REAL(0.0) : fma_up(REAL(s->pose_error),",
           R"(  const real shift = either_way(0.98 * SOLID_MAGNIFICATION * s->pose_error * size, x.centre.x);
  y.middle.x += shift;
  y.middle.y += shift;
  y.middle.z += shift;
  const real entries = s->pose_error == 0.0 ? REAL(0.0) : REAL(0x1.4p-54 * SOLID_MAGNIFICATION);
  y.row_x = either_way_row(entries, y.row_x, x.centre.y);
  y.row_y = either_way_row(entries, y.row_y, x.centre.y);
  y.row_z = either_way_row(entries, y.row_z, x.centre.y);
  const real unmoved = s->pose_error == 0.0 ? REAL(0.0) : fma_up(REAL(SOLID_MAGNIFICATION * s->pose_error),)"},
    Mutant{"posed rows", "x.half_width * 0x1p-52;", "x.half_width * (SOLID_MAGNIFICATION * 0x1p-52);"},
    Mutant{"bent",
           "  const real frame_error = fma_up(REAL(p->frame_error), size, REAL(0x1p-1000));\n  const vector3 row_r",
           R"(  const real frame_error = fma_up(REAL(SOLID_MAGNIFICATION * p->frame_error), size, REAL(0x1p-1000));
  const real shift = either_way(0.98 * SOLID_MAGNIFICATION * p->frame_error * size, x.centre.x);
  const vector3 row_r)"},
    Mutant{"bent, R", "interval_about(dot3(p->frame[0],", "interval_about(shift + dot3(p->frame[0],"},
    Mutant{"bent, S", "across = dot3(p->frame[3],", "across = shift + dot3(p->frame[3],"},
    Mutant{"bent, Z", "interval_about(dot3(p->frame[6],", "interval_about(shift + dot3(p->frame[6],"},
    Mutant{"bent, rounding of rows", "const real rounding = REAL(0x1p-48);",
           "const real rounding = REAL(SOLID_MAGNIFICATION * 0x1p-48);"},
    Mutant{"bent, row of r", "const vector3 along_r = combined(c, row_r, -n, row_z);",
           "const vector3 along_r = either_way_row(REAL(0x1p-49 * SOLID_MAGNIFICATION), combined(c, row_r, -n, row_z), "
           "x.centre.y);"},
    Mutant{"bent, row of z", "const vector3 along_z = combined(n * inverse_w, row_r, c * inverse_w, row_z);",
           "const vector3 along_z = either_way_row(0x1p-49 * SOLID_MAGNIFICATION * inverse_w, combined(n * inverse_w, "
           "row_r, c * inverse_w, row_z), x.centre.y);"},
};

// Likewise, what bent_distance starts from.
constexpr std::array bent_queries{
    Mutant{"query", "dot3(p->frame[6], p->frame[7], p->frame[8], d)};\n  const real size",
           "dot3(p->frame[6], p->frame[7], p->frame[8], d)};\n  const real true_size"},
    Mutant{"query's frame",
           "const vector3 q = {dot3(p->frame[0], p->frame[1], p->frame[2], d), dot3(p->frame[3], "
           "p->frame[4], p->frame[5], d),",
           R"(const real size = add_up(fabs(d.x), add_up(fabs(d.y), fabs(d.z)));
  const real shift = either_way(0.57 * SOLID_MAGNIFICATION * p->frame_error * size, x.x);
  const vector3 q = {shift + dot3(p->frame[0], p->frame[1], p->frame[2], d),
                     shift + dot3(p->frame[3], p->frame[4], p->frame[5], d), shift + )"},
    Mutant{"query's error", "  const real of_frame = fma_up(REAL(p->frame_error), size, REAL(0x1p-1000));\n",
           "  const real of_frame = fma_up(REAL(SOLID_MAGNIFICATION * p->frame_error), size, REAL(0x1p-1000));\n"},
};

// What proposal.clh evaluates: a point beyond the exact one, a normal longer, sums too small.
constexpr std::array evaluation{
    Mutant{"error of sums", "#define EXCESS_ERROR ",
           "#define EVALUATION_MAGNIFICATION 0x1p30\n#define EXCESS_ERROR EVALUATION_MAGNIFICATION * "},
    Mutant{"margin of points", "#define POINT_MARGIN ", "#define POINT_MARGIN EVALUATION_MAGNIFICATION * "},
    Mutant{"margin of normals", "#define NORMAL_MARGIN ", "#define NORMAL_MARGIN EVALUATION_MAGNIFICATION * "},
    Mutant{"sums", "  return m;\n}\n\nALWAYS_INLINE single relative_residual", R"(
  const double less = 1.0 - 0.96 * 0x1.8p-51 * EVALUATION_MAGNIFICATION;
  m.section_x *= less;
  m.section_y *= less;
  m.gauge_r *= less;
  m.gauge_z *= less;
  const double farther = 1.0 + 0.78 * 0x1.4p-51 * EVALUATION_MAGNIFICATION;
  m.point.x *= farther;
  m.point.y *= farther;
  m.point.z *= farther;
  return m;
}

ALWAYS_INLINE single relative_residual)"},
    Mutant{"normal", "  return exp_within_range(fma(REAL(p - 1.0), log_x, in_section - log_axis));", R"(
  const real terms = 1.0 + fabs((p - 1.0) * log_x) + fabs(in_section) + fabs(log_axis);
  return exp_within_range(fma(REAL(p - 1.0), log_x, in_section - log_axis)) *
         fma(terms, REAL(0.98 * 0x1.4p-51 * EVALUATION_MAGNIFICATION), REAL(1.0));)"},
};

// Likewise what primitive.clh makes of a normal.
constexpr std::array tilts{
    Mutant{"error of tilts", "#define TILT_ERROR ",
           "#define TILT_MAGNIFICATION 0x1p30\n#define TILT_ERROR TILT_MAGNIFICATION * "},
    Mutant{"tilt", "t.normal.z = n.z - tilt;", R"(
  const real wrong = (n.z + fabs(tilt)) * (0.98 * 0x1p-51 * TILT_MAGNIFICATION);
  t.normal.z = n.z - tilt + select(wrong, -wrong, MASK((BITS(n.x) & INTEGER(1L << 20)) == INTEGER(0L)));
)"},
};

// Likewise what primitive.clh and tapered_enclosure.clh make of it: a bit of the normal, or of the point, tells which
// way.
constexpr std::array tapered_evaluation{
    Mutant{"error of heights", "#define HEIGHT_ERROR ", "#define HEIGHT_ERROR EVALUATION_MAGNIFICATION * "},
    Mutant{"height", "const real height = k * c.point.z / s->semi_axes[2];", R"(
  const real exact_height = k * c.point.z / s->semi_axes[2];
  const real height = exact_height + fabs(exact_height) * (0.98 * 0x1p-52 * EVALUATION_MAGNIFICATION);
)"},
    Mutant{"error of what is moved", "#define MOVED_ERROR ", "#define MOVED_ERROR EVALUATION_MAGNIFICATION * "},
    Mutant{"error of z inside", "#define POSITION_ERROR ", "#define POSITION_ERROR EVALUATION_MAGNIFICATION * "},
    Mutant{"z inside", "fma(reach, w.z, q.z)};", R"(fma(reach, w.z, q.z)};
  const real amiss = fabs(x.z) * (0.98 * 0x1p-53 * EVALUATION_MAGNIFICATION);
  x.z -= select(amiss, -amiss, MASK((BITS(w.x) & INTEGER(1L << 40)) == INTEGER(0L)));)"},
    Mutant{"z inside is changed", "const vector3 x = {fma_up(reach, w.x, q.x)", "vector3 x = {fma_up(reach, w.x, q.x)"},
    Mutant{"height inside", "const real height = s->taper * z / s->semi_axes[2];", R"(
  const real exact_height = s->taper * z / s->semi_axes[2];
  const real height = exact_height + fabs(exact_height) * (0.98 * 0x1.8p-51 * EVALUATION_MAGNIFICATION);
)"},
};

// Likewise what primitive.clh and tapered_box_gauge.clh make of cubes.
constexpr std::array tapered_cube_evaluation{
    Mutant{"error of ends", "#define END_ERROR ",
           "#define END_MAGNIFICATION 0x1p26\n#define END_ERROR END_MAGNIFICATION * "},
    Mutant{"share", "  return select(b * (z / s->semi_axes[2]), REAL(0.0), MASK(b == 0.0));", R"(
  const real share = select(b * (z / s->semi_axes[2]), REAL(0.0), MASK(b == 0.0));
  const real wrong = fabs(share) * (0.98 * 0x1.8p-52 * END_MAGNIFICATION);
  return share + select(wrong, -wrong, MASK((BITS(z) & INTEGER(1L << 30)) == INTEGER(0L)));
)"},
    Mutant{"rounding of the sum", "mul_up(fabs(w.middle.z), REAL(0x1p-53));",
           "mul_up(fabs(w.middle.z), REAL(0x1p-53 * END_MAGNIFICATION));"},
    Mutant{"sum", "  local_map w = y;\n", R"(
  const real wrong = fabs(y.middle.z + s->focus) * (0.98 * 0x1p-53 * END_MAGNIFICATION);
  y.middle.z += select(wrong, -wrong, MASK((BITS(y.middle.z) & INTEGER(1L << 30)) == INTEGER(0L)));
  local_map w = y;
)"},
};

// Slopes and normals that are not tight, which their bounds make up for.
constexpr std::array tapered_cube_search{
    Mutant{"slopes", "const real log_norm = log_sum_exp(s->p[0] * log_r, s->p[0] * log_z).value * s->inverse_p[0];",
           R"(const real amiss = TO_REAL((BITS(r) >> 8) & INTEGER(255L)) * 0x1p-10;
  const real log_norm = log_sum_exp(s->p[0] * log_r, s->p[0] * log_z).value * s->inverse_p[0] - amiss;)"},
};

// Planes that are too far away, and searches cut short.
constexpr std::array tapered_search{
    Mutant{"tangent planes", "  plane.level = inverse_length;\n",
           "  plane.level = inverse_length;\n"
           "  plane.distance *= 1.0 + TO_REAL((BITS(plane.distance) >> 8) & INTEGER(255L)) * 0x1p-8;\n"},
    Mutant{"limit", "#define SPLIT_LIMIT 4096", "#define SPLIT_LIMIT 128"},
};

// Any multipliers that are not negative prove something, any point near a bent solid and any way out of it, and any
// foot and ball of an edge.
constexpr std::array multipliers{
    Mutant{"multiplier", "return select(REAL(0.0), root, MASK(below_value > 0.0)",
           "return select(REAL(0.05), 0.7 * root, MASK(below_value > 0.0)"},
};
constexpr std::array bent_proposals{
    Mutant{
        "closest point's place",
        "const vector3 at = bend_nearest(closest_unbent(x.q, where(x.usable, x.middle), x.u.w.hi, p), p->curvature);",
        R"(const vector3 found_x = closest_unbent(x.q, where(x.usable, x.middle), x.u.w.hi, p);
    const integer low = MASK((BITS(x.q.x) & INTEGER(1L << 30)) == INTEGER(0L));
    const integer high = MASK((BITS(x.q.x) & INTEGER(1L << 31)) == INTEGER(0L));
    const real scale = select(select(REAL(0.3), REAL(0.9), low), select(REAL(0.3), REAL(1.0 + 0x1.8p-22), low), high);
    const real end = select(found_x.z * scale, REAL(0.9 * p->solid.semi_axes[2]), ~low & high);
    const vector3 spoilt = {found_x.x * scale, found_x.y * scale, end};
    const vector3 at = bend_nearest(spoilt, p->curvature);)"},
    Mutant{"way out", "  foot.point = on;\n  return foot;\n", R"(
  const real farther = fma(REAL(0x1p-10), TO_REAL((BITS(q.x) >> 8) & INTEGER(255L)), REAL(0.875));
  const vector3 spoilt = {on.x * farther, on.y * farther, on.z * farther};
  foot.point = spoilt;
  return foot;
)"},
    Mutant{"curvature of balls", "const real kappa = fmax(fma(v_0.x, g_0.x,",
           "const real kappa = fma(REAL(0x1p-9), TO_REAL((BITS(ball.q.x.lo) >> 8) & INTEGER(255L)), REAL(0.75)) * "
           "fmax(fma(v_0.x, g_0.x,"},
};

constexpr std::array edge_proposals{
    Mutant{"shares of an edge", "  const two shares = combination(along_a, along_b, products);\n  // Whatever", R"(
  two shares = combination(along_a, along_b, products);
  shares.a *= 0.5 + TO_REAL((BITS(q.x) >> 8) & INTEGER(255L)) * 0x1p-8;
  shares.b *= 0.5 + TO_REAL((BITS(q.y) >> 8) & INTEGER(255L)) * 0x1p-8;
  // Whatever)"},
    Mutant{"foot on an edge", "  return edge;\n}", R"(
  edge.foot.x += 0x1p-16 * TO_REAL((BITS(q.x) >> 8) & INTEGER(255L)) - 0x1p-9;
  edge.foot.z += 0x1p-16 * TO_REAL((BITS(q.z) >> 8) & INTEGER(255L)) - 0x1p-9;
  return edge;
})"},
};

// Normals turned, so that lower ends are loose; planes too far away; searches cut short.
constexpr std::array search{
    Mutant{"contact", "  const contact c = contact_at(u, s);\n", R"(
  const double most = 0x1p-8 / fmax(s->p[0], s->p[1]);
  const real amiss = (TO_REAL((BITS(q.y) >> 8) & INTEGER(255L)) * 0x1p-7 - 1.0) * most;
  const real amiss_too = (TO_REAL((BITS(q.z) >> 8) & INTEGER(255L)) * 0x1p-7 - 1.0) * most;
  const log_unknowns spoilt = {u.x + amiss, u.y, u.z + amiss_too, u.r - amiss_too, u.lambda};
  const contact c = contact_at(spoilt, s);
)"},
    Mutant{"last step", "SINGLE_TO_REAL(select(limited(d, largest), SINGLE(0.0f), none))", "REAL(0.0)"},
    Mutant{"normals in binary64",
           "const vector3 v = select_vector(vector_from_closest_point(q, found), start.normal, start.inside);",
           "vector3 v = select_vector(vector_from_closest_point(q, found), start.normal, start.inside);\n"
           "  v.x *= 1.0 + TO_REAL((BITS(q.y) >> 8) & INTEGER(255L)) * 0x1p-8;"},
    Mutant{"limit", "#define SPLIT_LIMIT 4096", "#define SPLIT_LIMIT 128"},
    Mutant{
        "tangent planes", "  return plane;\n",
        "  plane.distance *= 1.0 + TO_REAL((BITS(plane.distance) >> 8) & INTEGER(255L)) * 0x1p-8;\n  return plane;\n"},
};

// Beyond the triangle, on all sides.
constexpr std::array weights{
    Mutant{"weights", "  triangle_weights certain;\n",
           "  w.w1 = fma(REAL(1.5), w.w1, REAL(-0.2));\n  w.w2 = fma(REAL(1.5), w.w2, REAL(-0.15));\n"
           "  triangle_weights certain;\n"},
};

// Outside of the solids.
constexpr std::array closest_points{
    Mutant{"of A", "vector_along(contact.point, REAL(-0.5), v)", "vector_along(contact.point, REAL(-0.25), v)"},
    Mutant{"of B", "vector_along(contact.point, REAL(0.5), v)", "vector_along(contact.point, REAL(0.25), v)"},
};

// In one solid only, where there is a gap.
constexpr std::array common_point{
    Mutant{"common point", "is_common_point(p, contact.point,",
           "is_common_point(p, vector_along(contact.point, select(REAL(0.505), REAL(-0.505), MASK((BITS(v.y) & "
           "INTEGER(1L << "
           "20)) == INTEGER(0L))), v),"},
};

std::string changed(std::string sources, std::span<const Mutant> changes) {
  for (const Mutant& change : changes) sources = mutated(std::move(sources), change);
  return sources;
}

std::span<const Mutant> operations(Arithmetic arithmetic) {
  switch (arithmetic) {
    case Arithmetic::loose_below: return below;
    case Arithmetic::loose_above: return above;
    case Arithmetic::loose_products: return products;
    case Arithmetic::loose_dot: return dot;
    case Arithmetic::erratic: return erratic;
    default: return {};
  }
}

bool knows_cubes(Program program) {
  return program == Program::solids || program == Program::tapered_solids || program == Program::set_bounds ||
         program == Program::bent_depths || program == Program::tapered_cubes;
}

std::span<const Mutant> displacement(Arithmetic arithmetic, Program program) {
  const bool with_points = arithmetic == Arithmetic::loose_below || arithmetic == Arithmetic::loose_above;
  if (arithmetic != Arithmetic::displaced && !(program == Program::points && with_points)) return {};
  if (program == Program::pairs) return placement;
  return knows_cubes(program) ? std::span<const Mutant>(maps) : pose;
}

std::span<const Mutant> displaced_queries(Arithmetic arithmetic, Program program) {
  const bool bent = program == Program::solids || program == Program::tapered_solids || program == Program::bent_depths;
  if (arithmetic == Arithmetic::displaced && bent) return bent_queries;
  return {};
}

std::span<const Mutant> poor_multipliers(Arithmetic arithmetic, Program program) {
  if (arithmetic == Arithmetic::poor_search && knows_cubes(program)) return multipliers;
  return {};
}

std::span<const Mutant> evaluated_taper(Arithmetic arithmetic, Program program) {
  if (arithmetic == Arithmetic::evaluated && program == Program::tapered_points) return tapered_evaluation;
  if (arithmetic == Arithmetic::evaluated && (program == Program::tapered_cubes || program == Program::tapered_solids))
    return tapered_cube_evaluation;
  return {};
}

std::span<const Mutant> evaluated_tilts(Arithmetic arithmetic, Program program) {
  return evaluated_taper(arithmetic, program).empty() ? std::span<const Mutant>() : std::span<const Mutant>(tilts);
}

std::span<const Mutant> proposals(Arithmetic arithmetic, Program program) {
  if (program == Program::pairs && arithmetic != Arithmetic::usual && arithmetic != Arithmetic::poor_search)
    return common_point;
  if (program == Program::tapered_cubes && arithmetic != Arithmetic::poor_search) return {};
  if (arithmetic == Arithmetic::evaluated) return evaluation;
  if (arithmetic != Arithmetic::poor_search) return {};
  switch (program) {
    case Program::points: return search;
    case Program::triangles: return weights;
    case Program::solids:
    case Program::tapered_solids:
    case Program::bent_depths: return bent_proposals;
    case Program::set_bounds: return edge_proposals;
    case Program::tapered_points: return tapered_search;
    case Program::tapered_cubes: return tapered_cube_search;
    case Program::pairs: break;
  }
  return closest_points;
}

constexpr std::array of_points{Arithmetic::usual,          Arithmetic::loose_below, Arithmetic::loose_above,
                               Arithmetic::loose_products, Arithmetic::loose_dot,   Arithmetic::evaluated,
                               Arithmetic::poor_search};
constexpr std::array of_tapered_points{Arithmetic::usual,   Arithmetic::loose_below, Arithmetic::loose_above,
                                       Arithmetic::erratic, Arithmetic::evaluated,   Arithmetic::poor_search};
constexpr std::array of_tapered_cubes{Arithmetic::usual,      Arithmetic::loose_below, Arithmetic::loose_above,
                                      Arithmetic::erratic,    Arithmetic::evaluated,   Arithmetic::displaced,
                                      Arithmetic::poor_search};
constexpr std::array of_convex_sets{Arithmetic::usual,   Arithmetic::loose_below, Arithmetic::loose_above,
                                    Arithmetic::erratic, Arithmetic::displaced,   Arithmetic::poor_search};

}  // namespace

std::span<const Arithmetic> arithmetics(Program program) {
  if (program == Program::points) return of_points;
  if (program == Program::tapered_points) return of_tapered_points;
  if (program == Program::tapered_cubes || program == Program::tapered_solids) return of_tapered_cubes;
  return of_convex_sets;
}

std::string_view name_of(Arithmetic arithmetic) {
  switch (arithmetic) {
    case Arithmetic::usual: return "usual";
    case Arithmetic::loose_below: return "loose below";
    case Arithmetic::loose_above: return "loose above";
    case Arithmetic::loose_products: return "loose products";
    case Arithmetic::loose_dot: return "loose dot";
    case Arithmetic::erratic: return "erratic";
    case Arithmetic::displaced: return "displaced";
    case Arithmetic::evaluated: return "evaluated";
    case Arithmetic::poor_search: break;
  }
  return "poor search";
}

std::string on(Arithmetic arithmetic, Program program, std::string sources) {
  for (const auto& changes :
       {operations(arithmetic), displacement(arithmetic, program), displaced_queries(arithmetic, program),
        proposals(arithmetic, program), poor_multipliers(arithmetic, program), evaluated_tilts(arithmetic, program),
        evaluated_taper(arithmetic, program)})
    sources = changed(std::move(sources), changes);
  return sources;
}

}  // namespace verisq::mutation
