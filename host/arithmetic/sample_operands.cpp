/// This file implements the choice of operands: what breaks arithmetic is near powers of two, zero, infinity and ties.
#include "host/arithmetic/sample_operands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "verisq/enclosure.hpp"

namespace verisq::device {
namespace {

constexpr double largest = std::numeric_limits<double>::max();
constexpr double smallest = std::numeric_limits<double>::denorm_min();

}  // namespace

double SampleOperands::any() {
  static constexpr std::array special{0.0,
                                      -0.0,
                                      1.0,
                                      -1.0,
                                      2.0,
                                      0.5,
                                      0x1p-1022,
                                      -0x1p-1022,
                                      smallest,
                                      0x1p-1060,
                                      largest,
                                      -largest,
                                      0x1.fffffffffffffp-1,
                                      0x1.0000000000001p0,
                                      0x1.6a09e667f3bcdp-1,
                                      0x1.6a09e667f3bccp0,
                                      -708.0,
                                      709.0};
  const std::uint64_t kind = one_of(10);
  if (kind == 0) return special[one_of(special.size())];
  const double sign = one_of(2) == 0 ? 1.0 : -1.0;
  if (kind == 1) return sign * (1.0 + std::ldexp(uniform(), -static_cast<int>(one_of(53))));
  const int range = kind < 8 ? 12 : 1070;
  const int exponent = std::min(static_cast<int>(one_of(2 * static_cast<std::uint64_t>(range))) - range, 1023);
  return sign * std::ldexp(1.0 + uniform(), exponent);
}

double SampleOperands::moderate() {
  return std::ldexp(1.0 + uniform(), static_cast<int>(one_of(13)) - 7);
}

double SampleOperands::tangent() {
  static constexpr std::array borders{1.0, 0x1p1021, 0x1p-511, 0x1p-1022};  // where s^2 and s become subnormal
  const double sign = one_of(2) == 0 ? 1.0 : -1.0;
  if (one_of(4) != 0) return sign * 2.0 * uniform();
  const double border = borders[one_of(borders.size())];
  return sign * border * (1.0 + std::ldexp(uniform() - 0.5, -static_cast<int>(one_of(53))));
}

double SampleOperands::number(Domain domain) {
  switch (domain) {
    case Domain::line:
    case Domain::bounded_below: return any();
    case Domain::divisor: {
      const double x = any();
      return x == 0.0 ? 1.0 : x;
    }
    case Domain::nonnegative: return std::abs(any());
    case Domain::exponent: return one_of(5) == 0 ? any() : 740.0 * (2.0 * uniform() - 1.0);
    case Domain::base: return one_of(5) == 0 ? any() : moderate();
    case Domain::tangent: return one_of(5) == 0 ? any() : tangent();
    case Domain::power: break;
  }
  if (one_of(5) == 0) return any();
  return one_of(2) == 0 ? moderate() : -moderate();
}

Ends SampleOperands::interval(Domain domain) {
  const double x = number(domain);
  Ends drawn{x, x};
  switch (one_of(8)) {
    case 0: break;
    case 1: drawn.hi = std::nextafter(x, infinity); break;
    case 2: drawn.lo = 0.0; break;
    case 3: drawn.lo = infinity; break;
    case 4: drawn.lo = -infinity; break;
    default: drawn.lo = number(domain); break;
  }
  if (one_of(64) == 0) drawn = {-infinity, infinity};
  if (drawn.lo > drawn.hi) std::swap(drawn.lo, drawn.hi);
  drawn.lo = std::min(drawn.lo, largest);
  drawn.hi = std::max(drawn.hi, -largest);
  if (domain == Domain::bounded_below) drawn.lo = std::max(drawn.lo, -largest);
  return drawn;
}

std::vector<IntervalOperands> adversarial_intervals() {
  constexpr std::array ends{-infinity, -largest, -2.0, -smallest, -0.0, 0.0, smallest, 0.5, 1.0, 3.0, infinity};
  std::vector<Ends> intervals{empty_interval};
  for (const double lo : ends) {
    for (const double hi : ends) {
      if (lo <= hi && lo < infinity && hi > -infinity) intervals.push_back({lo, hi});
    }
  }
  std::vector<IntervalOperands> pairs;
  for (const Ends a : intervals) {
    for (const Ends b : intervals) pairs.push_back({a, b});
  }
  return pairs;
}

}  // namespace verisq::device
