/// The table of mutants of pair_distance.cl.
///
/// Left out, because no enclosure can become false by them:
/// - Changes of what is only proposed: pair_distance.cl and the points near which the upper end is sought.
/// - Half of PAIR_ROTATION_ERROR or VECTOR_ERROR, and roundings of error bounds: the constants are bounds from before
///   any computation, their proofs stand beside them, and rounding errors that come near them are not found.
/// - The least error of a centre, 2^-1000: the bound of the rotation has more room than that.
/// - Vectors below 2^-500 allowed: length_up is at least 2^-511 for all of them, against which the underflow of
///   products, 2^-1074, is less than the room in the bound of the rotation.
/// - point_in_solid with a negative scale: a negative product becomes 0 afterwards; with products below 0: they are no
///   less than -2^-1022, which the error of the centre covers.
/// - NaN as an upper end: fmin drops it. Lower ends below 0, and upper ends that forget those of earlier pairs.
/// - A pair passed over too early or too late by spheres that hold.
///
/// Three that would be wrong are left out because no scene found them out yet; they are errors of a few units in the
/// last place where a pessimistic input has to meet a surface to within as much: a common point without VECTOR_ERROR, a
/// common point whose gauge rises by error / circumradius, and radii of spheres added downward.

#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array mutants{
    Mutant{"no error of the rotation", "PAIR_ROTATION_ERROR 0x1.4p-48", "PAIR_ROTATION_ERROR 0.0",
           Arithmetic::displaced},
    Mutant{"no error of vectors", "VECTOR_ERROR 0x1.8p-51", "VECTOR_ERROR 0.0", Arithmetic::displaced},
    Mutant{"norm without z", "add_up(fabs(a.x), add_up(fabs(a.y), fabs(a.z)))", "add_up(fabs(a.x), fabs(a.y))",
           Arithmetic::displaced},
    Mutant{"norm without x", "add_up(fabs(a.x), add_up(fabs(a.y), fabs(a.z)))", "add_up(fabs(a.y), fabs(a.z))",
           Arithmetic::displaced},
    Mutant{"rotation of B transposed", "transposed(rotation_to_local(solid_b))", "rotation_to_local(solid_b)"},
    Mutant{"pose's rotation transposed", "product(moved, transposed(", "product(transposed(moved), transposed("},
    Mutant{"centre of B not moved", "matrix_times(moved, centre_b)", "centre_b"},
    Mutant{"no shift", "vector_sum(rotated, shift)", "rotated"},
    Mutant{"centre of A added", "vector_difference(shifted, translation_of(solid_a))",
           "vector_sum(shifted, translation_of(solid_a))"},
    Mutant{"centre's error without B's centre", "add_up(norm1_up(centre_b), norm1_up(shifted))", "norm1_up(shifted)",
           Arithmetic::displaced},
    Mutant{"centre's error without the shift", "add_up(norm1_up(centre_b), norm1_up(shifted))", "norm1_up(centre_b)",
           Arithmetic::displaced},
    Mutant{"centre's error without one operation", "add_up(norm1_up(apart), norm1_up(apart))", "norm1_up(apart)",
           Arithmetic::displaced},
    Mutant{"no error of the centre", "fma_up(REAL(VECTOR_ERROR), sizes, REAL(0x1p-1000))", "REAL(0x1p-1000)",
           Arithmetic::displaced},

    Mutant{"v in B's frame by the wrong rotation", "v_of_b = transposed_times(p.pose.rotation, v)",
           "v_of_b = matrix_times(p.pose.rotation, v)"},
    Mutant{"v in A's frame for B", "support_up(magnitudes(v_of_b), solid_b)", "support_up(magnitudes(v), solid_b)"},
    Mutant{"supports added downward", "add_up(support_up(magnitudes(v), solid_a)",
           "add_down(support_up(magnitudes(v), solid_a)", Arithmetic::loose_below},
    Mutant{"no support of A", "add_up(support_up(magnitudes(v), solid_a), support_up(magnitudes(v_of_b), solid_b))",
           "support_up(magnitudes(v_of_b), solid_b)"},
    Mutant{"no support of B", "add_up(support_up(magnitudes(v), solid_a), support_up(magnitudes(v_of_b), solid_b))",
           "support_up(magnitudes(v), solid_a)"},
    Mutant{"support of A by signed v", "support_up(magnitudes(v), solid_a)", "support_up(v, solid_a)"},
    Mutant{"support of B by signed v", "support_up(magnitudes(v_of_b), solid_b)", "support_up(v_of_b, solid_b)"},
    Mutant{"v.c rounded up", "dot_down(v, p.pose.centre)", "dot_up(v, p.pose.centre)", Arithmetic::erratic},
    Mutant{"numerator rounded up", "sub_down(dot_down(v, p.pose.centre), supports)",
           "sub_up(dot_down(v, p.pose.centre), supports)", Arithmetic::erratic},
    Mutant{"length of v rounded down", "const real length = length_up(magnitudes(v));",
           "const real length = length_down(magnitudes(v));", Arithmetic::erratic},
    Mutant{"quotient rounded up", "div_down(numerator, length)", "div_up(numerator, length)", Arithmetic::erratic},
    Mutant{"lower end without the rotation's error",
           "fma_up(REAL(PAIR_ROTATION_ERROR), REAL(solid_b->circumradius_up), p.centre_error);\n  // The errors of",
           "p.centre_error;\n  // The errors of", Arithmetic::displaced},
    Mutant{"lower end without the centre's error",
           "REAL(solid_b->circumradius_up), p.centre_error);\n  // The errors of",
           "REAL(solid_b->circumradius_up), REAL(0.0));\n  // The errors of", Arithmetic::displaced},
    Mutant{"lower end by the inradius", "REAL(solid_b->circumradius_up), p.centre_error);\n  // The errors of",
           "REAL(solid_b->inradius_down), p.centre_error);\n  // The errors of", Arithmetic::displaced},
    Mutant{"lower end by the radius of A", "REAL(solid_b->circumradius_up), p.centre_error);\n  // The errors of",
           "REAL(solid_a->circumradius_up), p.centre_error);\n  // The errors of", Arithmetic::displaced},
    Mutant{"lower end without an error", "fmax(sub_down(bound, error), REAL(0.0))", "fmax(bound, REAL(0.0))",
           Arithmetic::displaced},
    Mutant{"lower end, error with the wrong sign", "fmax(sub_down(bound, error), REAL(0.0))",
           "fmax(add_down(bound, error), REAL(0.0))", Arithmetic::displaced},
    Mutant{"lower end, error subtracted upward", "fmax(sub_down(bound, error), REAL(0.0))",
           "fmax(sub_up(bound, error), REAL(0.0))", Arithmetic::erratic},
    Mutant{"NaN below", "fmax(sub_down(bound, error), REAL(0.0))", "sub_down(bound, error)"},

    Mutant{"point of a solid, scale rounded up", "sub_down(REAL(1.0), log_gauge_up(size, s))",
           "sub_up(REAL(1.0), log_gauge_up(size, s))", Arithmetic::erratic},
    Mutant{"point of a solid outside", "sub_down(REAL(1.0), log_gauge_up(size, s))", "REAL(1.0)",
           Arithmetic::poor_search},
    Mutant{"point of a solid, x rounded up", "mul_down(size.x, scale)", "mul_up(size.x, scale)", Arithmetic::erratic},
    Mutant{"point of a solid, y rounded up", "mul_down(size.y, scale)", "mul_up(size.y, scale)", Arithmetic::erratic},
    Mutant{"point of a solid, z rounded up", "mul_down(size.z, scale)", "mul_up(size.z, scale)", Arithmetic::erratic},
    Mutant{"point of a solid, gauge by signed x", "sub_down(REAL(1.0), log_gauge_up(size, s))",
           "sub_down(REAL(1.0), log_gauge_up(x, s))", Arithmetic::poor_search},

    Mutant{"point of A as it is", "const vector3 a = point_in_solid(near_a, solid_a);", "const vector3 a = near_a;",
           Arithmetic::poor_search},
    Mutant{"point of B as it is", "matrix_times(p.pose.rotation, point_in_solid(near_b, solid_b))",
           "matrix_times(p.pose.rotation, near_b)", Arithmetic::poor_search},
    Mutant{"point of B in A", "point_in_solid(near_b, solid_b)", "point_in_solid(near_b, solid_a)",
           Arithmetic::poor_search},
    Mutant{"difference of x rounded down",
           "greatest_or_nan(sub_up(add_up(b.x, c.x), a.x), sub_up(a.x, add_down(b.x, c.x)))",
           "fmax(sub_down(add_up(b.x, c.x), a.x), sub_down(a.x, add_down(b.x, c.x)))", Arithmetic::erratic},
    Mutant{"difference of x, upper sum rounded down", "sub_up(add_up(b.x, c.x), a.x)",
           "sub_up(add_down(b.x, c.x), a.x)", Arithmetic::erratic},
    Mutant{"difference of x, lower sum rounded up", "sub_up(a.x, add_down(b.x, c.x))", "sub_up(a.x, add_up(b.x, c.x))",
           Arithmetic::erratic},
    Mutant{"difference of y one way round",
           "greatest_or_nan(sub_up(add_up(b.y, c.y), a.y), sub_up(a.y, add_down(b.y, c.y)))",
           "sub_up(add_up(b.y, c.y), a.y)", Arithmetic::erratic},
    Mutant{"difference of y the other way round",
           "greatest_or_nan(sub_up(add_up(b.y, c.y), a.y), sub_up(a.y, add_down(b.y, c.y)))",
           "sub_up(a.y, add_down(b.y, c.y))", Arithmetic::erratic},
    Mutant{"lesser difference of z", "greatest_or_nan(sub_up(add_up(b.z, c.z), a.z), sub_up(a.z, add_down(b.z, c.z)))",
           "fmin(fabs(sub_up(add_up(b.z, c.z), a.z)), fabs(sub_up(a.z, add_down(b.z, c.z))))", Arithmetic::erratic},
    Mutant{"difference without z", "greatest_or_nan(sub_up(add_up(b.z, c.z), a.z), sub_up(a.z, add_down(b.z, c.z)))",
           "REAL(0.0)"},
    Mutant{"upper end without the rotation's error",
           "fma_up(REAL(PAIR_ROTATION_ERROR), REAL(solid_b->circumradius_up), p.centre_error);\n  return",
           "p.centre_error;\n  return", Arithmetic::displaced},
    Mutant{"upper end without the centre's error", "REAL(solid_b->circumradius_up), p.centre_error);\n  return",
           "REAL(solid_b->circumradius_up), REAL(0.0));\n  return", Arithmetic::displaced},
    Mutant{"upper end by the inradius", "REAL(solid_b->circumradius_up), p.centre_error);\n  return",
           "REAL(solid_b->inradius_down), p.centre_error);\n  return", Arithmetic::displaced},
    Mutant{"upper end by the radius of A", "REAL(solid_b->circumradius_up), p.centre_error);\n  return",
           "REAL(solid_a->circumradius_up), p.centre_error);\n  return", Arithmetic::displaced},
    Mutant{"upper end without an error", "return add_up(length_up(apart), error);", "return length_up(apart);",
           Arithmetic::displaced},
    Mutant{"upper end, error with the wrong sign", "return add_up(length_up(apart), error);",
           "return sub_up(length_up(apart), error);", Arithmetic::displaced},
    Mutant{"upper end, error added downward", "return add_up(length_up(apart), error);",
           "return add_down(length_up(apart), error);", Arithmetic::erratic},
    Mutant{"upper end, length rounded down", "return add_up(length_up(apart), error);",
           "return add_up(length_down(apart), error);", Arithmetic::erratic},

    Mutant{"common point, no error of the rotation", "REAL(PAIR_ROTATION_ERROR + VECTOR_ERROR)", "REAL(VECTOR_ERROR)",
           Arithmetic::displaced},
    Mutant{"common point, no error of the centre",
           "fma_up(REAL(PAIR_ROTATION_ERROR + VECTOR_ERROR), size, p.centre_error)",
           "mul_up(REAL(PAIR_ROTATION_ERROR + VECTOR_ERROR), size)", Arithmetic::displaced},
    Mutant{"common point, gauge of A rounded down", "gauge_a = exp_up(", "gauge_a = exp_down(",
           Arithmetic::loose_below},
    Mutant{"common point, gauge of B rounded down", "gauge_b = add_up(exp_up(", "gauge_b = add_up(exp_down(",
           Arithmetic::loose_below},
    Mutant{"common point, sum rounded down", "gauge_b = add_up(", "gauge_b = add_down(", Arithmetic::loose_below},
    Mutant{"common point, no error", "div_up(error, REAL(solid_b->inradius_down))", "REAL(0.0)", Arithmetic::displaced},
    Mutant{"common point by the inradius of A", "div_up(error, REAL(solid_b->inradius_down))",
           "div_up(error, REAL(solid_a->inradius_down))", Arithmetic::displaced},
    Mutant{"common point outside A up to a margin", "MASK(gauge_a <= 1.0)", "MASK(gauge_a <= 1.0 + 0x1p-20)",
           Arithmetic::loose_below},
    Mutant{"common point outside B up to a margin", "MASK(gauge_b <= 1.0)", "MASK(gauge_b <= 1.0 + 0x1p-20)",
           Arithmetic::loose_below},
    Mutant{"common point of either", "MASK(gauge_a <= 1.0) & MASK(gauge_b <= 1.0)",
           "MASK(gauge_a <= 1.0) | MASK(gauge_b <= 1.0)", Arithmetic::loose_below},
    Mutant{"common point of A alone", "return MASK(gauge_a <= 1.0) & MASK(gauge_b <= 1.0);",
           "return MASK(gauge_a <= 1.0);", Arithmetic::loose_below},
    Mutant{"common point of B alone", "return MASK(gauge_a <= 1.0) & MASK(gauge_b <= 1.0);",
           "return MASK(gauge_b <= 1.0);", Arithmetic::loose_below},
    Mutant{"common point in A's frame for B", "log_gauge_up(magnitudes(m_of_b), solid_b)",
           "log_gauge_up(magnitudes(m), solid_b)", Arithmetic::loose_below},

    Mutant{"spheres, no radius of A", "add_up(REAL(solid_a->circumradius_up), REAL(solid_b->circumradius_up))",
           "REAL(solid_b->circumradius_up)"},
    Mutant{"spheres, no radius of B", "add_up(REAL(solid_a->circumradius_up), REAL(solid_b->circumradius_up))",
           "REAL(solid_a->circumradius_up)"},
    Mutant{"spheres inside the solids", "add_up(REAL(solid_a->circumradius_up), REAL(solid_b->circumradius_up))",
           "add_up(REAL(solid_a->inradius_down), REAL(solid_b->inradius_down))"},
    Mutant{"spheres, distance rounded up", "length_down(magnitudes(p.pose.centre))",
           "length_up(magnitudes(p.pose.centre))", Arithmetic::erratic},
    Mutant{"spheres, difference rounded up", "sub_down(length_down(magnitudes(p.pose.centre)), radii)",
           "sub_up(length_down(magnitudes(p.pose.centre)), radii)", Arithmetic::erratic},
    Mutant{"spheres, error subtracted upward", "between_spheres = sub_down(sub_down(",
           "between_spheres = sub_up(sub_down(", Arithmetic::erratic},
    Mutant{"spheres without the centre's error",
           "sub_down(sub_down(length_down(magnitudes(p.pose.centre)), radii), p.centre_error)",
           "sub_down(length_down(magnitudes(p.pose.centre)), radii)", Arithmetic::displaced},
    Mutant{"spheres' distance for all pairs'", "STORE(fmin(known_lo, between_spheres), group, los);",
           "STORE(between_spheres, group, los);"},
    Mutant{"greatest lower end", "STORE(fmin(known_lo, lo), group, los);",
           "STORE(first ? lo : fmax(known_lo, lo), group, los);"},
    Mutant{"lower end of the last pair", "STORE(fmin(known_lo, lo), group, los);", "STORE(lo, group, los);"},
    Mutant{"lower end of the first pair", "STORE(fmin(known_lo, lo), group, los);",
           "STORE(first ? lo : known_lo, group, los);"},
};

}  // namespace

std::span<const Mutant> pair_mutants() {
  return mutants;
}

}  // namespace verisq::mutation
