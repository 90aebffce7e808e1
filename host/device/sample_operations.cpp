/// This file implements sample_operations.hpp.
#include "host/device/sample_operations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "verify/numbers/real.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device::exact {
namespace {

using Binary64 = verify::MpfrNumber<53>;

template <class Operation, class... Operands>
double rounded(Operation operation, Direction direction, Operands... operands) {
  return verify::rounded_result<53>(operation, direction, Binary64(operands).get()...).to_double(direction);
}

/// 2^1024 where x is infinite, halved so that it is a number.
double half(double x) {
  return std::isinf(x) ? std::copysign(0x1p1023, x) : x / 2.0;
}

}  // namespace

double sum(double a, double b, Direction direction) {
  return rounded(mpfr_add, direction, a, b);
}

double difference(double a, double b, Direction direction) {
  return rounded(mpfr_sub, direction, a, b);
}

double product(double a, double b, Direction direction) {
  return a == 0.0 || b == 0.0 ? 0.0 : rounded(mpfr_mul, direction, a, b);
}

double quotient(double a, double b, Direction direction) {
  return rounded(mpfr_div, direction, a, b);
}

double fused(double a, double b, double c, Direction direction) {
  return a == 0.0 || b == 0.0 ? c : rounded(mpfr_fma, direction, a, b, c);
}

double root(double a, Direction direction) {
  return rounded(mpfr_sqrt, direction, a);
}

double exponential(double a, Direction direction) {
  verify::release_mpfr_cache_at_thread_exit();
  return rounded(mpfr_exp, direction, a);
}

double logarithm(double a, Direction direction) {
  verify::release_mpfr_cache_at_thread_exit();
  return rounded(mpfr_log, direction, a);
}

double power(double base, double exponent, Direction direction) {
  verify::release_mpfr_cache_at_thread_exit();
  return rounded(mpfr_pow, direction, base == 0.0 ? 0.0 : base, exponent);  // to MPFR -0 is negative
}

/// The arc is rounded too, in the same direction, but 200 bits further right: no binary64 number lies in between.
double inverse_tangent_ratio(double a, Direction direction) {
  verify::release_mpfr_cache_at_thread_exit();
  if (a == 0.0) return 1.0;
  const verify::MpfrNumber<256> size(std::abs(a));
  const auto arc = verify::rounded_result<256>(mpfr_atan, direction, size.get());
  return verify::rounded_result<53>(mpfr_div, direction, arc.get(), size.get()).to_double(direction);
}

double last_place(double rounded_down, double rounded_up) {
  const double size = std::min(std::abs(rounded_down), std::abs(rounded_up));
  if (!(size >= std::numeric_limits<double>::min())) return 0x1p-1022;
  const double capped = std::min(size, std::numeric_limits<double>::max());
  return std::max(std::ldexp(1.0, std::ilogb(capped) - 52), 0x1p-1022);
}

double units_outside(double bound, double tightest, double last_place, Direction direction) {
  if (bound == tightest) return 0.0;
  const double outside = direction == Direction::down ? half(tightest) - half(bound) : half(bound) - half(tightest);
  return outside / (last_place / 2.0);
}

}  // namespace verisq::device::exact

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

/// The range of an operation that is monotone in each operand on its own.
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

/// The quotient at a corner of a box whose divisors have one sign. If numerator and divisor vanish together, or grow
/// together, the corner has no value; 0 is a value beside it, or a limit of values.
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

// ---------------------------------------------------------------- promises of arithmetic.clh

double none(Ends, Ends, double) {
  return 0.0;
}

/// Two units of the exact value's last place. It lies inside `tightest` by less than a unit: below a power of two its
/// unit is half of that power's.
double two_units(Ends, Ends, double tightest) {
  const double inside = std::nextafter(tightest, 0.0);
  return 2.0 * exact::last_place(inside, inside);
}

/// For ends with exponents in [EXP_LOWEST, EXP_HIGHEST] of kernels/arithmetic.clh; below, 0 or a smallest normal
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

/// The last term: beyond ATAN_HIGHEST of kernels/arithmetic.clh bounds are 0 and that of the value there.
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

OperationKernels::OperationKernels(const cl::Context& context, const cl::Device& device, const cl::Program& program,
                                   int vector_width)
    : context_(context),
      queue_(context, device),
      on_numbers_(program, "apply_operation"),
      on_intervals_(program, "apply_interval_operation"),
      vector_width_(static_cast<std::size_t>(vector_width)) {}

std::vector<double> OperationKernels::apply(unsigned operation, std::span<const Operands> operands) {
  std::vector<Column> inputs(3);
  for (const Operands& o : operands) {
    inputs[0].push_back(o.a);
    inputs[1].push_back(o.b);
    inputs[2].push_back(o.c);
  }
  Column results = run(on_numbers_, operation, std::move(inputs), 1).front();
  results.resize(operands.size());
  return results;
}

std::vector<Ends> OperationKernels::apply_to_intervals(unsigned operation, std::span<const IntervalOperands> operands) {
  std::vector<Column> inputs(4);
  for (const IntervalOperands& o : operands) {
    inputs[0].push_back(o.a.lo);
    inputs[1].push_back(o.a.hi);
    inputs[2].push_back(o.b.lo);
    inputs[3].push_back(o.b.hi);
  }
  const std::vector<Column> columns = run(on_intervals_, operation, std::move(inputs), 2);
  std::vector<Ends> results;
  for (std::size_t i = 0; i < operands.size(); ++i) results.push_back({columns[0][i], columns[1][i]});
  return results;
}

// Columns are filled up with ones to whole vectors.
std::vector<OperationKernels::Column> OperationKernels::run(cl::Kernel& kernel, unsigned operation,
                                                            std::vector<Column> inputs, std::size_t outputs) {
  const std::size_t groups = (inputs.front().size() + vector_width_ - 1) / vector_width_;
  if (groups == 0) return std::vector<Column>(outputs);
  const std::size_t bytes = groups * vector_width_ * sizeof(double);
  cl_uint argument = 0;
  kernel.setArg(argument++, static_cast<cl_uint>(operation));
  kernel.setArg(argument++, static_cast<cl_ulong>(groups));
  std::vector<cl::Buffer> buffers;  // kept alive until the kernel has run
  for (Column& input : inputs) {
    input.resize(groups * vector_width_, 1.0);
    buffers.emplace_back(context_, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, bytes, input.data());
    kernel.setArg(argument++, buffers.back());
  }
  for (std::size_t i = 0; i < outputs; ++i) {
    buffers.emplace_back(context_, CL_MEM_WRITE_ONLY, bytes);
    kernel.setArg(argument++, buffers.back());
  }
  // PoCL compiles a kernel again for each size of work-groups; for groups of one work-item the compilation is fastest.
  queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups),
                              vector_width_ > 1 ? cl::NDRange(1) : cl::NullRange);
  std::vector<Column> results(outputs, Column(groups * vector_width_));
  for (std::size_t i = 0; i < outputs; ++i) {
    queue_.enqueueReadBuffer(buffers[inputs.size() + i], CL_TRUE, 0, bytes, results[i].data());
  }
  return results;
}

}  // namespace verisq::device
