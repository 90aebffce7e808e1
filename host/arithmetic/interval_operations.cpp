/// This file implements the exact ranges: from the corners of the operands, by MPFR, and case by case where an
/// operation is not defined everywhere. It shares no code with verify/numbers/interval.hpp, so that each tests the
/// other.
#include "host/arithmetic/interval_operations.hpp"

#include <algorithm>
#include <cmath>

#include "host/arithmetic/exact_rounding.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {
namespace {

using verify::Direction;

constexpr Ends entire{-infinity, infinity};

constexpr Direction opposite(Direction direction) {
  return direction == Direction::down ? Direction::up : Direction::down;
}

bool contains_zero_inside(Ends a) {
  return a.lo < 0.0 && a.hi > 0.0;
}

bool is_zero(Ends a) {
  return a.lo == 0.0 && a.hi == 0.0;
}

// ---------------------------------------------------------------- ranges

/// For operations monotone in each operand on its own.
Ends corners(double (*value)(double, double, Direction), Ends a, Ends b, Direction lower) {
  Ends range{infinity, -infinity};
  for (const double x : {a.lo, a.hi}) {
    for (const double y : {b.lo, b.hi}) {
      range.lo = std::min(range.lo, value(x, y, lower));
      range.hi = std::max(range.hi, value(x, y, opposite(lower)));
    }
  }
  return range;
}

Ends negative(Ends a, Ends, Direction) {
  return {-a.hi, -a.lo};
}

Ends magnitude(Ends a, Ends, Direction) {
  return {std::max({0.0, a.lo, -a.hi}), std::max(-a.lo, a.hi)};
}

Ends square(Ends a, Ends b, Direction lower) {
  const Ends size = magnitude(a, b, lower);
  return {exact::product(size.lo, size.lo, lower), exact::product(size.hi, size.hi, opposite(lower))};
}

Ends root(Ends a, Ends, Direction lower) {
  if (a.hi < 0.0) return empty_interval;
  return {exact::root(std::max(a.lo, 0.0), lower), exact::root(std::max(a.hi, 0.0), opposite(lower))};
}

Ends exponential(Ends a, Ends, Direction lower) {
  return {exact::exponential(a.lo, lower), exact::exponential(a.hi, opposite(lower))};
}

Ends logarithm(Ends a, Ends, Direction lower) {
  if (a.hi <= 0.0) return empty_interval;
  return {exact::logarithm(std::max(a.lo, 0.0), lower), exact::logarithm(a.hi, opposite(lower))};
}

/// Falls with the distance from 0.
Ends inverse_tangent_ratio(Ends a, Ends b, Direction lower) {
  const Ends size = magnitude(a, b, lower);
  return {exact::inverse_tangent_ratio(size.hi, lower), exact::inverse_tangent_ratio(size.lo, opposite(lower))};
}

Ends sum(Ends a, Ends b, Direction lower) {
  return {exact::sum(a.lo, b.lo, lower), exact::sum(a.hi, b.hi, opposite(lower))};
}

Ends difference(Ends a, Ends b, Direction lower) {
  return {exact::difference(a.lo, b.hi, lower), exact::difference(a.hi, b.lo, opposite(lower))};
}

Ends product(Ends a, Ends b, Direction lower) {
  return corners(exact::product, a, b, lower);
}

/// At a corner of a box whose divisors have one sign. Where numerator and divisor vanish together, or grow together,
/// the corner is no value; 0 is a value beside it, or a limit of values.
double corner_quotient(double a, double b, Direction direction) {
  return (a == 0.0 && b == 0.0) || (std::isinf(a) && std::isinf(b)) ? 0.0 : exact::quotient(a, b, direction);
}

Ends quotient(Ends a, Ends b, Direction lower) {
  if (is_zero(b)) return empty_interval;
  if (is_zero(a)) return {0.0, 0.0};
  if (contains_zero_inside(b)) return entire;
  // A divisor's end 0 is approached from within.
  const Ends approached{b.lo == 0.0 ? 0.0 : b.lo, b.hi == 0.0 ? -0.0 : b.hi};
  return corners(corner_quotient, a, approached, lower);
}

Ends power(Ends a, Ends b, Direction lower) {
  if (a.hi < 0.0 || (a.hi == 0.0 && b.hi <= 0.0)) return empty_interval;
  if (a.hi == 0.0) return {0.0, 0.0};
  return corners(exact::power, {std::max(a.lo, 0.0), a.hi}, b, lower);
}

/// a.lo b + a: apply_interval_operation has no third operand.
Ends scaled_add(Ends a, Ends b, Direction lower) {
  const double scale = a.lo;
  return {exact::fused(scale, scale < 0.0 ? b.hi : b.lo, a.lo, lower),
          exact::fused(scale, scale < 0.0 ? b.lo : b.hi, a.hi, opposite(lower))};
}

Ends minimum(Ends a, Ends b, Direction) {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}

Ends maximum(Ends a, Ends b, Direction) {
  return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
}

Ends hull(Ends a, Ends b, Direction) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

Ends intersection(Ends a, Ends b, Direction) {
  const Ends both{std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
  return both.lo <= both.hi ? both : empty_interval;
}

// ---------------------------------------------------------------- promises of interval.clh, inverse_tangent.clh

double none(Ends, Ends, double) {
  return 0.0;
}

/// Two units of the exact value's last place. It lies inside `tightest` by less than a unit: below a power of two its
/// unit is half of that power's.
double two_units(Ends, Ends, double tightest) {
  const double inside = std::nextafter(tightest, 0.0);
  return 2.0 * exact::last_place(inside, inside);
}

/// For ends with exponents in [EXP_LOWEST, EXP_HIGHEST] of kernels/elementary.clh; below, 0 or a smallest normal
/// number.
double of_exponential(Ends, Ends, double tightest) {
  if (tightest > 8.2e307) return infinity;
  return 0x1p-50 * tightest + 0x1p-1021;
}

/// For normal arguments; the logarithms of others lie below that of the smallest one.
double of_logarithm(Ends, Ends, double tightest) {
  return tightest < -708.39 ? infinity : 0x1p-50 * std::abs(tightest);
}

bool is_subnormal(double x) {
  return std::fpclassify(x) == FP_SUBNORMAL;
}

double of_power(Ends a, Ends, double tightest) {
  if (tightest > 8.2e307 || is_subnormal(a.lo) || is_subnormal(a.hi)) return infinity;
  if (tightest < 0x1p-1021) return 0x1p-1020;
  return 0x1p-49 * tightest * (1.0 + std::abs(std::log(tightest)));
}

/// The last term: beyond ATAN_HIGHEST of kernels/inverse_tangent.clh bounds are 0 and that of the value there.
double of_inverse_tangent_ratio(Ends, Ends, double tightest) {
  return 0x1.ap-50 * tightest + 0x1p-1020;
}

// ---------------------------------------------------------------- preconditions

bool always(Ends) {
  return true;
}

/// The scale is a finite number.
bool finite_scale(Ends a) {
  return is_empty(a) || std::isfinite(a.lo);
}

const IntervalOperation all_operations[] = {
    {"interval_neg", 1, Domain::line, Domain::line, always, negative, none},
    {"interval_abs", 1, Domain::line, Domain::line, always, magnitude, none},
    {"interval_square", 1, Domain::line, Domain::line, always, square, two_units},
    {"interval_sqrt", 1, Domain::line, Domain::line, always, root, two_units},
    {"interval_exp", 1, Domain::exponent, Domain::line, always, exponential, of_exponential},
    {"interval_log", 1, Domain::base, Domain::line, always, logarithm, of_logarithm},
    {"interval_add", 2, Domain::line, Domain::line, always, sum, two_units},
    {"interval_sub", 2, Domain::line, Domain::line, always, difference, two_units},
    {"interval_mul", 2, Domain::line, Domain::line, always, product, two_units},
    {"interval_div", 2, Domain::line, Domain::line, always, quotient, two_units},
    {"interval_pow", 2, Domain::base, Domain::power, always, power, of_power},
    {"interval_scaled_add", 2, Domain::bounded_below, Domain::line, finite_scale, scaled_add, two_units},
    {"interval_min", 2, Domain::line, Domain::line, always, minimum, none},
    {"interval_max", 2, Domain::line, Domain::line, always, maximum, none},
    {"interval_hull", 2, Domain::line, Domain::line, always, hull, none},
    {"interval_intersection", 2, Domain::line, Domain::line, always, intersection, none},
    {"interval_atan_ratio", 1, Domain::tangent, Domain::line, always, inverse_tangent_ratio, of_inverse_tangent_ratio},
};

}  // namespace

std::span<const IntervalOperation> interval_operations() {
  return all_operations;
}

Ends range_of(const IntervalOperation& operation, const IntervalOperands& operands, Direction lower) {
  const auto& [a, b] = operands;
  if (operation.range == hull && is_empty(a)) return b;
  if (operation.range == hull && is_empty(b)) return a;
  if (is_empty(a) || (operation.operands == 2 && is_empty(b))) return empty_interval;
  return operation.range(a, b, lower);
}

std::string fault(const IntervalOperation& operation, const IntervalOperands& operands, Ends range, Ends result) {
  if (is_empty(range)) return is_empty(result) ? "" : "too wide";
  if (!(result.lo <= range.lo && result.hi >= range.hi)) return "misses";
  const auto too_far = [&](double bound, double tightest, Direction direction) {
    const double slack = operation.slack(operands.a, operands.b, tightest);
    return bound != tightest && std::isfinite(slack) && exact::units_outside(bound, tightest, 1.0, direction) > slack;
  };
  return too_far(result.lo, range.lo, Direction::down) || too_far(result.hi, range.hi, Direction::up) ? "too wide" : "";
}

}  // namespace verisq::device
