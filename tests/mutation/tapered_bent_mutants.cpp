/// Mutants of tapered_unbent_solid.clh, and of what set_tree.clh and bent_distance.cl do with it.
///
/// Left out, because no enclosure can become false by them: what is only proposed (closest_of_solid, the number that
/// support_over_up starts from). Survivors, known and not listed: along_up without the rounding of the focus, which
/// moves the ends of the solid by its last place; the factor 2 of bent_solid_error, which the bound of the taper's
/// error hides where the bend stretches most; excess_up_at's outer difference rounded down, which is exact nearby.

#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array mutants{
    Mutant{"cubes of bends about the centre", "return from_focus(bent_map(x, p), &p->solid);",
           "return bent_map(x, p);"},
    Mutant{"cubes of bends, placed about the focus twice", "return from_focus(bent_map(x, p), &p->solid);",
           "return from_focus(from_focus(bent_map(x, p), &p->solid), &p->solid);"},
    Mutant{"bent nodes about the centre", "return leaf_node(x, bent_focal_map(x, p), query, outside, least, p);",
           "return leaf_node(x, bent_map(x, p), query, outside, least, p);"},
    Mutant{"place about the centre", "interval_add(own.z, interval_of(REAL(s->focus), REAL(s->focus)))", "own.z"},
    Mutant{"place, focus on the other side", "interval_add(own.z, interval_of(REAL(s->focus), REAL(s->focus)))",
           "interval_sub(own.z, interval_of(REAL(s->focus), REAL(s->focus)))"},
    Mutant{"no error of the solid", "return 2.0 * REAL(s->taper_error);", "return REAL(0.0);"},
    Mutant{"distances without the solid's error", "add_up(of_frame, bent_solid_error(&p->solid))", "of_frame"},
    Mutant{"excess by the norm rounded down", "const real norm = exp_up(log_gauge_up(upper_ends",
           "const real norm = exp_down(log_gauge_up(upper_ends", Arithmetic::loose_below},
    Mutant{"excess by the lower ends", "exp_up(log_gauge_up(upper_ends(sizes_of(w)), s));",
           "exp_up(log_gauge_up(lower_ends(sizes_of(w)), s));", Arithmetic::loose_below},
    Mutant{"excess without its height", "sub_up(sub_up(norm, height), REAL(s->fall_down))", "sub_up(norm, REAL(1.0))",
           Arithmetic::poor_search},
    Mutant{"excess by the other height", "sub_up(sub_up(norm, height), REAL(s->fall_down))",
           "sub_up(sub_up(norm, -height), REAL(s->fall_down))", Arithmetic::poor_search},
    Mutant{"excess, height rounded up", "fmin(share_down(k, w.z.lo, s), share_down(k, w.z.hi, s));",
           "fmin(share_up(k, w.z.lo, s), share_up(k, w.z.hi, s));", Arithmetic::erratic},
    Mutant{"excess, difference rounded down", "sub_up(sub_up(norm, height), REAL(s->fall_down))",
           "sub_up(sub_down(norm, height), REAL(s->fall_down))", Arithmetic::loose_below},
    Mutant{"excess by 1 - k^2 from above", "sub_up(sub_up(norm, height), REAL(s->fall_down))",
           "sub_up(sub_up(norm, height), REAL(s->fall_up))"},
    Mutant{"excess of what is not divided",
           "return div_up(sub_up(sub_up(norm, height), REAL(s->fall_down)), REAL(s->fall_down));",
           "return 0.5 * sub_up(sub_up(norm, height), REAL(s->fall_down));", Arithmetic::poor_search},
    Mutant{"support without the tilt", "const interval3 normal = {v.x, v.y, interval_add(v.z, tilt)};",
           "const interval3 normal = v;"},
    Mutant{"support, tilted the other way", "interval_add(v.z, tilt)", "interval_sub(v.z, tilt)"},
    Mutant{"support, tilt by one end", "const interval tilt = {share_down(k, t, s), share_up(k, t, s)};",
           "const interval tilt = {share_up(k, t, s), share_up(k, t, s)};", Arithmetic::erratic},
    Mutant{"support without what is left", "mul_up(add_up(REAL(1.0), fabs(k)), left)", "REAL(0.0)",
           Arithmetic::poor_search},
    Mutant{"support, what is left counted once", "mul_up(add_up(REAL(1.0), fabs(k)), left)",
           "mul_up(sub_up(REAL(1.0), fabs(k)), left)", Arithmetic::poor_search},
    Mutant{"support, what is left rounded down",
           "positive_part(sub_up(support_up(upper_ends(sizes_of(normal)), s), t))",
           "positive_part(sub_down(support_up(upper_ends(sizes_of(normal)), s), t))", Arithmetic::loose_below},
    Mutant{"support by the lower ends", "support_up(upper_ends(sizes_of(normal)), s)",
           "support_up(lower_ends(sizes_of(normal)), s)", Arithmetic::loose_below},
    Mutant{"support by 1 - k^2 from below", "fma_up(REAL(s->fall_up), t, mul_up(",
           "fma_up(REAL(s->fall_down), t, mul_up("},
    Mutant{"support of the other side", "enclosed_in_own_axes(opposite_of(gradient), p)",
           "enclosed_in_own_axes(gradient, p)"},
};

}  // namespace

std::span<const Mutant> tapered_bent_mutants() {
  return mutants;
}

}  // namespace verisq::mutation
