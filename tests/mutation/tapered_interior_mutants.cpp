/// Mutants of tapered_interior.clh and of what interior_depth.cl does for it: depths of points in tapered primitives.
///
/// Left out, because no enclosure can become false by them:
/// - Changes of log_interior_gauge, tangent_at, plane_of and first_plane: planes that are proposed prove what they
/// prove.
/// - SMALLEST_ROOM: where S is not above 0, the power is infinite whatever the quotient is.
/// - Which of the two bounds of 1 - k^2 the numerator of the gauge is divided by, for loose constants: seen as such.

#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array interior{
    Mutant{"one side searched", "#define SIDES 2", "#define SIDES 1", Arithmetic::poor_search},
    Mutant{"other side never finished", "SIDES == 1 || own->side < 0.0", "own->side > 0.0", Arithmetic::poor_search},
    Mutant{"other side not begun", "    own->side = -1.0;\n    own->cell = WHOLE_OCTANT;\n", "    own->side = -1.0;\n",
           Arithmetic::poor_search},
    Mutant{"the same side again", "    own->side = -1.0;\n    own->cell = WHOLE_OCTANT;\n",
           "    finish(own, own->target, block);\n", Arithmetic::poor_search},
    Mutant{"directions not on their side", "{direction.x, direction.y, side * direction.z}",
           "{direction.x, direction.y, direction.z}"},
    Mutant{"x rounded down", "{fma_up(reach, w.x, q.x), fma_up(reach, w.y, q.y), fma(reach, w.z, q.z)}",
           "{fma_down(reach, w.x, q.x), fma_up(reach, w.y, q.y), fma(reach, w.z, q.z)}", Arithmetic::erratic},
    Mutant{"y rounded down", "{fma_up(reach, w.x, q.x), fma_up(reach, w.y, q.y), fma(reach, w.z, q.z)}",
           "{fma_up(reach, w.x, q.x), fma_down(reach, w.y, q.y), fma(reach, w.z, q.z)}", Arithmetic::erratic},
    Mutant{"height without the taper", "const real height = s->taper * z / s->semi_axes[2];",
           "const real height = 0.0 * (s->taper * z / s->semi_axes[2]);"},
    Mutant{"height with the other side's taper", "const real height = s->taper * z / s->semi_axes[2];",
           "const real height = -s->taper * z / s->semi_axes[2];"},
    Mutant{"height in no unit", "const real height = s->taper * z / s->semi_axes[2];",
           "const real height = s->taper * z;"},
    Mutant{"height as computed", "fma_down(fabs(height), REAL(-HEIGHT_ERROR), height)", "height",
           Arithmetic::evaluated},
    Mutant{"height's error on the other side", "fma_down(fabs(height), REAL(-HEIGHT_ERROR), height)",
           "fma_down(fabs(height), REAL(HEIGHT_ERROR), height)", Arithmetic::evaluated},
    Mutant{"height's error by its sign", "fma_down(fabs(height), REAL(-HEIGHT_ERROR), height)",
           "fma_down(height, REAL(-HEIGHT_ERROR), height)", Arithmetic::evaluated},
    Mutant{"half of the height's error", "fma_down(fabs(height), REAL(-HEIGHT_ERROR), height)",
           "fma_down(fabs(height), REAL(-0.5 * HEIGHT_ERROR), height)", Arithmetic::evaluated},
    Mutant{"height rounded up", "fma_down(fabs(height), REAL(-HEIGHT_ERROR), height)",
           "fma_up(fabs(height), REAL(-HEIGHT_ERROR), height)", Arithmetic::erratic},
    Mutant{"room by 1 - k^2 from above", "add_down(REAL(s->fall_down), height_down(x.z, s))",
           "add_down(REAL(s->fall_up), height_down(x.z, s))"},
    Mutant{"room of a solid that is larger", "add_down(REAL(s->fall_down), height_down(x.z, s))",
           "add_down(REAL(1.0), height_down(x.z, s))"},
    Mutant{"room rounded up", "add_down(REAL(s->fall_down), height_down(x.z, s))",
           "add_up(REAL(s->fall_down), height_down(x.z, s))", Arithmetic::erratic},
    Mutant{"quotient rounded down", "div_up(REAL(1.0), fmax(room, REAL(SMALLEST_ROOM)))",
           "div_down(REAL(1.0), fmax(room, REAL(SMALLEST_ROOM)))", Arithmetic::erratic},
    Mutant{"z as computed", "fma_up(REAL(POSITION_ERROR), fabs(x.z), fabs(x.z))", "fabs(x.z)", Arithmetic::evaluated},
    Mutant{"half of the error of z", "fma_up(REAL(POSITION_ERROR), fabs(x.z), fabs(x.z))",
           "fma_up(REAL(0.5 * POSITION_ERROR), fabs(x.z), fabs(x.z))", Arithmetic::evaluated},
    Mutant{"z rounded down", "fma_up(REAL(POSITION_ERROR), fabs(x.z), fabs(x.z))",
           "fma_down(REAL(POSITION_ERROR), fabs(x.z), fabs(x.z))", Arithmetic::erratic},
    Mutant{"z with its sign", "fma_up(REAL(POSITION_ERROR), fabs(x.z), fabs(x.z))",
           "fmax(fma_up(REAL(POSITION_ERROR), fabs(x.z), x.z), REAL(0.0))"},
    Mutant{"x not moved to the untapered solid", "mul_up(x.x, inverse_room)", "x.x"},
    Mutant{"y not moved to the untapered solid", "mul_up(x.y, inverse_room)", "x.y"},
    Mutant{"z not moved to the untapered solid", "mul_up(z, inverse_room)", "z"},
    Mutant{"untapered x rounded down", "mul_up(x.x, inverse_room)", "mul_down(x.x, inverse_room)", Arithmetic::erratic},
    Mutant{"untapered y rounded down", "mul_up(x.y, inverse_room)", "mul_down(x.y, inverse_room)", Arithmetic::erratic},
    Mutant{"untapered z rounded down", "mul_up(z, inverse_room)", "mul_down(z, inverse_room)", Arithmetic::erratic},

    Mutant{"gauge of another point", "exp_up(log_gauge_up(magnitudes(q), s))", "exp_up(log_gauge_up(q, s))"},
    Mutant{"gauge's norm rounded down", "exp_up(log_gauge_up(magnitudes(q), s))",
           "exp_down(log_gauge_up(magnitudes(q), s))", Arithmetic::erratic},
    Mutant{"gauge without its height", "sub_up(norm, height_down(q.z, s))", "norm"},
    Mutant{"gauge with the height of the other side", "sub_up(norm, height_down(q.z, s))",
           "add_up(norm, height_down(q.z, s))"},
    Mutant{"gauge's numerator rounded down", "sub_up(norm, height_down(q.z, s))", "sub_down(norm, height_down(q.z, s))",
           Arithmetic::erratic},
    Mutant{"gauge rounded down", "return div_up(sub_up(norm", "return div_down(sub_up(norm", Arithmetic::erratic},
    Mutant{"gauge by 1 - k^2 from above", "height_down(q.z, s)), REAL(s->fall_down))",
           "height_down(q.z, s)), REAL(s->fall_up))"},

    Mutant{"inner ball of the untapered solid", "s->inradius_down * (1.0 - fabs(s->taper))", "s->inradius_down"},
    Mutant{"inner ball by the taper's sign", "s->inradius_down * (1.0 - fabs(s->taper))",
           "s->inradius_down * (1.0 - s->taper)"},

    Mutant{"plane's normal on the other side", "{unit_normal.x, unit_normal.y, fabs(nz)}",
           "{unit_normal.x, unit_normal.y, nz}"},
    Mutant{"point on the other side", "{q.x, q.y, side * q.z}", "{q.x, q.y, q.z}"},
    Mutant{"plane with the other side's taper", "tilted_up(n, support_up(n, s), side * s->taper, s)",
           "tilted_up(n, support_up(n, s), REAL(s->taper), s)"},
    Mutant{"plane by another support", "tilted_up(n, support_up(n, s), side * s->taper, s)",
           "tilted_up(n, REAL(1.0), side * s->taper, s)"},
    Mutant{"plane's normal not turned back", "{tilted.normal.x, tilted.normal.y, side * tilted.normal.z}",
           "tilted.normal"},
    Mutant{"plane's normal as it was proposed", "{tilted.normal.x, tilted.normal.y, side * tilted.normal.z}",
           "unit_normal"},
    Mutant{"coordinates about the centre", "const focal_point q = about_focus(own, s);\n  const local_point folded_q",
           "focal_point q = about_focus(own, s);\n  q.point.z -= s->focus;\n  const local_point folded_q"},
    Mutant{"no error about the focus", "{q.point, q.sign, q.error}", "{q.point, q.sign, REAL(0.0)}"},
    Mutant{"error of the pose alone", "{q.point, q.sign, q.error}", "{q.point, q.sign, own.error}"},
    Mutant{"signs of the octant", "{q.point, q.sign, q.error}", "{q.point, own.sign, q.error}"},
};

}  // namespace

std::span<const Mutant> tapered_interior_mutants() {
  return interior;
}

}  // namespace verisq::mutation
