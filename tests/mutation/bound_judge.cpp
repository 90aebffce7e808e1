/// This file implements the comparison with long double: its rounding is a billionth of the pessimistic arithmetics'.
#include "tests/mutation/bound_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "host/device/primitive_parameters.hpp"
#include "tests/mutation/open_caps.hpp"
#include "tests/mutation/tapered_inside.hpp"
#include "tests/mutation/way_out.hpp"
#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::mutation {
namespace {

constexpr const char* bound_kernel = R"(
ALWAYS_INLINE real lower_end_from_afar(vector3 q, constant const superquadric* s) {
  const vector3 octant = {REAL(1.0), REAL(1.0), REAL(1.0)};
  const local_point exact = {q, octant, REAL(0.0)};
  return enclosure_from_afar(exact, s).lo;
}

ALWAYS_INLINE gauge_logarithms logarithms_at(vector3 x, constant const superquadric* s) {
  const interval3 point = {point_interval(x.x), point_interval(x.y), point_interval(x.z)};
  return logarithms_over(point, s);
}

ALWAYS_INLINE interval sorted(real a, real b) { return interval_of(lesser(a, b), greater(a, b)); }

ALWAYS_INLINE real cosine_about(real longest, real length, real size) {
  cap_axis axis;
  axis.longest = longest;
  axis.length = length;
  return cosine_of(axis, size);
}

ALWAYS_INLINE vector3 lower_ends(interval3 x) {
  const vector3 ends = {x.x.lo, x.y.lo, x.z.lo};
  return ends;
}

ALWAYS_INLINE vector3 upper_ends(interval3 x) {
  const vector3 ends = {x.x.hi, x.y.hi, x.z.hi};
  return ends;
}

kernel void evaluate_bound(uint bound, ulong groups, global const double* operands, ulong stride,
                           constant const superquadric* s, global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 a = {LOAD(group, operands), LOAD(group, operands + stride), LOAD(group, operands + 2 * stride)};
  const vector3 b = {LOAD(group, operands + 3 * stride), LOAD(group, operands + 4 * stride),
                     LOAD(group, operands + 5 * stride)};
  vector3 result = {REAL(0.0), REAL(0.0), REAL(0.0)};
  switch (bound) { // numbered as in tests/mutation/bound_judge.cpp
    case 0: result.x = dot_down(a, b); break;
    case 1: result.x = dot_up(a, b); break;
    case 2: result.x = length_down(a); break;
    case 3: result.x = length_up(a); break;
    case 4: result.x = pow_unit_down(a.x, a.y); break;
    case 5: result.x = pow_unit_up(a.x, a.y); break;
    case 6: result.x = log_norm_up(a.x, a.y, s->p_down[1], s->inverse_p_up[1]); break;
    case 7: result.x = log_gauge_up(a, s); break;
    case 8: result.x = norm_up(a.x, a.y, s->conjugate_down[1], s->inverse_conjugate_up[1]); break;
    case 9: result.x = support_up(a, s); break;
    case 10: result.x = distance_down(b, a, s); break;
    case 11: result.x = gauge_terms_up(b, s).power; break;
    case 12: result = direction_down(a); break;
    case 13: result = test_point(a, b.x, b, b.y, s).position; break;
    case 14: result.x = separation_down(a, s); break;
    case 15: result.x = lower_end_from_afar(b, s); break;
    case 16: result.x = lower_end_from_afar(a, s); break;
    case 17: result.x = log_norm(point_interval(a.x), point_interval(a.y), s->p_down[1]).lo; break;
    case 18: result.x = log_norm(point_interval(a.x), point_interval(a.y), s->p_down[1]).hi; break;
    case 19: result = lower_ends(gradient_over(logarithms_at(a, s), s)); break;
    case 20: result = upper_ends(gradient_over(logarithms_at(a, s), s)); break;
    case 21: result = factors_up(logarithms_at(a, s), s); break;
    case 22: result.x = section_shares_over(logarithms_at(a, s), s).x.lo; break;
    case 23: result.x = section_shares_over(logarithms_at(a, s), s).x.hi; break;
    case 24: result.x = section_turn_up(factors_up(logarithms_at(a, s), s), b, logarithms_at(a, s), s); break;
    case 25: result.x = most_of(a, b); break;
    case 26: result.x = step_between(lesser(a.x, b.x), greater(a.x, b.x)).lo; break;
    case 27: result.x = step_between(lesser(a.x, b.x), greater(a.x, b.x)).hi; break;
    case 28: result.x = residual_up(sorted(a.x, a.y), b.x, sorted(b.y, b.z)); break;
    case 29: result.x = most_apart(sorted(a.x, a.y), sorted(b.x, b.y)); break;
    case 30: result.x = way_of(a.x, a.x + a.y, a.z, b.x, b.y).lo; break;
    case 31: result.x = way_of(a.x, a.y, a.z, b.x, b.y).hi; break;
    case 32: result.x = cosine_about(a.x, a.y, b.x); break;
    case 33: result.x = power_up(logarithms_at(a, s), s); break;
    default: break;
  }
  STORE(result.x, group, results);
  STORE(result.y, group, results + stride);
  STORE(result.z, group, results + 2 * stride);
}

kernel void open_quarters(ulong groups, global const double* operands, ulong stride, constant const superquadric* s,
                          global double* results) {
  const ulong group = get_global_id(0);
  if (group >= groups) return;
  const vector3 q = {LOAD(group, operands), LOAD(group, operands + stride), LOAD(group, operands + 2 * stride)};
  const vector3 base = {LOAD(group, operands + 3 * stride), LOAD(group, operands + 4 * stride),
                        LOAD(group, operands + 5 * stride)};
  const real inverted = LOAD(group, operands + 6 * stride);
  const real t = LOAD(group, operands + 7 * stride);
  const vector3 axis = {LOAD(group, operands + 8 * stride), LOAD(group, operands + 9 * stride),
                        LOAD(group, operands + 10 * stride)};
  const cone cap = {axis, LOAD(group, operands + 11 * stride)};
  STORE(TO_REAL(test_quarters(q, t, base, inverted, REAL(1.0), cap, s).open), group, results);
}
)";

enum class Side { below, above };

struct Operands {
  Point a, b;
};

struct Bound {
  const char* name;
  Side side;
  Operands (*draw)(oracle::RandomCases&, const Norm&);
  Vector (*value)(const Operands&, const Norm&);  ///< unused components are 0
};

Operands two_points(oracle::RandomCases& random, const Norm&) {
  return {point(random), point(random)};
}

Operands base_and_exponent(oracle::RandomCases& random, const Norm&) {
  return {{random.uniform(0.0, 1.0), random.log_uniform(0.1, 10.0), 0.0}, {}};
}

Operands two_logarithms(oracle::RandomCases& random, const Norm&) {
  return {{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.0}, {}};
}

/// A direction and a point so far away that the terms of the bound differ in size.
Operands direction_and_far_point(oracle::RandomCases& random, const Norm&) {
  const Point far = point(random);
  return {point(random), {1e3 * far[0], 1e3 * far[1], 1e3 * far[2]}};
}

/// Outside by less than what one operation may be off.
Operands just_outside(oracle::RandomCases& random, const Norm& norm) {
  return {{}, with_gauge(1.0L + 1e-10L, random, norm)};
}

constexpr Point centre{1.0, 2.0, 3.0};  // of the solids

/// In the model's frame, inside by less than what the local point may be off.
Operands just_inside(oracle::RandomCases& random, const Norm& norm) {
  const Point x = with_gauge(1.0L - 1e-10L, random, norm);
  return {{x[0] + centre[0], x[1] + centre[1], x[2] + centre[2]}, {}};
}

/// The greatest |(x, y)| in the section with the semi-axes a and b.
Extended reach(Extended a, Extended b, Extended exponent) {
  if (exponent <= 2.0L) return std::max(a, b);
  return oracle::planar_norm<Extended>(a, b, 2.0L * exponent / (exponent - 2.0L));
}

Vector log_norm(const Operands& o, const Norm& norm) {
  const Extended a = std::exp(Extended(o.a[0]));
  const Extended b = std::exp(Extended(o.a[1]));
  return {std::log(oracle::planar_norm<Extended>(a, b, norm.inner().primal))};
}

/// The farther of the sphere and the box about the solid.
Extended from_afar(const Vector& q, const Norm& norm) {
  const auto& a = norm.semi_axes();
  const Extended radius = reach(reach(a[0], a[1], norm.inner().primal), a[2], norm.outer().primal);
  Vector beyond{};
  for (std::size_t k = 0; k < 3; ++k) beyond[k] = std::max(q[k] - a[k], 0.0L);
  return std::max(length(q) - radius, length(beyond));
}

/// Of a point inside, an upper bound of the signed distance: balls about the centre lie in the solid, for it contains
/// the octahedron of its semi-axes.
Extended least_depth(const Vector& q, const Norm& norm) {
  const auto& a = norm.semi_axes();
  return (norm.gauge(q) - 1.0L) / length({1.0L / a[0], 1.0L / a[1], 1.0L / a[2]});
}

/// The derivatives of F = g^p1 (kernels/interior.clh).
Vector gradient_of_power(const Vector& x, const Norm& norm) {
  const Extended gauge = norm.gauge(x);
  const Extended p1 = norm.outer().primal;
  return scaled(norm.gradient(x, gauge), p1 * std::pow(gauge, p1 - 1.0L));
}

struct SectionTerms {
  Extended power;    ///< r^p1
  Vector shares;     ///< alpha, beta
  Vector quotients;  ///< alpha / x, beta / y
};

SectionTerms section_terms(const Vector& x, const Norm& norm) {
  const Extended p2 = norm.inner().primal;
  const std::array<Extended, 2> scaled_x{x[0] / norm.semi_axes()[0], x[1] / norm.semi_axes()[1]};
  const auto r = oracle::planar_norm<Extended>(scaled_x[0], scaled_x[1], p2);
  SectionTerms terms{std::pow(r, norm.outer().primal), {}, {}};
  for (std::size_t k = 0; k < 2; ++k) {
    terms.shares[k] = std::pow(scaled_x[k] / r, p2);
    terms.quotients[k] = terms.shares[k] / x[k];
  }
  return terms;
}

Vector factors(const Vector& x, const Norm& norm) {
  const SectionTerms terms = section_terms(x, norm);
  const Extended of_z = std::pow(x[2] / norm.semi_axes()[2], norm.outer().primal) / (x[2] * x[2]);
  return {terms.power * terms.quotients[0] / x[0], terms.power * terms.quotients[1] / x[1], of_z};
}

/// For |e_x| and |e_y| as large as may be, of opposite signs.
Extended section_turn(const Vector& x, const Vector& spread, const Norm& norm) {
  const SectionTerms terms = section_terms(x, norm);
  const Extended turn = spread[0] / x[0] + spread[1] / x[1];
  return terms.power * terms.shares[0] * terms.shares[1] * turn * turn;
}

/// The most of sum h_i e_i^2 for |e| = 1 and |e_i| <= spread_i: the largest h_i first.
Extended most_of(const Vector& h, const Vector& spread) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) { return h[i] > h[j]; });
  Extended left = 1.0L;
  Extended sum = 0.0L;
  for (const std::size_t i : order) {
    const Extended taken = std::min(left, spread[i] * spread[i]);
    sum += taken * h[i];
    left -= taken;
  }
  return sum;
}

/// In the order of `evaluate_bound`.
const Bound bounds[] = {
    {"dot_down", Side::below, two_points,
     [](const Operands& o, const Norm&) { return Vector{dot(extended(o.a), extended(o.b))}; }},
    {"dot_up", Side::above, two_points,
     [](const Operands& o, const Norm&) { return Vector{dot(extended(o.a), extended(o.b))}; }},
    {"length_down", Side::below, two_points,
     [](const Operands& o, const Norm&) { return Vector{length(extended(o.a))}; }},
    {"length_up", Side::above, two_points,
     [](const Operands& o, const Norm&) { return Vector{length(extended(o.a))}; }},
    {"pow_unit_down", Side::below, base_and_exponent,
     [](const Operands& o, const Norm&) { return Vector{std::pow(Extended(o.a[0]), Extended(o.a[1]))}; }},
    {"pow_unit_up", Side::above, base_and_exponent,
     [](const Operands& o, const Norm&) { return Vector{std::pow(Extended(o.a[0]), Extended(o.a[1]))}; }},
    {"log_norm_up", Side::above, two_logarithms, log_norm},
    {"log_gauge_up", Side::above, two_points,
     [](const Operands& o, const Norm& norm) { return Vector{std::log(norm.gauge(extended(o.a)))}; }},
    {"norm_up", Side::above, two_points,
     [](const Operands& o, const Norm& norm) {
       if (norm.inner().dual_is_maximum) return Vector{std::max(o.a[0], o.a[1])};
       return Vector{oracle::planar_norm<Extended>(o.a[0], o.a[1], norm.inner().dual)};
     }},
    {"support_up", Side::above, two_points,
     [](const Operands& o, const Norm& norm) { return Vector{norm.support(extended(o.a))}; }},
    {"distance_down", Side::below, direction_and_far_point,
     [](const Operands& o, const Norm& norm) {
       const Vector v = extended(o.a);
       return Vector{(dot(v, extended(o.b)) - norm.support(v)) / length(v)};
     }},
    {"gauge_terms_up, power outside,", Side::above, just_outside,
     [](const Operands&, const Norm&) { return Vector{1.0L}; }},
    {"direction_down", Side::below, two_points,
     [](const Operands& o, const Norm&) { return scaled(extended(o.a), 1.0L / length(extended(o.a))); }},
    {"test_point, position", Side::above, two_points,
     [](const Operands& o, const Norm&) {
       const Extended reach = Extended(o.b[0]) / o.b[1];
       return Vector{o.a[0] + reach * o.b[0], o.a[1] + reach * o.b[1], o.a[2] + reach * o.b[2]};
     }},
    {"separation_down, inside,", Side::below, just_inside, [](const Operands&, const Norm&) { return Vector{0.0L}; }},
    {"enclosure_from_afar", Side::below, direction_and_far_point,
     [](const Operands& o, const Norm& norm) { return Vector{from_afar(extended(o.b), norm)}; }},
    {"enclosure_from_afar, inside,", Side::below,
     [](oracle::RandomCases& random, const Norm& norm) {
       return Operands{with_gauge(random.uniform(0.0, 0.9), random, norm), {}};
     },
     [](const Operands& o, const Norm& norm) { return Vector{least_depth(extended(o.a), norm)}; }},
    {"log_norm, below,", Side::below, two_logarithms, log_norm},
    {"log_norm, above,", Side::above, two_logarithms, log_norm},
    {"gradient_over, below,", Side::below, two_points,
     [](const Operands& o, const Norm& norm) { return gradient_of_power(extended(o.a), norm); }},
    {"gradient_over, above,", Side::above, two_points,
     [](const Operands& o, const Norm& norm) { return gradient_of_power(extended(o.a), norm); }},
    {"factors_up", Side::above, two_points,
     [](const Operands& o, const Norm& norm) { return factors(extended(o.a), norm); }},
    {"section_shares_over, below,", Side::below, two_points,
     [](const Operands& o, const Norm& norm) { return Vector{section_terms(extended(o.a), norm).quotients[0]}; }},
    {"section_shares_over, above,", Side::above, two_points,
     [](const Operands& o, const Norm& norm) { return Vector{section_terms(extended(o.a), norm).quotients[0]}; }},
    {"section_turn_up", Side::above, two_points,
     [](const Operands& o, const Norm& norm) { return Vector{section_turn(extended(o.a), extended(o.b), norm)}; }},
    {"most_of", Side::above, two_points,
     [](const Operands& o, const Norm&) { return Vector{most_of(extended(o.a), extended(o.b))}; }},
    {"step_between, below,", Side::below, two_points,
     [](const Operands& o, const Norm&) { return Vector{std::fabs(Extended(o.a[0]) - o.b[0])}; }},
    {"step_between, above,", Side::above, two_points,
     [](const Operands& o, const Norm&) { return Vector{std::fabs(Extended(o.a[0]) - o.b[0])}; }},
    {"residual_up", Side::above, two_points,
     [](const Operands& o, const Norm&) {
       const auto [d_least, d_most] = std::minmax(o.b[1], o.b[2]);
       const auto [least, most] = std::minmax(o.a[0], o.a[1]);
       const Extended k = o.b[0];
       return Vector{std::max(std::fabs(most - k * d_least), std::fabs(least - k * d_most))};
     }},
    {"most_apart", Side::above, two_points,
     [](const Operands& o, const Norm&) {
       const Extended beyond = Extended(std::max(o.a[0], o.a[1])) - std::min(o.b[0], o.b[1]);
       return Vector{std::max(beyond, Extended(std::max(o.b[0], o.b[1])) - std::min(o.a[0], o.a[1]))};
     }},
    {"way_of, below,", Side::below, two_points,
     [](const Operands& o, const Norm&) {
       const Extended middle = Extended(o.a[0]) + o.a[1];
       return Vector{std::max(Extended(o.a[0]), middle - Extended(o.a[2]) * o.b[0])};
     }},
    {"way_of, above,", Side::above, two_points,
     [](const Operands& o, const Norm&) {
       return Vector{std::min(Extended(o.a[0]) + o.b[1], o.a[1] + Extended(o.a[2]) * o.b[0])};
     }},
    {"cosine_of", Side::above, two_points,
     [](const Operands& o, const Norm&) {
       const Extended size = o.b[0];
       return Vector{(1.0L - size * size / 2.0L) * o.a[0] / o.a[1]};
     }},
    {"power_up", Side::above, two_points,
     [](const Operands& o, const Norm& norm) {
       return Vector{std::pow(norm.gauge(extended(o.a)), norm.outer().primal)};
     }},
};

constexpr std::size_t samples = 512;     // of each bound and solid
constexpr cl_uint separation_down = 14;  // in the table above
constexpr Extended reference_error = 0x1p-40L;

// Whether a component lies on the wrong side of what it bounds; NaN does.
bool violated(Side side, const Point& result, const Vector& value) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Extended slack = reference_error * std::max(std::fabs(value[k]), 1.0L);
    if (!(side == Side::below ? result[k] <= value[k] + slack : result[k] >= value[k] - slack)) return true;
  }
  return false;
}

std::string described(const Bound& bound, const Operands& o, const Point& result, const Vector& value) {
  return fmt::format(
      "{} of ({:.17g}, {:.17g}, {:.17g}), ({:.17g}, {:.17g}, {:.17g}) gave ({:.17g}, {:.17g}, {:.17g}), "
      "which does not bound ({:.17g}, {:.17g}, {:.17g})",
      bound.name, o.a[0], o.a[1], o.a[2], o.b[0], o.b[1], o.b[2], result[0], result[1], result[2], value[0], value[1],
      value[2]);
}

/// A ball of radius t about q, and a quarter of a cell of directions (kernels/spherical_cell.clh) in one of which it
/// leaves the solid: the quarter must not be proven. Nor does it lie in the cone, for one of its corners does not.
struct OpenQuarter {
  Point q;
  std::array<double, 3> base;
  double inverted;
  double t;
  int quarter;  ///< 0 to 3
  Point axis;
  double cosine;
};

constexpr int grid = 8;  // directions on each side of a quarter

/// Corners 1, 2, 3 of the cell and the midpoints of the sides opposite to them, times two.
std::array<Vector, 6> shared_points(const std::array<double, 3>& base, double inverted) {
  std::array<Vector, 6> points{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      points[i][k] = 2.0L * (base[k] + (i == k ? 1.0L - inverted : Extended(inverted)));
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) points[3 + i][k] = (points[(i + 1) % 3][k] + points[(i + 2) % 3][k]) / 2.0L;
  return points;
}

/// The shortest way out over the quarter, as far as the grid sees it.
Extended least_way_out(const Vector& q, const std::array<Vector, 3>& corners, const Norm& norm) {
  Extended least = beyond_solids;
  for (int i = 0; i <= grid; ++i) {
    for (int j = 0; i + j <= grid; ++j) {
      Vector w{};
      for (std::size_t k = 0; k < 3; ++k) w[k] = i * corners[0][k] + j * corners[1][k] + (grid - i - j) * corners[2][k];
      least = std::min(least, way_out(q, w, norm));
    }
  }
  return least;
}

/// Between two of the corners, and just too narrow for the third.
void draw_cone(OpenQuarter& sample, const std::array<Vector, 3>& corners, oracle::RandomCases& random) {
  const std::size_t out = random.choice(3);
  const Vector& a = corners[(out + 1) % 3];
  const Vector& b = corners[(out + 2) % 3];
  const Vector between = along(scaled(a, 1.0L / length(a)), 1.0L / length(b), b);
  const Extended narrower = 1.0L + random.log_uniform(1e-11, 1e-2);
  for (std::size_t k = 0; k < 3; ++k) sample.axis[k] = static_cast<double>(between[k] / length(between));
  sample.cosine =
      static_cast<double>(narrower * dot(extended(sample.axis), corners[out]) / length(corners[out])) + 1e-12;
}

OpenQuarter open_quarter(oracle::RandomCases& random, const Norm& norm) {
  OpenQuarter sample{with_gauge(random.uniform(0.0, 0.9), random, norm), {}, 0.0, 0.0, 0, {}, 0.0};
  const auto level = random.choice(random.choice(2) == 0 ? 3 : 20);
  const auto side = std::size_t{1} << level;
  sample.inverted = level > 0 ? static_cast<double>(random.choice(2)) : 0.0;
  const std::size_t sum = side - 1 - static_cast<std::size_t>(sample.inverted);
  const std::size_t a = random.choice(sum + 1);
  const std::size_t b = random.choice(sum - a + 1);
  sample.base = {static_cast<double>(a), static_cast<double>(b), static_cast<double>(sum - a - b)};
  sample.quarter = static_cast<int>(random.choice(4));
  const auto points = shared_points(sample.base, sample.inverted);
  const auto n = static_cast<std::size_t>(sample.quarter);
  const std::array<Vector, 3> corners = n == 3
                                            ? std::array{points[3], points[4], points[5]}
                                            : std::array{points[n], points[3 + (n + 1) % 3], points[3 + (n + 2) % 3]};
  const Extended beyond = 1.0L + random.log_uniform(1e-9, 0.1);
  sample.t = static_cast<double>(beyond * least_way_out(extended(sample.q), corners, norm));
  draw_cone(sample, corners, random);
  return sample;
}

std::string described(const OpenQuarter& sample) {
  return fmt::format(
      "quarter {} of the {} cell ({}, {}, {}) is proven for the ball of radius {:.17g} about ({:.17g}, "
      "{:.17g}, {:.17g}), which leaves the solid there",
      sample.quarter + 1, sample.inverted == 0.0 ? "upright" : "inverted", sample.base[0], sample.base[1],
      sample.base[2], sample.t, sample.q[0], sample.q[1], sample.q[2]);
}

/// Sharp, smooth and flat; the largest semi-axis in [1, 2), as the kernels have it.
const Superquadric solids[] = {{{1.0, 1.5, 0.7}, {1.0, 1.0}},
                               {{1.1, 0.3, 0.6}, {0.3, 1.7}},
                               {{0.5, 1.2, 1.9}, {1.8, 0.4}},
                               {{1.2, 1.0, 1.4}, {0.12, 0.9}},
                               {{1.03, 1.0, 1.0}, {2.0, 2.0}}};

/// Wider at either end.
const Superquadric tapered_solids[] = {
    {{1.0, 1.5, 0.7}, {1.0, 1.0}, 9.0}, {{1.1, 0.3, 1.6}, {0.3, 1.7}, 0.1}, {{0.5, 1.2, 1.9}, {1.8, 0.4}, 1.3}};

/// Calls an entry point of `bound_kernel` whose arguments, from `first` on, are these.
Columns called(const CompiledKernels& kernels, cl::Kernel kernel, cl_uint first, const Superquadric& solid,
               const Columns& inputs, std::size_t outputs) {
  const std::size_t stride = inputs.front().size();
  std::vector<double> operands;
  for (const std::vector<double>& column : inputs) operands.insert(operands.end(), column.begin(), column.end());
  auto parameters = device::primitive_parameters({"", solid, {centre, {1.0, 0.0, 0.0, 0.0}}}, 0);
  const cl_mem_flags copied = CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR;
  const cl::Buffer input(kernels.context, copied, operands.size() * sizeof(double), operands.data());
  const cl::Buffer primitive(kernels.context, copied, sizeof parameters, &parameters);
  const cl::Buffer output(kernels.context, CL_MEM_WRITE_ONLY, outputs * stride * sizeof(double));
  const cl_ulong groups = stride / static_cast<std::size_t>(kernels.vector_width);
  kernel.setArg(first, groups);
  kernel.setArg(first + 1, input);
  kernel.setArg(first + 2, cl_ulong{stride});
  kernel.setArg(first + 3, primitive);
  kernel.setArg(first + 4, output);
  const cl::CommandQueue queue(kernels.context, kernels.device);
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups));
  Columns results(outputs, std::vector<double>(stride));
  for (std::size_t k = 0; k < outputs; ++k)
    queue.enqueueReadBuffer(output, CL_TRUE, k * stride * sizeof(double), stride * sizeof(double), results[k].data());
  return results;
}

Columns columns_of(const std::vector<Operands>& operands) {
  Columns columns(6);
  for (const auto& [a, b] : operands)
    for (std::size_t k = 0; k < 3; ++k) {
      columns[k].push_back(a[k]);
      columns[3 + k].push_back(b[k]);
    }
  return columns;
}

Columns columns_of(const std::vector<OpenQuarter>& quarters) {
  Columns columns(12);
  for (const OpenQuarter& sample : quarters) {
    for (std::size_t k = 0; k < 3; ++k) {
      columns[k].push_back(sample.q[k]);
      columns[3 + k].push_back(sample.base[k]);
      columns[8 + k].push_back(sample.axis[k]);
    }
    columns[6].push_back(sample.inverted);
    columns[7].push_back(sample.t);
    columns[11].push_back(sample.cosine);
  }
  return columns;
}

}  // namespace

std::string with_bound_kernel(const std::string& sources) {
  return sources + bound_kernel + open_caps_kernel;
}

struct BoundJudge::Samples {
  Superquadric solid;
  std::vector<std::vector<Operands>> operands;  ///< for each bound
  std::vector<std::vector<Vector>> values;
  std::vector<OpenQuarter> quarters;
  std::vector<OpenCap> caps;
};

struct BoundJudge::PointsInside {
  Superquadric solid;
  std::vector<Operands> points;
};

BoundJudge::BoundJudge() {
  oracle::RandomCases random(2011);
  for (const Superquadric& solid : solids) {
    const Norm norm(solid);
    Samples& of_solid = samples_.emplace_back(Samples{solid, {}, {}, {}, {}});
    for (const Bound& bound : bounds) {
      std::vector<Operands>& operands = of_solid.operands.emplace_back();
      std::vector<Vector>& values = of_solid.values.emplace_back();
      for (std::size_t i = 0; i < samples; ++i) {
        operands.push_back(bound.draw(random, norm));
        values.push_back(bound.value(operands.back(), norm));
      }
    }
    for (std::size_t i = 0; i < samples; ++i) of_solid.quarters.push_back(open_quarter(random, norm));
    for (std::size_t i = 0; i < samples; ++i) of_solid.caps.push_back(open_cap(random, norm));
  }
  for (const Superquadric& solid : tapered_solids) {
    PointsInside& of_solid = tapered_.emplace_back(PointsInside{solid, {}});
    for (const Point& x : just_inside_tapered(solid, centre, samples, random)) of_solid.points.push_back({x, {}});
  }
}

BoundJudge::~BoundJudge() = default;

std::string BoundJudge::operator()(const CompiledKernels& kernels) const {
  cl::Kernel evaluate_bound(kernels.program, "evaluate_bound");
  const cl::Kernel open_quarters(kernels.program, "open_quarters");
  const cl::Kernel open_caps(kernels.program, "open_caps");
  for (const auto& [solid, operands, values, quarters, caps] : samples_) {
    for (cl_uint index = 0; index < std::size(bounds); ++index) {
      evaluate_bound.setArg(0, index);
      const Columns results = called(kernels, evaluate_bound, 1, solid, columns_of(operands[index]), 3);
      for (std::size_t i = 0; i < samples; ++i) {
        const Point result{results[0][i], results[1][i], results[2][i]};
        if (violated(bounds[index].side, result, values[index][i]))
          return described(bounds[index], operands[index][i], result, values[index][i]);
      }
    }
    const std::vector<double> open = called(kernels, open_quarters, 0, solid, columns_of(quarters), 1).front();
    for (std::size_t i = 0; i < samples; ++i)
      if ((static_cast<long>(open[i]) & (1L << quarters[i].quarter)) == 0) return described(quarters[i]);
    const Columns found = called(kernels, open_caps, 0, solid, columns_of(caps), 3);
    for (std::size_t i = 0; i < samples; ++i) {
      if (found[0][i] != 0.0 || holds(found[1][i], caps[i])) return described(caps[i]);
      if (found[2][i] < caps[i].bend) return fmt::format("bend {:.17g}, {}", found[2][i], described(caps[i]));
    }
  }
  return false_separation(kernels);
}

std::string BoundJudge::false_separation(const CompiledKernels& kernels) const {
  cl::Kernel evaluate_bound(kernels.program, "evaluate_bound");
  evaluate_bound.setArg(0, separation_down);
  for (const auto& [solid, points] : tapered_) {
    const std::vector<double> apart = called(kernels, evaluate_bound, 1, solid, columns_of(points), 3).front();
    for (std::size_t i = 0; i < samples; ++i)
      if (apart[i] > 0.0)
        return fmt::format(
            "separation_down of ({:.17g}, {:.17g}, {:.17g}) gave {:.17g} inside a solid with the taper {}",
            points[i].a[0], points[i].a[1], points[i].a[2], apart[i], solid.taper);
  }
  return {};
}

}  // namespace verisq::mutation
