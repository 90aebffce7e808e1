/// Operations of the kernels on sample operands, beside the exact ranges: the self-test of a device, and a report of
/// how accurate it is.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/device.hpp"

// Operations of the kernels on sample operands, beside the exact ranges.

namespace verisq::device::exact {

// The exact value of an operation, rounded once in a given direction: the tightest binary64 bound there is, by MPFR.

using verify::Direction;

// Operands are bounds of real numbers, as in verify/numbers/rounding.hpp: 0 times an infinity is 0. Shares no code with
// the functions there, which the accuracy report measures against these.

[[nodiscard]] double sum(double a, double b, Direction direction);
[[nodiscard]] double difference(double a, double b, Direction direction);
[[nodiscard]] double product(double a, double b, Direction direction);
/// NaN for 0 / 0 and for two infinities; otherwise the sign of a zero divisor is that of the infinite quotient.
[[nodiscard]] double quotient(double a, double b, Direction direction);
/// a b + c
[[nodiscard]] double fused(double a, double b, double c, Direction direction);
[[nodiscard]] double root(double a, Direction direction);
[[nodiscard]] double exponential(double a, Direction direction);
[[nodiscard]] double logarithm(double a, Direction direction);
/// base^exponent for base >= 0; 0^0 = 1.
[[nodiscard]] double power(double base, double exponent, Direction direction);
/// atan(a)/a, 1 at 0 and 0 at the infinities.
[[nodiscard]] double inverse_tangent_ratio(double a, Direction direction);

/// The last place of the exact value whose roundings down and up these are: the distance of the two binary64 numbers
/// around it; where it is one itself, of those above its magnitude. At least 2^-1022, the slack of
/// kernels/arithmetic.clh.
[[nodiscard]] double last_place(double rounded_down, double rounded_up);

/// How far `bound` lies outside `tightest`, in units of `last_place`; infinite bounds count as 2^1024. Negative where
/// it lies inside: there it bounds nothing.
[[nodiscard]] double units_outside(double bound, double tightest, double last_place, Direction direction);

}  // namespace verisq::device::exact

namespace verisq::device {

// Adversarial and random operands, for measuring and testing arithmetic.

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
  tangent,   ///< mostly in [-2, 2], or near a number at which kernels/arithmetic.clh changes its course
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

// The interval operations of kernels/arithmetic.clh: the exact range of each, and how
// tight the kernels promise to be.

struct IntervalOperation {
  const char* name;
  int operands;               ///< 1 or 2: an operation of one ignores `b`
  Domain a_domain, b_domain;  ///< where sampled operands come from
  bool (*applies)(Ends a);    ///< whether the operation's precondition holds

  /// The exact range over nonempty a and b, its lower end rounded in the direction `lower`, its upper end in the
  /// opposite one: the tightest enclosure for Direction::down. Empty where the operation is defined nowhere.
  Ends (*range)(Ends a, Ends b, verify::Direction lower);

  /// How far outside the end `tightest` of the range over a and b the kernels' end may lie; infinite where they promise
  /// containment alone.
  double (*slack)(Ends a, Ends b, double tightest);
};

/// In the order of `apply_interval_operation` in kernels/self_test.cl.
[[nodiscard]] std::span<const IntervalOperation> interval_operations();

/// The range over any a and b: empty operands give an empty result, but for the hull, where they are neutral.
[[nodiscard]] Ends range_of(const IntervalOperation& operation, const IntervalOperands& operands,
                            verify::Direction lower = verify::Direction::down);

/// The fault of `result` as an enclosure of the nonempty or empty `range` over these operands: "misses" if it does not
/// contain the range, "too wide" beyond the promised slack, empty if there is none.
[[nodiscard]] std::string fault(const IntervalOperation& operation, const IntervalOperands& operands, Ends range,
                                Ends result);

// Single operations of the kernels on arrays of operands: how the self-test and the accuracy report see a device.

/// The entry points of kernels/self_test.cl, which number the operations. Any number of operands, one result each.
class OperationKernels {
 public:
  /// `vector_width` must be the program's. Throws cl::Error, as all members do.
  OperationKernels(const cl::Context& context, const cl::Device& device, const cl::Program& program, int vector_width);

  [[nodiscard]] std::vector<double> apply(unsigned operation, std::span<const Operands> operands);
  [[nodiscard]] std::vector<Ends> apply_to_intervals(unsigned operation, std::span<const IntervalOperands> operands);

 private:
  using Column = std::vector<double>;
  std::vector<Column> run(cl::Kernel& kernel, unsigned operation, std::vector<Column> inputs, std::size_t outputs);

  cl::Context context_;
  cl::CommandQueue queue_;
  cl::Kernel on_numbers_;
  cl::Kernel on_intervals_;
  std::size_t vector_width_;
};

// Proves on samples that a device computes as the kernels' proofs assume, before anything else is believed of it.

/// The program of the self-test: the arithmetic layers as every program has them, and its kernels.
[[nodiscard]] std::string self_test_sources();

/// Every rounding primitive, elementary function and interval operation of the kernels on adversarial and random
/// operands, against MPFR.
/// Returns an empty string, or one line with the first operation that failed, its operands and result.
/// `program` is compiled from `self_test_sources`, `vector_width` is its.
[[nodiscard]] std::string self_test(const cl::Context& context, const cl::Device& device, const cl::Program& program,
                                    int vector_width);

// Measures how far the directed operations of a device lie outside the tightest bounds.

/// The rows of `device_accuracy` for kernels that need not have passed the self-test.
[[nodiscard]] std::vector<FunctionAccuracy> measure_accuracy(OperationKernels& kernels, std::size_t samples,
                                                             const std::function<void(double)>& progress);

}  // namespace verisq::device
