/// Mutants of what bent_depth.clh does about tapered solids, and of is_beyond in tapered_unbent_solid.clh.
///
/// Left out, because no enclosure can become false by them: what is only proposed (towards_focus, about_focus_nearest),
/// and the profile's derivative without (1 - k^2)^2, which is at most 1.
#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array mutants{
    Mutant{"room for the other end", "interval_scaled_add(REAL(s->taper), height,",
           "interval_scaled_add(REAL(-s->taper), height,"},
    Mutant{"room of the middle for that of the focus",
           "interval_scaled_add(REAL(s->taper), height, interval_of(REAL(s->fall_down), REAL(s->fall_up)))",
           "interval_scaled_add(REAL(s->taper), height, interval_of(REAL(1.0), REAL(1.0)))"},
    Mutant{"lower height by the upper room", "interval_div(low, room_low).lo", "interval_div(low, room_high).lo"},
    Mutant{"upper height by the lower room", "interval_div(high, room_high).hi", "interval_div(high, room_low).hi"},
    Mutant{"heights without their room",
           "interval_of(interval_div(low, room_low).lo, interval_div(high, room_high).hi)",
           "interval_of(low.lo, high.hi)"},
    Mutant{"heights without room", "MASK(room.lo > 0.0)", "MASK(room.lo == room.lo)"},
    Mutant{"room of the upper end alone", "interval_hull(room_low, room_high)", "room_high"},
    Mutant{"room of the lower end alone", "interval_hull(room_low, room_high)", "room_low"},
    Mutant{"profile's derivative by the larger room", "section.room.lo);\n  const real factor",
           "section.room.hi);\n  const real factor"},
    Mutant{"profile's derivative by no room",
           "div_up(mul_up(REAL(s->fall_up), REAL(s->inverse_axes_up[2])), section.room.lo)",
           "mul_up(REAL(s->fall_up), REAL(s->inverse_axes_up[2]))"},
    Mutant{"profile's derivative narrowed twice more", "mul_up(square_up(narrowing), sub_up(",
           "mul_up(mul_up(REAL(s->fall_up), square_up(narrowing)), sub_up("},
    Mutant{"profile's gradient, not narrowed",
           "interval_mul(interval_of(REAL(s->fall_down), REAL(s->fall_up)), of_height)", "of_height"},
    Mutant{"profile's gradient, taper the other way", "interval_sub(with_sign_of(z, falling), rising)",
           "interval_add(with_sign_of(z, falling), rising)"},
    Mutant{"profile's gradient without the taper", "interval_sub(with_sign_of(z, falling), rising)",
           "with_sign_of(z, falling)"},
    Mutant{"profile's gradient, no room", "interval_mul(room, profile)", "profile"},
    Mutant{"profile's gradient, room alone", "interval_mul(room, profile)", "room"},
    Mutant{"square of the profile, upper end by the lower", "mul_up(REAL(2.0 * p->inverse_p_down[0]), most_rest))",
           "mul_up(REAL(2.0 * p->inverse_p_down[0]), least_rest))"},
    Mutant{"value without room", "mul_down(mul_down(room, room), profile.lo)", "profile.lo"},
    Mutant{"value by the room once", "mul_down(mul_down(room, room), profile.lo)", "mul_down(room, profile.lo)"},
    Mutant{"value by the larger room", "const real room = section.room.lo;", "const real room = section.room.hi;"},
    Mutant{"border about the centre", "enclosed_in_own_axes(about_focus_enclosed(unbent_place(x, at.y), &p->solid), p)",
           "enclosed_in_own_axes(unbent_place(x, at.y), p)"},
    Mutant{"query about the centre", "enclosed_in_own_axes(about_focus_enclosed(unbent_place(q_0, q.y), &p->solid), p)",
           "enclosed_in_own_axes(unbent_place(q_0, q.y), p)"},
    Mutant{"tapered ball by the gauge", "p->solid.taper == 0.0 ? 2 : 1", "2"},
    Mutant{"way out about the centre",
           "enclosed_in_own_axes(about_focus_enclosed(unbent_place(y, outer.y), &p->solid), p)",
           "enclosed_in_own_axes(unbent_place(y, outer.y), p)", Arithmetic::poor_search},
    Mutant{"beyond 1 - k^2", "exp_down(log_gauge_down(lower_ends(sizes_of(w)), p)) > add_up(REAL(s->fall_up), height)",
           "exp_down(log_gauge_down(lower_ends(sizes_of(w)), p)) > REAL(s->fall_up)", Arithmetic::poor_search},
    Mutant{"beyond the other end",
           "exp_down(log_gauge_down(lower_ends(sizes_of(w)), p)) > add_up(REAL(s->fall_up), height)",
           "exp_down(log_gauge_down(lower_ends(sizes_of(w)), p)) > sub_up(REAL(s->fall_up), height)",
           Arithmetic::poor_search},
};

}  // namespace

std::span<const Mutant> tapered_depth_mutants() {
  return mutants;
}

}  // namespace verisq::mutation
