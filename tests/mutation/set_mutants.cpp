/// The table of mutants of set_bounds.cl.
///
/// Left out, because no enclosure can become false by them:
/// - Changes of what is only proposed, whatever the foot, the ball and the multipliers are: foot_on_literal, level_at,
///   combination, find_edge_foot, centre_of_ball, leads_away, which literal is open, when an edge is wanted, starts,
///   margins, limits of multipliers below 1.
/// - Bounds that only get worse: of `others` the least of all terms, an upper end that is dropped.
/// - `upper` as a part of the reach: what a half-space forgets about points of its edge that are farther from the foot
///   than the query is shows where the nearest point is such a one, and then the bound is not tight.
/// - Multipliers that are infinite: the square is not a number then, or not above 0.
/// - Roots of what is below 0 or not a number: sqrt_down makes nothing of them.
/// - The term's own distance beside `others`: it is the least of both.
/// - One literal of an edge for both, and any order of terms: what they prove holds.
/// - Literals on the wrong side: no edge leads away from both. Were q's nearest point of C and D on the edge because D
///   keeps it from the foot on C, then C without D would be farther than its literals say.
/// - A point of the solid as an upper end for queries that may lie on either side: it is one. Likewise one of the
///   complement as a lower end.
/// - The other target of a query: a term of it holds the query, all its literals are at 0, and nothing follows.
/// Survivors, known and not listed: that differences of coordinates are intervals, as wide as one rounding; the reach
/// in pull_back, where it covers roundings to nearest (solid_mutants.cpp); that the other terms of one target are not
/// stored for lanes whose query is of the other, which matters to few of those; the colours of an edge's foot taken
/// where its search started, which as a rule is no point of the target: there the upper end is dropped.

#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array mutants{
    // What is known of primitives, and the terms
    Mutant{"edge, first literal never cut away", "return (uint)edge >> 7 & 127U;", "return (uint)edge >> 7 & 63U;"},
    Mutant{"edge, second literal never cut away", "return (uint)edge & 127U;", "return (uint)edge & 63U;"},
    Mutant{"edge, sides exchanged", "return (uint)edge >> 14 != 0;", "return (uint)edge >> 14 == 0;"},
    Mutant{"edge of the solid alone", "(complement ? 1L << 14 : 0L)", "0L"},
    Mutant{"edge, literals' places", "TO_REAL(literal * 128 + open +", "TO_REAL(literal * 64 + open +"},
    Mutant{"literal by the upper end", "return LOAD(group, known.los + i * known.stride);",
           "return LOAD(group, known.his + i * known.stride);"},
    Mutant{"literal cut away by the lower end", "return LOAD(group, known.his + i * known.stride);",
           "return LOAD(group, known.los + i * known.stride);"},
    Mutant{"lower ends of the first primitive", "return LOAD(group, known.los + i * known.stride);",
           "return LOAD(group, known.los);"},
    Mutant{"upper ends of the first primitive", "return LOAD(group, known.his + i * known.stride);",
           "return LOAD(group, known.his);"},
    Mutant{"terms of the other target", "const uint first = complement ? TERMS_OF_SOLID : 0;",
           "const uint first = complement ? 0 : TERMS_OF_SOLID;"},
    Mutant{"terms without the last",
           "const uint last = complement ? TERMS_OF_SOLID + TERMS_OF_COMPLEMENT : TERMS_OF_SOLID;",
           "const uint last = complement ? TERMS_OF_SOLID + TERMS_OF_COMPLEMENT - 1 : TERMS_OF_SOLID - 1;"},
    Mutant{"literals' sides exchanged", "const real distance = is_inside ? low_of(known, i, group) : -high_of(",
           "const real distance = !is_inside ? low_of(known, i, group) : -high_of("},
    Mutant{"literal cut away, the wrong sign", ": -high_of(known, i, group);", ": high_of(known, i, group);"},
    Mutant{"literals of other terms", "if (!is_inside && (term_outside[t] & bit_of(i)) == 0) continue;", ""},
    Mutant{"term by the sum of its literals", "largest = select(largest, distance, farther);",
           "largest = select(largest, largest + distance, farther);"},
    Mutant{"last term", "found.distance = select(found.distance, largest, nearer);", "found.distance = largest;"},
    Mutant{"other terms forgotten", "found.others = fmin(found.others, select(largest, found.distance, nearer));", ""},
    Mutant{"other terms after the nearest", "select(largest, found.distance, nearer));",
           "select(largest, REAL(INFINITY), nearer));"},
    Mutant{"greatest of the other terms", "found.others = fmin(found.others, select(",
           "found.others = fmax(select(found.others, REAL(0.0), MASK(found.others == INFINITY)), select("},
    Mutant{"literal of the last term", "found.literal = select(found.literal, literal, nearer);",
           "found.literal = literal;"},
    Mutant{"primitives of the last term", "select(found.inside, INTEGER((long)term_inside[t]), nearer)",
           "INTEGER((long)term_inside[t])"},
    Mutant{"primitives cut away of the last term", "select(found.outside, INTEGER((long)term_outside[t]), nearer)",
           "INTEGER((long)term_outside[t])"},
    Mutant{"open literal of another term", "MASK((term.inside & bit) != 0) & ~c[i].black", "~c[i].black"},
    Mutant{"open literal cut away of another term", "MASK((term.outside & bit) != 0) & ~c[i].white", "~c[i].white"},

    // Feet and their colours
    Mutant{"colours of one primitive", "c[i] = primitive_colour(here, primitives + i);\n}",
           "c[i] = primitive_colour(here, primitives);\n}"},
    Mutant{"foot on the other side", "colour_on_side(solid_colour(c, matters), complement)",
           "colour_on_side(solid_colour(c, matters), !complement)"},
    Mutant{"foot of any colour", "own.black & MASK(distance <= DBL_MAX));\n}\n\n// A literal",
           "MASK(distance <= DBL_MAX));\n}\n\n// A literal"},
    Mutant{"foot that may lie in the target", "own.black & MASK(distance <= DBL_MAX));\n}\n\n// A literal",
           "~own.white & MASK(distance <= DBL_MAX));\n}\n\n// A literal"},
    Mutant{"foot's distance from itself", "distance_between_up(foot, q);\n  return select",
           "distance_between_up(foot, foot);\n  return select"},
    Mutant{"edge's foot by the distance of its start", "distance_of_foot(q, at.foot, c, complement)",
           "distance_of_foot(q, start, c, complement)"},
    Mutant{"edges of other lanes", "found = select(found, REAL(name), usable);", "found = REAL(name);"},
    Mutant{"edges of earlier chunks", "STORE(REAL(NO_EDGE), group, out.edges);", ""},
    Mutant{"bounds by the other terms alone", "return interval_of(fmin(term.distance, term.others), upper);",
           "return interval_of(term.others, upper);"},
    Mutant{"query inside by its lower end", "c[i].black = MASK(high_of(known, i, group) < 0.0);",
           "c[i].black = MASK(low_of(known, i, group) < 0.0);"},
    Mutant{"query outside by its upper end", "c[i].white = MASK(low_of(known, i, group) > 0.0);",
           "c[i].white = MASK(high_of(known, i, group) > 0.0);"},
    Mutant{"query's colours exchanged", "c[i].black |= evaluated.black;\n    c[i].white |= evaluated.white;",
           "c[i].black |= evaluated.white;\n    c[i].white |= evaluated.black;"},
    Mutant{"query's colours of one primitive", "const colour evaluated = primitive_colour(here, primitives + i);",
           "const colour evaluated = primitive_colour(here, primitives);"},
    Mutant{"outside wherever something is", "lo = select(lo, outside.lo, own.white);", "lo = outside.lo;"},
    Mutant{"inside, ends exchanged",
           "lo = select(lo, -inside.hi, own.black);\n    hi = select(hi, -inside.lo, own.black);",
           "lo = select(lo, -inside.lo, own.black);\n    hi = select(hi, -inside.hi, own.black);"},
    Mutant{"inside, upper end wherever something is", "hi = select(hi, -inside.lo, own.black);", "hi = -inside.lo;"},

    // Half-spaces and balls
    Mutant{"half-space without its reach", "const cube about = {foot, reach};", "const cube about = {foot, REAL(0.0)};",
           Arithmetic::displaced},
    Mutant{"half-space through the foot", "interval_of(h.normal.z, h.normal.z), h.offset, false}",
           "interval_of(h.normal.z, h.normal.z), REAL(0.0), false}"},
    Mutant{"half-space, y for x", "{interval_of(h.normal.x, h.normal.x),", "{interval_of(h.normal.y, h.normal.y),"},
    Mutant{"half-space, the other side", "interval_of(h.normal.z, h.normal.z), h.offset, false}",
           "interval_of(h.normal.z, h.normal.z), -h.offset, false}"},
    Mutant{"reach without the foot's distance", "add_up(upper, distance_between_up(foot, q))", "upper",
           Arithmetic::displaced},
    Mutant{"reach of the other side", "const real upper = complement ? -lo : hi;",
           "const real upper = complement ? lo : -hi;", Arithmetic::displaced},
    Mutant{"ball, x of its centre", "{interval_difference(centre.x, foot.x),",
           "{interval_difference(centre.y, foot.x),"},
    Mutant{"ball, the other way", "interval_difference(centre.z, foot.z), REAL(0.0), true}",
           "interval_difference(foot.z, centre.z), REAL(0.0), true}"},
    Mutant{"ball through the foot", "found.slack = sub_up(square.hi, mul_down(depth, depth));", ""},
    Mutant{"ball, lower end of the square", "found.slack = sub_up(square.hi,", "found.slack = sub_up(square.lo,",
           Arithmetic::loose_above},
    Mutant{"ball, difference rounded down", "found.slack = sub_up(square.hi,", "found.slack = sub_down(square.hi,",
           Arithmetic::loose_below},
    Mutant{"ball, radius rounded up", "mul_down(depth, depth));", "mul_up(depth, depth));", Arithmetic::loose_above},
    Mutant{"ball, diameter for radius", "mul_down(depth, depth));", "mul_down(2.0 * depth, depth));"},
    Mutant{"ball, y left out", "squared_length(to_centre.x, to_centre.y, to_centre.z);",
           "squared_length(to_centre.x, to_centre.x, to_centre.z);"},
    Mutant{"ball of the first primitive", "const ulong first = i * balls.stride;", "const ulong first = 0;"},
    Mutant{"ball, depth of the first primitive", "positive_part(-LOAD(group, balls.his + first))",
           "positive_part(-LOAD(group, balls.his))"},
    Mutant{"ball, centre's y for z", "LOAD(group, balls.zs + first)};", "LOAD(group, balls.ys + first)};"},
    Mutant{"ball about a point outside", "positive_part(-LOAD(group, balls.his + first))",
           "-LOAD(group, balls.his + first)"},
    Mutant{"literals' kinds exchanged", "if (!is_complement(literal)) return half_space_of(",
           "if (is_complement(literal)) return half_space_of("},
    Mutant{"literals all half-spaces", "if (!is_complement(literal)) return half_space_of(", "return half_space_of("},
    Mutant{"half-space of the first primitive", "return half_space_of(foot, reach, primitives + i);",
           "return half_space_of(foot, reach, primitives);"},
    Mutant{"second literal of the first", "constraint_of(second_literal(name), foot,",
           "constraint_of(first_literal(name) ^ COMPLEMENT, foot,"},

    // The distance of an edge
    Mutant{"remainder, product rounded twice", "interval_mul(interval_of(a, a), b)", "interval_of(a * b.lo, a * b.lo)",
           Arithmetic::loose_above},
    Mutant{"remainder without d", "interval_sub(interval_sub(d, times(m.a, a)), times(m.b, b))",
           "interval_sub(times(m.a, a), times(m.b, b))"},
    Mutant{"edge, x of the foot", "const interval dx = interval_difference(q.x, foot.x);",
           "const interval dx = interval_difference(q.x, foot.y);"},
    Mutant{"edge, the foot's other side", "const interval dz = interval_difference(q.z, foot.z);",
           "const interval dz = interval_difference(foot.z, q.z);"},
    Mutant{"edge, negative multiplier of the first", "const real above_a = positive_part(shares.a);",
           "const real above_a = shares.a;"},
    Mutant{"edge, negative multiplier of the second", "const real above_b = positive_part(shares.b);",
           "const real above_b = shares.b;"},
    Mutant{"edge, balls' multipliers above 1", "0.5 * LARGEST_MULTIPLIER : LARGEST_MULTIPLIER",
           "LARGEST_MULTIPLIER : 2.0 * LARGEST_MULTIPLIER"},
    Mutant{"edge, both balls' multipliers above 1", "0.5 * LARGEST_MULTIPLIER : LARGEST_MULTIPLIER",
           "LARGEST_MULTIPLIER : LARGEST_MULTIPLIER"},
    Mutant{"edge, multiplier of a first ball not limited", "{a.ball ? least_or_nan(above_a, most) : above_a,",
           "{above_a,"},
    Mutant{"edge, multiplier of a second ball not limited", "b.ball ? least_or_nan(above_b, most) : above_b}",
           "above_b}"},
    Mutant{"edge, first ball not counted", "add_up(a.ball ? m.a : REAL(0.0), b.ball ? m.b : REAL(0.0))",
           "b.ball ? m.b : REAL(0.0)"},
    Mutant{"edge, second ball not counted", "add_up(a.ball ? m.a : REAL(0.0), b.ball ? m.b : REAL(0.0))",
           "a.ball ? m.a : REAL(0.0)"},
    Mutant{"edge, balls rounded down", "const real balls = add_up(", "const real balls = add_down(",
           Arithmetic::loose_below},
    Mutant{"edge, x of the remainder left out", "squared_length(remainder_of(dx, m, a.x, b.x),",
           "squared_length(interval_of(REAL(0.0), REAL(0.0)),"},
    Mutant{"edge, z of the remainder of y", "remainder_of(dz, m, a.z, b.z));", "remainder_of(dy, m, a.y, b.y));"},
    Mutant{"edge, remainder of the first alone", "remainder_of(dz, m, a.z, b.z));", "remainder_of(dz, m, a.z, a.z));"},
    Mutant{"edge, slack of the first counted once", "mul_up(a.ball ? m.a : 2.0 * m.a, a.slack)",
           "mul_up(m.a, a.slack)"},
    Mutant{"edge, slack of the second counted once", "mul_up(b.ball ? m.b : 2.0 * m.b, b.slack)",
           "mul_up(m.b, b.slack)"},
    Mutant{"edge, slack of a first ball twice", "mul_up(a.ball ? m.a : 2.0 * m.a, a.slack)",
           "mul_up(2.0 * m.a, a.slack)"},
    Mutant{"edge, slack of a second ball twice", "mul_up(b.ball ? m.b : 2.0 * m.b, b.slack)",
           "mul_up(2.0 * m.b, b.slack)"},
    Mutant{"edge, slack of the first rounded down", "mul_up(a.ball ?", "mul_down(a.ball ?", Arithmetic::loose_below},
    Mutant{"edge, slack of the second rounded down", "mul_up(b.ball ?", "mul_down(b.ball ?", Arithmetic::loose_below},
    Mutant{"edge, slack of the first forgotten", "add_up(slack_a, slack_b));", "slack_b);"},
    Mutant{"edge, slack of the second forgotten", "add_up(slack_a, slack_b));", "slack_a);"},
    Mutant{"edge, slacks' sum rounded down", "add_up(slack_a, slack_b));", "add_down(slack_a, slack_b));",
           Arithmetic::loose_below},
    Mutant{"edge, loss rounded down", "const real loss = add_up(div_up(", "const real loss = add_down(div_up(",
           Arithmetic::loose_below},
    Mutant{"edge, quotient rounded down", "add_up(div_up(left.hi,", "add_up(div_down(left.hi,",
           Arithmetic::loose_below},
    Mutant{"edge, quotient forgotten", "div_up(left.hi, sub_down(REAL(1.0), balls))", "left.hi"},
    Mutant{"edge, remainder forgotten", "div_up(left.hi, sub_down(REAL(1.0), balls))", "REAL(0.0)"},
    Mutant{"edge, rest of the multipliers rounded up", "div_up(left.hi, sub_down(REAL(1.0), balls))",
           "div_up(left.hi, sub_up(REAL(1.0), balls))", Arithmetic::loose_above},
    Mutant{"edge, lower end of the remainder", "div_up(left.hi,", "div_up(left.lo,", Arithmetic::loose_below},
    Mutant{"edge, upper end of the square", "sub_down(squared_length(dx, dy, dz).lo, loss)",
           "sub_down(squared_length(dx, dy, dz).hi, loss)", Arithmetic::loose_above},
    Mutant{"edge, difference rounded up", "const real square = sub_down(squared_length(",
           "const real square = sub_up(squared_length(", Arithmetic::loose_above},
    Mutant{"edge, x left out", "squared_length(dx, dy, dz).lo", "squared_length(dy, dy, dz).lo"},
    Mutant{"edge, other root", "return select(REAL(0.0), sqrt_down(square), valid);",
           "return select(REAL(0.0), sqrt_up(square), valid);", Arithmetic::loose_above},
    Mutant{"edge without a root", "return select(REAL(0.0), sqrt_down(square), valid);",
           "return select(REAL(0.0), fmax(sqrt_down(square), square), valid);"},
    Mutant{"bounds without the other terms", "const real lower = fmin(of_edge, LOAD(group, others));",
           "const real lower = of_edge;"},
    Mutant{"bounds in other lanes", "const integer same = MASK(edge == name);\n    if (complement)",
           "const integer same = INTEGER(-1L);\n    if (complement)"},
    Mutant{"bounds, the wrong end", "if (complement) hi = select(hi, fmin(hi, -lower), same);",
           "if (complement) lo = select(lo, fmax(lo, -lower), same);"},
    Mutant{"bounds, the wrong sign", "if (complement) hi = select(hi, fmin(hi, -lower), same);",
           "if (complement) lo = select(lo, fmax(lo, lower), same);"},
};

}  // namespace

std::span<const Mutant> set_mutants() {
  return mutants;
}

}  // namespace verisq::mutation
