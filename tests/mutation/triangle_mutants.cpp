/// The table of mutants of triangle_distance.cl, and of what no kernel of points uses of arithmetic.clh.
///
/// Left out, because tests/kernels/kernel_arithmetic_test.cpp finds it: a NaN that is forgotten.
///
/// Left out, because no enclosure can become false by them:
/// - Changes of what is only proposed: triangle_distance.cl, distance_gradient.clh, orthogonal_to_contact.
/// - `closest` with negative coordinates: the gauge takes them for 0, and farther away they only raise the bound.
/// - The weight 1 lowered where the other is 0, and lower ends below 0.
/// - Roundings of an error bound itself: the constants have more room than they take.
/// - A primitive passed over too early by a sphere that holds, or too late; a union's upper end from a farther
///   primitive; anything but an upper end that is too low in `nearest`.

#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array mutants{
    // arithmetic.clh
    Mutant{"least_or_nan takes the greater", "select(b, a, MASK(a < b) | MASK(a != a))",
           "select(b, a, MASK(a > b) | MASK(a != a))"},
    Mutant{"greatest_or_nan takes the lesser", "select(b, a, MASK(a > b) | MASK(a != a))",
           "select(b, a, MASK(a < b) | MASK(a != a))"},

    // triangle_distance.cl
    Mutant{"no error of the corners", "t.error = greatest_or_nan(t.error, q.error);", "", Arithmetic::displaced},
    Mutant{"error of the last corner", "t.error = greatest_or_nan(t.error, q.error);", "t.error = q.error;",
           Arithmetic::displaced},
    Mutant{"least error of the corners", "t.error = greatest_or_nan(t.error, q.error);",
           "t.error = k == 0 ? q.error : fmin(t.error, q.error);", Arithmetic::displaced},
    Mutant{"corners without signs", "out_of_octant(q.point, q.sign);\n    t.error", "q.point;\n    t.error"},
    Mutant{"y of corners for z", "LOAD(group, corners + (3 * k + 2) * stride)",
           "LOAD(group, corners + (3 * k + 1) * stride)"},

    Mutant{
        "sphere, edge rounded down",
        "{greatest_or_nan(sub_up(a.x, b.x), sub_up(b.x, a.x)),\n                          greatest_or_nan(sub_up(a.y, "
        "b.y), sub_up(b.y, a.y)),\n                          greatest_or_nan(sub_up(a.z, b.z), sub_up(b.z, a.z))}",
        "{fmax(sub_down(a.x, b.x), sub_down(b.x, a.x)), fmax(sub_down(a.y, b.y), sub_down(b.y, a.y)), "
        "fmax(sub_down(a.z, b.z), sub_down(b.z, a.z))}",
        Arithmetic::erratic},
    Mutant{"sphere, edge without a sign",
           "{greatest_or_nan(sub_up(a.x, b.x), sub_up(b.x, a.x)),\n                          "
           "greatest_or_nan(sub_up(a.y, b.y), sub_up(b.y, a.y)),",
           "{sub_up(a.x, b.x), sub_up(a.y, b.y),", Arithmetic::erratic},
    Mutant{"sphere, lesser of the differences", "greatest_or_nan(sub_up(a.x, b.x), sub_up(b.x, a.x))",
           "fmin(fabs(sub_up(a.x, b.x)), fabs(sub_up(b.x, a.x)))", Arithmetic::erratic},
    Mutant{"sphere, edge without z", "greatest_or_nan(sub_up(a.z, b.z), sub_up(b.z, a.z))}", "REAL(0.0)}"},
    Mutant{"sphere, shorter edge", "reach = greatest_or_nan(reach, length_up(edge));",
           "reach = k == 1 ? length_up(edge) : fmin(reach, length_up(edge));"},
    Mutant{"sphere without the third corner", "for (int k = 1; k < 3; ++k) {", "for (int k = 1; k < 2; ++k) {"},
    Mutant{"sphere without the second corner", "for (int k = 1; k < 3; ++k) {", "for (int k = 2; k < 3; ++k) {"},
    Mutant{"sphere, edge's length rounded down", "reach = greatest_or_nan(reach, length_up(edge));",
           "reach = fmax(reach, length_down(edge));", Arithmetic::erratic},
    Mutant{"sphere, distance from the centre rounded up", "length_down(magnitudes(t.corners[0]))",
           "length_up(magnitudes(t.corners[0]))", Arithmetic::erratic},
    Mutant{"sphere, first difference rounded up", "sub_down(from_centre, reach)", "sub_up(from_centre, reach)",
           Arithmetic::erratic},
    Mutant{"sphere, second difference rounded up", "return sub_down(sub_down(sub_down(",
           "return sub_down(sub_up(sub_down(", Arithmetic::erratic},
    Mutant{"sphere, last difference rounded up", "return sub_down(sub_down(sub_down(",
           "return sub_up(sub_down(sub_down(", Arithmetic::erratic},
    Mutant{"sphere inside the solid", "REAL(s->circumradius_up)), t.error)", "REAL(s->inradius_down)), t.error)"},
    Mutant{"sphere with the wrong sign", "sub_down(sub_down(from_centre, reach), REAL(s->circumradius_up))",
           "add_down(sub_down(from_centre, reach), REAL(s->circumradius_up))"},
    Mutant{"sphere without the edges", "sub_down(from_centre, reach)", "from_centre"},
    Mutant{"sphere without the corners' error",
           "sub_down(sub_down(sub_down(from_centre, reach), REAL(s->circumradius_up)), t.error)",
           "sub_down(sub_down(from_centre, reach), REAL(s->circumradius_up))", Arithmetic::displaced},

    Mutant{"v.t of corner 0 rounded up", "dot_down(v, t.corners[0])", "dot_up(v, t.corners[0])", Arithmetic::erratic},
    Mutant{"v.t of corner 1 rounded up", "dot_down(v, t.corners[1])", "dot_up(v, t.corners[1])", Arithmetic::erratic},
    Mutant{"v.t of corner 2 rounded up", "dot_down(v, t.corners[2])", "dot_up(v, t.corners[2])", Arithmetic::erratic},
    Mutant{
        "lower end without corner 0",
        "least_or_nan(dot_down(v, t.corners[0]), least_or_nan(dot_down(v, t.corners[1]), dot_down(v, t.corners[2])))",
        "fmin(dot_down(v, t.corners[1]), dot_down(v, t.corners[2]))"},
    Mutant{"lower end without corner 1", "least_or_nan(dot_down(v, t.corners[1]), dot_down(v, t.corners[2]))",
           "dot_down(v, t.corners[2])"},
    Mutant{"lower end without corner 2", "least_or_nan(dot_down(v, t.corners[1]), dot_down(v, t.corners[2]))",
           "dot_down(v, t.corners[1])"},
    Mutant{"lower end of the farthest corner", "least_or_nan(dot_down(v, t.corners[0]),",
           "fmax(dot_down(v, t.corners[0]),"},
    Mutant{"lower end of the farther of two corners", "least_or_nan(dot_down(v, t.corners[1]),",
           "fmax(dot_down(v, t.corners[1]),"},
    Mutant{"lower end, support by signed v", "sub_down(nearest_corner, support_up(magnitudes(v), s))",
           "sub_down(nearest_corner, support_up(v, s))"},
    Mutant{"lower end without the solid", "sub_down(nearest_corner, support_up(magnitudes(v), s))", "nearest_corner"},
    Mutant{"lower end, difference rounded up", "sub_down(nearest_corner, support_up",
           "sub_up(nearest_corner, support_up", Arithmetic::erratic},
    Mutant{"lower end, quotient rounded up", "div_down(numerator, length_up(magnitudes(v)))",
           "div_up(numerator, length_up(magnitudes(v)))", Arithmetic::erratic},
    Mutant{"lower end, length rounded down", "div_down(numerator, length_up(magnitudes(v)))",
           "div_down(numerator, length_down(magnitudes(v)))", Arithmetic::erratic},
    Mutant{"lower end without the corners' error", "fmax(sub_down(bound, t.error), REAL(0.0))",
           "fmax(bound, REAL(0.0))", Arithmetic::displaced},
    Mutant{"lower end, error with the wrong sign", "fmax(sub_down(bound, t.error), REAL(0.0))",
           "fmax(add_down(bound, t.error), REAL(0.0))", Arithmetic::displaced},
    Mutant{"lower end, error subtracted upward", "fmax(sub_down(bound, t.error), REAL(0.0))",
           "fmax(sub_up(bound, t.error), REAL(0.0))", Arithmetic::erratic},
    Mutant{"NaN below", "return fmax(sub_down(bound, t.error), REAL(0.0));", "return sub_down(bound, t.error);"},

    Mutant{"weight 2 not clamped", "clamp_unit(w.w2);", "w.w2;", Arithmetic::poor_search},
    Mutant{"weight 1 not clamped", "fmin(clamp_unit(w.w1), largest)", "fmin(w.w1, largest)", Arithmetic::poor_search},
    Mutant{"weights that sum to more than 1", "fmin(clamp_unit(w.w1), largest)", "clamp_unit(w.w1)",
           Arithmetic::poor_search},
    Mutant{"largest weight 1 rounded up", "fmax(sub_down(REAL(1.0), certain.w2), REAL(0.0))",
           "fmax(sub_up(REAL(1.0), certain.w2), REAL(0.0))", Arithmetic::poor_search},
    Mutant{"largest weight 1 below 0", "fmax(sub_down(REAL(1.0), certain.w2), REAL(0.0))",
           "sub_down(REAL(1.0), certain.w2)", Arithmetic::poor_search},
    Mutant{"largest weight 1 always 1", "MASK(certain.w2 == 0.0)", "MASK(certain.w2 <= 1.0)", Arithmetic::poor_search},

    Mutant{"upper end, second edge rounded down", "fma_up(w.w2, sub_up(c2, c0)", "fma_up(w.w2, sub_down(c2, c0)",
           Arithmetic::erratic},
    Mutant{"upper end, first edge rounded down", "fma_up(w.w1, sub_up(c1, c0), c0)",
           "fma_up(w.w1, sub_down(c1, c0), c0)", Arithmetic::erratic},
    Mutant{"upper end, second sum rounded down", "up = fma_up(w.w2,", "up = fma_down(w.w2,", Arithmetic::erratic},
    Mutant{"upper end, first sum rounded down", "fma_up(w.w1, sub_up(c1, c0), c0)",
           "fma_down(w.w1, sub_up(c1, c0), c0)", Arithmetic::erratic},
    Mutant{"lower coordinate, second edge rounded up", "fma_down(w.w2, sub_down(c2, c0)",
           "fma_down(w.w2, sub_up(c2, c0)", Arithmetic::erratic},
    Mutant{"lower coordinate, first edge rounded up", "fma_down(w.w1, sub_down(c1, c0), c0)",
           "fma_down(w.w1, sub_up(c1, c0), c0)", Arithmetic::erratic},
    Mutant{"lower coordinate, second sum rounded up", "down = fma_down(w.w2,", "down = fma_up(w.w2,",
           Arithmetic::erratic},
    Mutant{"lower coordinate, first sum rounded up", "fma_down(w.w1, sub_down(c1, c0), c0)",
           "fma_up(w.w1, sub_down(c1, c0), c0)", Arithmetic::erratic},
    Mutant{"coordinate without negative values", "return greatest_or_nan(up, -down);", "return up;"},
    Mutant{"coordinate without positive values", "return greatest_or_nan(up, -down);", "return -down;"},
    Mutant{"lesser coordinate", "return greatest_or_nan(up, -down);", "return fmin(fabs(up), fabs(down));",
           Arithmetic::erratic},
    Mutant{"weights exchanged in the coordinates", "fma_up(w.w2, sub_up(c2, c0), fma_up(w.w1, sub_up(c1, c0), c0))",
           "fma_up(w.w1, sub_up(c2, c0), fma_up(w.w2, sub_up(c1, c0), c0))"},
    Mutant{"z of one corner twice", "t.corners[1].z, t.corners[2].z, w)", "t.corners[1].z, t.corners[1].z, w)"},

    Mutant{"meets, gauge rounded down", "const real gauge = exp_up(log_gauge_up(q, s));",
           "const real gauge = exp_down(log_gauge_up(q, s));", Arithmetic::loose_below},
    Mutant{"meets, sum rounded down", "MASK(add_up(gauge, div_up", "MASK(add_down(gauge, div_up",
           Arithmetic::loose_below},
    Mutant{"meets without the corners' error", "add_up(gauge, div_up(t.error, REAL(s->inradius_down)))", "gauge",
           Arithmetic::displaced},
    Mutant{"meets by the circumradius", "div_up(t.error, REAL(s->inradius_down))",
           "div_up(t.error, REAL(s->circumradius_up))", Arithmetic::displaced},
    Mutant{"meets up to a margin", "REAL(s->inradius_down))) <= 1.0)", "REAL(s->inradius_down))) <= 1.0 + 0x1p-20)"},
    Mutant{"meets without the gauge", "add_up(gauge, div_up(", "add_up(REAL(0.0), div_up("},
    Mutant{"meets where it does not", "REAL(0.0), meets);", "REAL(0.0), ~meets);"},
    Mutant{"upper end without the corners' error", "select(add_up(distance_up(q, closest, s), t.error),",
           "select(distance_up(q, closest, s),", Arithmetic::displaced},
    Mutant{"upper end, error with the wrong sign", "select(add_up(distance_up(q, closest, s), t.error),",
           "select(sub_up(distance_up(q, closest, s), t.error),", Arithmetic::displaced},
    Mutant{"upper end, error added downward", "select(add_up(distance_up(q, closest, s), t.error),",
           "select(add_down(distance_up(q, closest, s), t.error),", Arithmetic::loose_below},
    Mutant{"NaN above", "select(REAL(INFINITY), hi, MASK(hi <= DBL_MAX))", "hi"},
    Mutant{"normal of x and y exchanged", "STORE(v.x, group, normal_xs);\n  STORE(v.y, group, normal_ys);",
           "STORE(v.y, group, normal_xs);\n  STORE(v.x, group, normal_ys);"},
    Mutant{"weights exchanged", "STORE(w.w1, group, weights_1);\n  STORE(w.w2, group, weights_2);",
           "STORE(w.w2, group, weights_1);\n  STORE(w.w1, group, weights_2);"},

    Mutant{"union, greatest lower end", "lo = fmin(lo, LOAD(group, los + i * stride))",
           "lo = i == 0 ? LOAD(group, los) : fmax(lo, LOAD(group, los + i * stride))"},
    Mutant{"union, lower end of the last primitive", "lo = fmin(lo, LOAD(group, los + i * stride))",
           "lo = LOAD(group, los + i * stride)"},
    Mutant{"union, lower end of the first primitive", "lo = fmin(lo, LOAD(group, los + i * stride))",
           "lo = fmin(lo, LOAD(group, los))"},
    Mutant{"union without the first primitive", "for (uint i = 0; i < count; ++i) {",
           "for (uint i = 1; i < count; ++i) {"},
    Mutant{"union without the last primitive", "for (uint i = 0; i < count; ++i) {",
           "for (uint i = 0; i + 1 < count; ++i) {"},
    Mutant{"union, primitives' upper ends overlap", "hi = fmin(hi, LOAD(group, his + i * stride))",
           "hi = fmin(hi, LOAD(group, his + i))"},
    Mutant{"union, lower for upper ends", "hi = fmin(hi, LOAD(group, his + i * stride))",
           "hi = fmin(hi, LOAD(group, los + i * stride) - 0x1p-20)"},
};

}  // namespace

std::span<const Mutant> triangle_mutants() {
  return mutants;
}

}  // namespace verisq::mutation
