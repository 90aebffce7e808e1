/// Mutants of primitive.clh and tapered_enclosure.clh: bounds of points about tapered primitives.
///
/// Left out, because no enclosure can become false by them:
/// - Changes of tapered_enclosure.clh and of steps: a poor contact proves a poor bound.
/// - Rounding of error bounds themselves (reach times |e|, the sum times MOVED_ERROR, the focus's): of 8 u or 4 u at
///   least one is spare.
/// - L^2: log_gauge bounds N(u) - 1, too. proposal.clh's bound of log g is that of (R S^(p1/p2) + Z - 1) / p1, from
/// which
///   Bernoulli's inequality leads to g - 1 as well.
/// - `usable`, and m below 0: wherever one of the numbers is of no use, m is 0 or negative and the focus, or a NaN,
/// proves
///   something trivial or nothing; both would have to go.
/// - The height's error by its sign: where k is below 0, a height that is 6 u too high moves m by 3 u at most, and with
///   the point's 5 u that stays within MOVED_ERROR.
/// - The guards against NaN in enclosure_at: `tighter`, which starts from infinite ends, takes none.
/// - The second part of the box's height alone: without it points below are as near as the sphere says.

#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array tapered{
    Mutant{"focus on the other side", "q.point.z * q.sign.z + s->focus", "q.point.z * q.sign.z - s->focus"},
    Mutant{"centre for the focus", "q.point.z * q.sign.z + s->focus", "q.point.z * q.sign.z"},
    Mutant{"height without its sign", "q.point.z * q.sign.z + s->focus", "q.point.z + s->focus"},
    Mutant{"height turned back twice", "f.sign.z = REAL(1.0);", ""},
    Mutant{"no error of the solid", "add_up(q.error, REAL(s->taper_error))", "q.error"},
    Mutant{"no error of the pose", "add_up(q.error, REAL(s->taper_error))", "REAL(s->taper_error)"},
    Mutant{"no rounding of the focus", "add_up(add_up(q.error, REAL(s->taper_error)), rounding)",
           "add_up(q.error, REAL(s->taper_error))"},
    Mutant{"half the rounding of the focus", "mul_up(fabs(f.point.z), REAL(0x1p-53))",
           "mul_up(fabs(0.5 * f.point.z), REAL(0x1p-53))"},
    Mutant{"rounding of the focus by its sign", "mul_up(fabs(f.point.z), ", "mul_up(f.point.z, "},

    Mutant{"normal not tilted", "const real tilt = support * k / a3;", "const real tilt = 0.0 * (support * k / a3);"},
    Mutant{"normal tilted the other way", "const real tilt = support * k / a3;",
           "const real tilt = -(support * k / a3);"},
    Mutant{"tilt without the height", "support * k / a3", "support * k"},
    Mutant{"tilt without the support", "support * k / a3", "k / a3"},
    Mutant{"no error of the tilt", "fma_up(REAL(s->fall_up), support, mul_up(reach, off))",
           "mul_up(REAL(s->fall_up), support)", Arithmetic::evaluated},
    Mutant{"a quarter of the tilt's error", "REAL(TILT_ERROR)", "REAL(0.25 * TILT_ERROR)", Arithmetic::evaluated},
    Mutant{"tilt's error without the normal", "add_up(n.z, fabs(tilt))", "fabs(tilt)", Arithmetic::evaluated},
    Mutant{"tilt's error without the tilt", "add_up(n.z, fabs(tilt))", "n.z", Arithmetic::evaluated},
    Mutant{"tilt's error by its sign", "add_up(n.z, fabs(tilt))", "add_up(n.z, tilt)", Arithmetic::evaluated},
    Mutant{"tilt's error without its reach", "mul_up(add_up(REAL(1.0), fabs(k)), REAL(a3))", "REAL(a3)",
           Arithmetic::evaluated},
    Mutant{"reach of the tilt by its sign", "mul_up(add_up(REAL(1.0), fabs(k)), REAL(a3))",
           "mul_up(add_up(REAL(1.0), k), REAL(a3))", Arithmetic::evaluated},
    Mutant{"reach of the tilt without the height", "mul_up(add_up(REAL(1.0), fabs(k)), REAL(a3))",
           "add_up(REAL(1.0), fabs(k))", Arithmetic::evaluated},
    Mutant{"support by 1 - k^2 from below", "fma_up(REAL(s->fall_up), support", "fma_up(REAL(s->fall_down), support"},
    Mutant{"support rounded down", "t.support = fma_up(", "t.support = fma_down(", Arithmetic::loose_below},

    Mutant{"support of another normal", "tilted_up(normal_of_contact(c), bounds.support, k, s)",
           "tilted_up(normal_of_contact(c), REAL(1.0), k, s)"},
    Mutant{"support with the other side's taper", "tilted_up(normal_of_contact(c), bounds.support, k, s)",
           "tilted_up(normal_of_contact(c), bounds.support, -k, s)"},
    Mutant{"point as if it were on the surface",
           "fma_up(bounds.log_gauge, bounds.log_gauge, bounds.log_gauge); // L + L^2", "REAL(0.0);"},
    Mutant{"height without the taper", "const real height = k * c.point.z / s->semi_axes[2];",
           "const real height = 0.0 * (k * c.point.z / s->semi_axes[2]);"},
    Mutant{"height with the other side's taper", "= k * c.point.z / s->semi_axes[2];",
           "= -k * c.point.z / s->semi_axes[2];"},
    Mutant{"height in no unit", "= k * c.point.z / s->semi_axes[2];", "= k * c.point.z;"},
    Mutant{"height as computed", "fma_down(REAL(-HEIGHT_ERROR), fabs(height), height)", "height",
           Arithmetic::evaluated},
    Mutant{"half of the height's error", "fma_down(REAL(-HEIGHT_ERROR)", "fma_down(REAL(-0.5 * HEIGHT_ERROR)",
           Arithmetic::evaluated},
    Mutant{"height rounded up", "fma_down(REAL(-HEIGHT_ERROR)", "fma_up(REAL(-HEIGHT_ERROR)", Arithmetic::erratic},
    Mutant{"1 + L rounded down", "sub_up(add_up(REAL(1.0), excess), height_down)",
           "sub_up(add_down(REAL(1.0), excess), height_down)", Arithmetic::erratic},
    Mutant{"stretch rounded down", "sub_up(add_up(REAL(1.0), excess), height_down)",
           "sub_down(add_up(REAL(1.0), excess), height_down)", Arithmetic::erratic},
    Mutant{"scale rounded up", "div_down(REAL(s->fall_down), stretch)", "div_up(REAL(s->fall_down), stretch)",
           Arithmetic::erratic},
    Mutant{"scale by 1 - k^2 from above", "div_down(REAL(s->fall_down), stretch)",
           "div_down(REAL(s->fall_up), stretch)"},
    Mutant{"scale without 1 - k^2", "div_down(REAL(s->fall_down), stretch)", "div_down(REAL(1.0), stretch)"},
    Mutant{"point not scaled", "const vector3 b = {m * c.point.x, m * c.point.y, m * c.point.z};",
           "const vector3 b = c.point;"},
    Mutant{"apart on one side", "fmax(sub_up(a, b), sub_up(b, a))", "sub_up(a, b)", Arithmetic::erratic},
    Mutant{"apart where q is beyond", "fmax(sub_up(a, b), sub_up(b, a))", "fmax(sub_up(a, b), REAL(0.0))"},
    Mutant{"apart rounded down", "fmax(sub_up(a, b), sub_up(b, a))", "fmax(sub_down(a, b), sub_down(b, a))",
           Arithmetic::erratic},
    Mutant{"apart without y", "apart_up(q.y, b.y)", "REAL(0.0)"},
    Mutant{"apart without z", "apart_up(q.z, b.z)", "REAL(0.0)"},
    Mutant{"point as computed", "add_up(length_up(apart), rounding)", "length_up(apart)", Arithmetic::evaluated},
    Mutant{"a quarter of the point's error", "REAL(MOVED_ERROR)", "REAL(0.25 * MOVED_ERROR)", Arithmetic::evaluated},
    Mutant{"point's error without x", "add_up(b.x, add_up(b.y, b.z))", "add_up(b.y, b.z)", Arithmetic::evaluated},
    Mutant{"point's error without z", "add_up(b.x, add_up(b.y, b.z))", "add_up(b.x, b.y)", Arithmetic::evaluated},
    Mutant{"distance rounded down", "add_up(length_up(apart), rounding)", "add_down(length_up(apart), rounding)",
           Arithmetic::erratic},
    Mutant{"length rounded down", "add_up(length_up(apart), rounding)", "add_up(length_down(apart), rounding)",
           Arithmetic::erratic},
    Mutant{"normal as it was before the tilt", "select(REAL(INFINITY), hi, usable), tilted.normal}",
           "select(REAL(INFINITY), hi, usable), normal_of_contact(c)}"},

    Mutant{"higher lower end with the other's normal", "select_vector(a.normal, b.normal, b_higher)", "a.normal"},
    Mutant{"upper end where the other has its lower one", "select(a.hi, b.hi, b_lower)", "select(a.hi, b.lo, b_lower)"},
    Mutant{"query not on its side", "const vector3 point = reflected(q.point, side);",
           "const vector3 point = q.point;"},
    Mutant{"taper of the other side", "const real k = side * s->taper;", "const real k = REAL(s->taper);"},
    Mutant{"no error below", "sub_down(proven.lo, q.error)", "proven.lo"},
    Mutant{"no error above", "add_up(proven.hi, q.error)", "proven.hi"},
    Mutant{"error below with the wrong sign", "sub_down(proven.lo, q.error)", "add_up(proven.lo, q.error)"},
    Mutant{"normal not on its side", "out_of_octant(reflected(proven.normal, side), q.sign)",
           "out_of_octant(proven.normal, q.sign)"},
    Mutant{"normal in its octant", "out_of_octant(reflected(proven.normal, side), q.sign)",
           "reflected(proven.normal, side)"},

    Mutant{"sphere with the wrong sign", "sub_down(length_down(q.point), REAL(s->reach_up))",
           "add_down(length_down(q.point), REAL(s->reach_up))"},
    Mutant{"sphere inside the solid", "sub_down(length_down(q.point), REAL(s->reach_up))",
           "sub_down(length_down(q.point), REAL(s->inradius_down))"},
    Mutant{"sphere's length rounded up", "sub_down(length_down(q.point), REAL(s->reach_up))",
           "sub_down(length_up(q.point), REAL(s->reach_up))", Arithmetic::loose_above},
    Mutant{"sphere's bound rounded up", "sub_down(length_down(q.point), REAL(s->reach_up))",
           "sub_up(length_down(q.point), REAL(s->reach_up))", Arithmetic::loose_above},
    Mutant{"box as wide as the middle, x", "mul_up(widening, REAL(s->semi_axes[0]))", "REAL(s->semi_axes[0])"},
    Mutant{"box as wide as the middle, y", "mul_up(widening, REAL(s->semi_axes[1]))", "REAL(s->semi_axes[1])"},
    Mutant{"box by another axis", "mul_up(widening, REAL(s->semi_axes[1]))", "mul_up(widening, REAL(s->semi_axes[0]))"},
    Mutant{"box as wide as the upper end", "add_up(REAL(1.0), fabs(REAL(s->taper)))",
           "add_up(REAL(1.0), REAL(s->taper))"},
    Mutant{"widening rounded down", "add_up(REAL(1.0), fabs(REAL(s->taper)))",
           "add_down(REAL(1.0), fabs(REAL(s->taper)))", Arithmetic::loose_below},
    Mutant{"box's width rounded down", "mul_up(widening, REAL(s->semi_axes[0]))",
           "mul_down(widening, REAL(s->semi_axes[0]))", Arithmetic::loose_below},
    Mutant{"upper end about the centre", "add_up(REAL(1.0), REAL(s->taper))", "REAL(1.0)"},
    Mutant{"lower end about the centre", "sub_up(REAL(1.0), REAL(s->taper))", "REAL(1.0)"},
    Mutant{"upper end rounded down", "mul_up(add_up(REAL(1.0), REAL(s->taper)), REAL(a3))",
           "mul_down(add_up(REAL(1.0), REAL(s->taper)), REAL(a3))", Arithmetic::loose_below},
    Mutant{"lower end rounded down", "mul_up(sub_up(REAL(1.0), REAL(s->taper)), REAL(a3))",
           "mul_down(sub_up(REAL(1.0), REAL(s->taper)), REAL(a3))", Arithmetic::loose_below},
    Mutant{"1 + k rounded down", "mul_up(add_up(REAL(1.0), REAL(s->taper)), REAL(a3))",
           "mul_up(add_down(REAL(1.0), REAL(s->taper)), REAL(a3))", Arithmetic::loose_below},
    Mutant{"1 - k rounded down", "mul_up(sub_up(REAL(1.0), REAL(s->taper)), REAL(a3))",
           "mul_up(sub_down(REAL(1.0), REAL(s->taper)), REAL(a3))", Arithmetic::loose_below},
    Mutant{"distance from the box's far side", "positive_part(sub_down(q.point.z, above))",
           "fabs(sub_down(q.point.z, above))"},
    Mutant{"normal below leads up", "- positive_part(sub_down(-q.point.z, below))",
           "+ positive_part(sub_down(-q.point.z, below))"},
    Mutant{"box's difference rounded up", "sub_down(q.point.z, above)", "sub_up(q.point.z, above)",
           Arithmetic::loose_above},
    Mutant{"box's length rounded up", "const real box = length_down(v);", "const real box = length_up(v);",
           Arithmetic::loose_above},
    Mutant{"box of a point within it", "MASK(box > sphere) & MASK(box > 0.0)", "MASK(box > sphere)"},
    Mutant{"no error from afar", "sub_down(select(sphere, box, by_box), q.error)", "select(sphere, box, by_box)"},
    Mutant{"sphere's normal for the box", "select_vector(q.point, v, by_box)", "q.point"},
    Mutant{"box's normal for the sphere", "select_vector(q.point, v, by_box)", "v"},
};

}  // namespace

std::span<const Mutant> tapered_mutants() {
  return tapered;
}

}  // namespace verisq::mutation
