/// This file implements the self-test of a device's arithmetic (docs/rounding.md §4).

#include <fmt/format.h>

#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "host/device/sample_operations.hpp"
#include "kernels/embedded_sources.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {
namespace {

// 2200 bits hold every sum and product of two binary64 numbers exactly, and fma but for extremes that are left out.
using Exact =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<660>, boost::multiprecision::et_off>;

enum class Promise { nearest, below, above };

struct Operation {
  const char* name;
  Promise promise;
  Exact (*value)(const Operands&);
  bool (*applies)(const Operands&);
  double tightness;  // largest |result - value| / |value| beyond underflow; 0 for exactly rounded operations
};

bool always(const Operands&) {
  return true;
}
bool divisor(const Operands& o) {
  return o.b != 0.0;
}
bool nonnegative(const Operands& o) {
  return o.a >= 0.0;
}
bool exponent_range(const Operands& o) {
  return std::abs(o.a) < 700.0;
}
bool positive_normal(const Operands& o) {
  return o.a >= std::numeric_limits<double>::min();
}
bool unit_base(const Operands& o) {
  return o.a >= 1e-300 && o.a <= 1.0 && o.b >= 0.0 && o.b <= 64.0;
}

Exact sum(const Operands& o) {
  return Exact(o.a) + o.b;
}
Exact difference(const Operands& o) {
  return Exact(o.a) - o.b;
}
Exact product(const Operands& o) {
  return Exact(o.a) * o.b;
}
Exact quotient(const Operands& o) {
  return Exact(o.a) / o.b;
}
Exact root(const Operands& o) {
  return sqrt(Exact(o.a));
}
Exact fused(const Operands& o) {
  return Exact(o.a) * o.b + o.c;
}
Exact rounded_twice(const Operands& o) {
  return Exact(o.a * o.b) + o.c;
}  // compiled with -ffp-contract=off

// Transcendental values to 200 bits: far more than the comparison needs, and fast.
using Extended =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<60>, boost::multiprecision::et_off>;
Exact exponential(const Operands& o) {
  return Exact(exp(Extended(o.a)));
}
Exact logarithm(const Operands& o) {
  return Exact(log(Extended(o.a)));
}
Exact power(const Operands& o) {
  return Exact(pow(Extended(o.a), Extended(o.b)));
}

Exact inverse_tangent_ratio(const Operands& o) {
  return o.a == 0.0 ? Exact(1.0) : Exact(atan(Extended(o.a)) / o.a);
}

// The order is that of kernels/self_test.cl.
constexpr double outward = 0x1p-51;  // two steps of a unit in the last place
const Operation operations[] = {
    {"a + b", Promise::nearest, sum, always, 0.0},
    {"a - b", Promise::nearest, difference, always, 0.0},
    {"a * b", Promise::nearest, product, always, 0.0},
    {"a / b", Promise::nearest, quotient, divisor, 0.0},
    {"sqrt", Promise::nearest, root, nonnegative, 0.0},
    {"fma", Promise::nearest, fused, always, 0.0},
    {"a * b + c without contraction", Promise::nearest, rounded_twice, always, 0.0},
    {"add_down", Promise::below, sum, always, outward},
    {"add_up", Promise::above, sum, always, outward},
    {"sub_down", Promise::below, difference, always, outward},
    {"sub_up", Promise::above, difference, always, outward},
    {"mul_down", Promise::below, product, always, outward},
    {"mul_up", Promise::above, product, always, outward},
    {"div_down", Promise::below, quotient, divisor, outward},
    {"div_up", Promise::above, quotient, divisor, outward},
    {"fma_down", Promise::below, fused, always, outward},
    {"fma_up", Promise::above, fused, always, outward},
    {"sqrt_down", Promise::below, root, nonnegative, outward},
    {"sqrt_up", Promise::above, root, nonnegative, outward},
    {"exp_down", Promise::below, exponential, exponent_range, 0x1p-50},
    {"exp_up", Promise::above, exponential, exponent_range, 0x1p-50},
    {"log_down", Promise::below, logarithm, positive_normal, 0x1p-50},
    {"log_up", Promise::above, logarithm, positive_normal, 0x1p-50},
    {"pow_unit_down", Promise::below, power, unit_base, 0x1p-40},
    {"pow_unit_up", Promise::above, power, unit_base, 0x1p-40},
    {"atan_ratio_down", Promise::below, inverse_tangent_ratio, always, 0x1.99p-50},
    {"atan_ratio_up", Promise::above, inverse_tangent_ratio, always, 0x1.99p-50},
};

std::vector<Operands> sample_operands() {
  std::vector<double> special = {0.0,
                                 -0.0,
                                 1.0,
                                 -1.0,
                                 2.0,
                                 0.5,
                                 3.0,
                                 1.0 / 3.0,
                                 0.1,
                                 1e300,
                                 -1e300,
                                 1e-300,
                                 0x1p-1022,
                                 0x1p-1074,
                                 0x1.fffffffffffffp-1,
                                 0x1.0000000000001p0,
                                 0x1.fffffffffffffp1023,
                                 0x1.6a09e667f3bcdp-1,
                                 0x1.6a09e667f3bcdp0,
                                 700.0,
                                 -700.0,
                                 0x1.62e42fefa39efp-1,
                                 -0x1.62e42fefa39efp-1,
                                 1e-8,
                                 53.0};
  std::vector<Operands> out;
  for (const double a : special) {
    for (const double b : special) {
      for (const double c : {0.0, -1.0, 1e-200, -a * b, a}) out.push_back({a, b, std::isfinite(c) ? c : 1.0});
    }
  }
  std::mt19937_64 generator(20110309);
  std::uniform_real_distribution<double> mantissa(1.0, 2.0);
  std::uniform_int_distribution<int> wide(-300, 300);
  std::uniform_int_distribution<int> narrow(-12, 9);
  std::bernoulli_distribution coin(0.5);
  const auto signed_number = [&](auto& exponents) {
    return std::ldexp(mantissa(generator), exponents(generator)) * (coin(generator) ? 1.0 : -1.0);
  };
  for (int i = 0; i < 2000; ++i) {
    const double a = signed_number(narrow);
    const double b = signed_number(narrow);
    out.push_back({a, b, signed_number(narrow)});
    out.push_back({a, b, -a * b});  // what contraction would give away
    out.push_back({signed_number(wide), signed_number(wide), signed_number(wide)});
    out.push_back({mantissa(generator) - 1.0, std::abs(b), a});    // bases of powers
    out.push_back({1.0 + std::ldexp(a, -40), std::abs(b), -1.0});  // logarithms near 0
  }
  return out;
}

double to_nearest(const Exact& value) {
  return value.convert_to<double>();
}

bool keeps(const Operation& operation, const Operands& operands, double result) {
  const Exact value = operation.value(operands);
  const double nearest = to_nearest(value);
  if (operation.promise == Promise::nearest) {
    // Subnormal results may be flushed: every bound allows for it.
    if (std::abs(nearest) < std::numeric_limits<double>::min()) return std::abs(result) <= 0x1p-1022;
    return result == nearest;
  }
  if (std::isnan(result)) return std::isinf(nearest);  // overflow on the way: nothing is concluded from NaN
  const bool below = operation.promise == Promise::below;
  if (std::isinf(result)) return (below == (result < 0.0)) && std::abs(nearest) >= 1e307;
  if (below ? Exact(result) > value : Exact(result) < value) return false;
  return abs(Exact(result) - value) <= abs(value) * operation.tightness + Exact(0x1p-1020);
}

std::string failure_on_numbers(OperationKernels& kernels) {
  const std::vector<Operands> operands = sample_operands();
  for (unsigned index = 0; index < std::size(operations); ++index) {
    const Operation& operation = operations[index];
    const std::vector<double> results = kernels.apply(index, operands);
    for (std::size_t i = 0; i < operands.size(); ++i) {
      const Operands& o = operands[i];
      if (!operation.applies(o) || keeps(operation, o, results[i])) continue;
      return fmt::format("{} of a = {:a}, b = {:a}, c = {:a} gave {:a}", operation.name, o.a, o.b, o.c, results[i]);
    }
  }
  return {};
}

std::vector<IntervalOperands> sample_intervals(const IntervalOperation& operation) {
  std::vector<IntervalOperands> operands = adversarial_intervals();
  SampleOperands samples(1788);
  for (int i = 0; i < 1000; ++i)
    operands.push_back({samples.interval(operation.a_domain), samples.interval(operation.b_domain)});
  return operands;
}

std::string failure_on_intervals(OperationKernels& kernels) {
  const auto operations_on_intervals = interval_operations();
  for (unsigned index = 0; index < operations_on_intervals.size(); ++index) {
    const IntervalOperation& operation = operations_on_intervals[index];
    const std::vector<IntervalOperands> operands = sample_intervals(operation);
    const std::vector<Ends> results = kernels.apply_to_intervals(index, operands);
    for (std::size_t i = 0; i < operands.size(); ++i) {
      const auto& [a, b] = operands[i];
      if (!operation.applies(a)) continue;
      if (fault(operation, operands[i], range_of(operation, operands[i]), results[i]).empty()) continue;
      return fmt::format("{} of a = [{:a}, {:a}], b = [{:a}, {:a}] gave [{:a}, {:a}]", operation.name, a.lo, a.hi, b.lo,
                         b.hi, results[i].lo, results[i].hi);
    }
  }
  return {};
}

}  // namespace

std::string self_test_sources() {
  return std::string(kernels::embedded_arithmetic_layers()).append(kernels::embedded_self_test());
}

std::string self_test(const cl::Context& context, const cl::Device& device, const cl::Program& program,
                      int vector_width) {
  OperationKernels kernels(context, device, program, vector_width);
  std::string failure = failure_on_numbers(kernels);
  return failure.empty() ? failure_on_intervals(kernels) : failure;
}

}  // namespace verisq::device
