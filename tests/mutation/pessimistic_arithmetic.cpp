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

constexpr std::array search{
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

std::span<const Mutant> displacement(Arithmetic arithmetic, Program program) {
  const bool with_points = arithmetic == Arithmetic::loose_below || arithmetic == Arithmetic::loose_above;
  if (arithmetic != Arithmetic::displaced && !(program == Program::points && with_points)) return {};
  if (program == Program::pairs) return placement;
  return pose;
}

std::span<const Mutant> proposals(Arithmetic arithmetic, Program program) {
  if (program == Program::pairs && arithmetic != Arithmetic::usual && arithmetic != Arithmetic::poor_search)
    return common_point;
  if (arithmetic != Arithmetic::poor_search) return {};
  switch (program) {
    case Program::points: return search;
    case Program::triangles: return weights;
    case Program::pairs: break;
  }
  return closest_points;
}

constexpr std::array of_points{Arithmetic::usual,          Arithmetic::loose_below, Arithmetic::loose_above,
                               Arithmetic::loose_products, Arithmetic::loose_dot,   Arithmetic::poor_search};
constexpr std::array of_convex_sets{Arithmetic::usual,   Arithmetic::loose_below, Arithmetic::loose_above,
                                    Arithmetic::erratic, Arithmetic::displaced,   Arithmetic::poor_search};

}  // namespace

std::span<const Arithmetic> arithmetics(Program program) {
  if (program == Program::points) return of_points;
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
    case Arithmetic::poor_search: break;
  }
  return "poor search";
}

std::string on(Arithmetic arithmetic, Program program, std::string sources) {
  for (const auto& changes :
       {operations(arithmetic), displacement(arithmetic, program), proposals(arithmetic, program)})
    sources = changed(std::move(sources), changes);
  return sources;
}

}  // namespace verisq::mutation
