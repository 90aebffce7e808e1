/// Adversarial and random operands, for measuring and testing arithmetic.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace verisq::device {

struct Operands {
  double a, b, c;
};

/// An interval as the kernels have it: both ends NaN stand for the empty set.
struct Ends {
  double lo, hi;
};

constexpr Ends empty_interval{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

[[nodiscard]] inline bool is_empty(Ends a) {
  return std::isnan(a.lo) && std::isnan(a.hi);
}

struct IntervalOperands {
  Ends a, b;
};

/// Where an operand is drawn from.
enum class Domain {
  line,           ///< all finite numbers, signed zeros and subnormal ones included; intervals may have infinite ends
  bounded_below,  ///< the same, but for a lower end -inf
  divisor,        ///< finite numbers but for 0
  nonnegative,
  exponent,  ///< mostly where the exponential is a normal number
  base,      ///< mostly positive and of moderate size
  power,     ///< mostly of moderate size
  tangent,   ///< mostly in [-2, 2], or near a number at which kernels/inverse_tangent.clh changes its course
};

/// An endless sequence of operands that depends on the seed alone.
class SampleOperands {
 public:
  explicit SampleOperands(std::uint64_t seed) : generator_(seed) {}

  /// Finite.
  [[nodiscard]] double number(Domain domain);

  /// In [0, 1).
  [[nodiscard]] double uniform() { return std::uniform_real_distribution(0.0, 1.0)(generator_); }

  /// Points, neighbours, wide ones, with 0 inside or at an end, half-lines, the whole line; never empty.
  [[nodiscard]] Ends interval(Domain domain);

 private:
  double any();
  double moderate();
  double tangent();
  std::uint64_t one_of(std::uint64_t count) { return generator_() % count; }

  std::mt19937_64 generator_;
};

/// Every pair of intervals whose ends are zeros of both signs, infinities, numbers at the limits of binary64 or simple
/// ones, and the empty set.
[[nodiscard]] std::vector<IntervalOperands> adversarial_intervals();

}  // namespace verisq::device
