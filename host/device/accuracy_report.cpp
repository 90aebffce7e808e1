/// This file implements the accuracy report: every operation on the same samples, on a device or on the host, against
/// exact values rounded once.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include "host/device/device.hpp"
#include "host/device/sample_operations.hpp"
#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/real.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::device {
namespace {

using verify::Direction;
using verify::Interval;

constexpr std::size_t chunk = 1U << 15U;  // operands a launch

// ---------------------------------------------------------------- rows: operations on numbers

using Directed = double (*)(const Operands&, Direction);

struct NumberOperation {
  const char* name;
  unsigned down, up;  // in kernels/self_test.cl
  Operands (*draw)(SampleOperands&);
  Directed exact;
  Directed host;  // null where the host has none
};

template <Domain A, Domain B = Domain::line>
Operands draw(SampleOperands& samples) {
  return {samples.number(A), samples.number(B), 0.0};
}

/// Half of them cancel the rounded product: they reveal a contraction or a lost residual.
Operands draw_fused(SampleOperands& samples) {
  const Operands o{samples.number(Domain::line), samples.number(Domain::line), samples.number(Domain::line)};
  const bool cancels = samples.uniform() < 0.5 && std::isfinite(o.a * o.b);
  return {o.a, o.b, cancels ? -(o.a * o.b) : o.c};
}

/// An exponent in [EXP_LOWEST, EXP_HIGHEST] of kernels/arithmetic.clh; outside, the bounds are trivial.
Operands draw_exponent(SampleOperands& samples) {
  return {std::clamp(samples.number(Domain::exponent), -708.0, 709.0), 0.0, 0.0};
}

Operands draw_normal(SampleOperands& samples) {
  return {std::max(samples.number(Domain::nonnegative), std::numeric_limits<double>::min()), 0.0, 0.0};
}

/// A base in (0, 1] and an exponent with a power of at least about 2^-Range: errors of exponents grow with its
/// logarithm.
template <int Range>
Operands draw_unit_power(SampleOperands& samples) {
  const double logarithm = Range * samples.uniform();
  const double exponent = std::max(std::abs(samples.number(Domain::power)), logarithm / 1000.0);
  return {std::exp2(-logarithm / exponent), exponent, 0.0};
}

double exact_power(const Operands& o, Direction d) {
  return exact::power(o.a, o.b, d);
}
double host_power(const Operands& o, Direction d) {
  return verify::power(o.a, o.b, d);
}

const NumberOperation number_operations[] = {
    {"add", 7, 8, draw<Domain::line>, [](const Operands& o, Direction d) { return exact::sum(o.a, o.b, d); },
     [](const Operands& o, Direction d) { return verify::add(o.a, o.b, d); }},
    {"sub", 9, 10, draw<Domain::line>, [](const Operands& o, Direction d) { return exact::difference(o.a, o.b, d); },
     [](const Operands& o, Direction d) { return verify::subtract(o.a, o.b, d); }},
    {"mul", 11, 12, draw<Domain::line>, [](const Operands& o, Direction d) { return exact::product(o.a, o.b, d); },
     [](const Operands& o, Direction d) { return verify::multiply(o.a, o.b, d); }},
    {"div", 13, 14, draw<Domain::line, Domain::divisor>,
     [](const Operands& o, Direction d) { return exact::quotient(o.a, o.b, d); },
     [](const Operands& o, Direction d) { return verify::divide(o.a, o.b, d); }},
    {"fma", 15, 16, draw_fused, [](const Operands& o, Direction d) { return exact::fused(o.a, o.b, o.c, d); }, nullptr},
    {"sqrt", 17, 18, draw<Domain::nonnegative>, [](const Operands& o, Direction d) { return exact::root(o.a, d); },
     [](const Operands& o, Direction d) { return verify::square_root(o.a, d); }},
    {"exp", 19, 20, draw_exponent, [](const Operands& o, Direction d) { return exact::exponential(o.a, d); },
     [](const Operands& o, Direction d) { return verify::exponential(o.a, d); }},
    {"log", 21, 22, draw_normal, [](const Operands& o, Direction d) { return exact::logarithm(o.a, d); },
     [](const Operands& o, Direction d) { return verify::logarithm(o.a, d); }},
    {"pow_unit, power >= 2^-1", 23, 24, draw_unit_power<1>, exact_power, host_power},
    {"pow_unit, power >= 2^-52", 23, 24, draw_unit_power<52>, exact_power, host_power},
    {"pow_unit, power >= 2^-1020", 23, 24, draw_unit_power<1020>, exact_power, host_power},
    {"atan_ratio", 25, 26, draw<Domain::tangent>,
     [](const Operands& o, Direction d) { return exact::inverse_tangent_ratio(o.a, d); }, nullptr},
};

// ---------------------------------------------------------------- rows: operations on intervals

/// The operations of the host; they refuse operands without a result.
using OnHost = Interval (*)(const Interval&, const Interval&);

struct HostOperation {
  std::string_view name;
  OnHost operation;
};

const HostOperation host_operations[] = {
    {"interval_neg", [](const Interval& a, const Interval&) { return -a; }},
    {"interval_abs", [](const Interval& a, const Interval&) { return abs(a); }},
    {"interval_square", [](const Interval& a, const Interval&) { return square(a); }},
    {"interval_sqrt", [](const Interval& a, const Interval&) { return sqrt(a); }},
    {"interval_exp", [](const Interval& a, const Interval&) { return exp(a); }},
    {"interval_add", [](const Interval& a, const Interval& b) { return a + b; }},
    {"interval_sub", [](const Interval& a, const Interval& b) { return a - b; }},
    {"interval_mul", [](const Interval& a, const Interval& b) { return a * b; }},
    {"interval_div", [](const Interval& a, const Interval& b) { return a / b; }},
    {"interval_hull", [](const Interval& a, const Interval& b) { return hull(a, b); }},
};

/// Null if the host has no such operation, or one with another domain (log and pow refuse negative arguments).
OnHost on_host(std::string_view name) {
  const auto* const found = std::find_if(std::begin(host_operations), std::end(host_operations),
                                         [name](const HostOperation& candidate) { return candidate.name == name; });
  return found == std::end(host_operations) ? nullptr : found->operation;
}

struct IntervalRow {
  std::string name;
  unsigned index;         // in interval_operations() and kernels/self_test.cl
  double least, largest;  // sizes of the ends that are measured, besides 0
};

std::vector<IntervalRow> interval_rows() {
  std::vector<IntervalRow> rows;
  unsigned index = 0;
  for (const IntervalOperation& operation : interval_operations()) {
    // Errors of powers grow with their logarithms.
    if (operation.name == std::string_view("interval_pow"))
      rows.push_back({"interval_pow, ends in [2^-52, 2^52]", index, 0x1p-52, 0x1p52});
    rows.push_back({operation.name, index++, 0.0, infinity});
  }
  return rows;
}

// ---------------------------------------------------------------- measuring

class Worst {
 public:
  explicit Worst(std::string name) : row_{std::move(name), 0.0, 0.0, 0, 0} {}

  void record(double bound, double tightest, double inner, Direction direction) {
    const double place = exact::last_place(tightest, inner);
    const double outside = exact::units_outside(bound, tightest, place, direction);
    if (!(outside >= 0.0)) {  // NaN: no bound at all
      ++row_.unsound;
      return;
    }
    double& worst = direction == Direction::down ? row_.down : row_.up;
    worst = std::max(worst, outside);
  }
  void count_sample() { ++row_.samples; }
  void record_unsound() { ++row_.unsound; }

  [[nodiscard]] FunctionAccuracy row() const { return row_; }

 private:
  FunctionAccuracy row_;
};

FunctionAccuracy not_offered(std::string name) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  return {std::move(name), nothing, nothing, 0, 0};
}

/// The computer of the results: a device, or the host if it is null.
using Computer = OperationKernels*;

std::vector<double> compute(Computer kernels, const NumberOperation& operation, const std::vector<Operands>& operands,
                            Direction direction) {
  if (kernels != nullptr) return kernels->apply(direction == Direction::down ? operation.down : operation.up, operands);
  std::vector<double> results;
  results.reserve(operands.size());
  for (const Operands& o : operands) results.push_back(operation.host(o, direction));
  return results;
}

Ends compute_on_host(OnHost operation, const IntervalOperands& operands) {
  const auto& [a, b] = operands;
  try {
    const Interval result = operation({a.lo, a.hi}, {b.lo, b.hi});
    return {result.lower(), result.upper()};
  } catch (const std::domain_error&) {
    return empty_interval;
  }
}

std::vector<Ends> compute(Computer kernels, unsigned index, const std::vector<IntervalOperands>& operands) {
  if (kernels != nullptr) return kernels->apply_to_intervals(index, operands);
  const OnHost operation = on_host(interval_operations()[index].name);
  std::vector<Ends> results;
  results.reserve(operands.size());
  for (const IntervalOperands& o : operands) results.push_back(compute_on_host(operation, o));
  return results;
}

/// Overflow apart: there the kernels' bounds of numbers conclude nothing (NaN).
void measure(const NumberOperation& operation, const Operands& o, double down, double up, Worst& worst) {
  const double below = operation.exact(o, Direction::down);
  const double above = operation.exact(o, Direction::up);
  if (!(std::max(std::abs(below), std::abs(above)) < 0x1p1023)) return;
  worst.count_sample();
  worst.record(down, below, above, Direction::down);
  worst.record(up, above, below, Direction::up);
}

FunctionAccuracy measure(Computer kernels, const NumberOperation& operation, std::size_t samples) {
  if (kernels == nullptr && operation.host == nullptr) return not_offered(operation.name);
  SampleOperands source(754);
  Worst worst(operation.name);
  for (std::size_t done = 0; done < samples; done += chunk) {
    std::vector<Operands> operands(std::min(chunk, samples - done));
    for (Operands& o : operands) o = operation.draw(source);
    const std::vector<double> down = compute(kernels, operation, operands, Direction::down);
    const std::vector<double> up = compute(kernels, operation, operands, Direction::up);
    for (std::size_t i = 0; i < operands.size(); ++i) measure(operation, operands[i], down[i], up[i], worst);
  }
  return worst.row();
}

/// Containment everywhere; distances where the kernels promise any.
void measure(const IntervalRow& row, const IntervalOperands& o, Ends result, Worst& worst) {
  const IntervalOperation& operation = interval_operations()[row.index];
  const Ends outer = range_of(operation, o, Direction::down);
  if (is_empty(outer)) return;
  worst.count_sample();
  if (!(result.lo <= outer.lo && result.hi >= outer.hi)) return worst.record_unsound();
  const Ends inner = range_of(operation, o, Direction::up);
  const auto measured = [&](double end) {
    return std::isfinite(operation.slack(o.a, o.b, end)) &&
           (end == 0.0 || (std::abs(end) >= row.least && std::abs(end) <= row.largest));
  };
  if (measured(outer.lo)) worst.record(result.lo, outer.lo, inner.lo, Direction::down);
  if (measured(outer.hi)) worst.record(result.hi, outer.hi, inner.hi, Direction::up);
}

FunctionAccuracy measure(Computer kernels, const IntervalRow& row, std::size_t samples) {
  const IntervalOperation& operation = interval_operations()[row.index];
  if (kernels == nullptr && on_host(operation.name) == nullptr) return not_offered(row.name);
  SampleOperands source(1788);
  Worst worst(row.name);
  for (std::size_t done = 0; done < samples; done += chunk) {
    std::vector<IntervalOperands> operands(std::min(chunk, samples - done));
    for (IntervalOperands& o : operands) o = {source.interval(operation.a_domain), source.interval(operation.b_domain)};
    const std::vector<Ends> results = compute(kernels, row.index, operands);
    for (std::size_t i = 0; i < operands.size(); ++i) measure(row, operands[i], results[i], worst);
  }
  return worst.row();
}

std::vector<FunctionAccuracy> measure_all(Computer kernels, std::size_t samples,
                                          const std::function<void(double)>& progress) {
  const std::vector<IntervalRow> on_intervals = interval_rows();
  const std::size_t count = std::size(number_operations) + on_intervals.size();
  std::vector<FunctionAccuracy> rows;
  const auto finish = [&](FunctionAccuracy row) {
    rows.push_back(std::move(row));
    if (progress) progress(static_cast<double>(rows.size()) / static_cast<double>(count));
  };
  for (const NumberOperation& operation : number_operations) finish(measure(kernels, operation, samples));
  for (const IntervalRow& row : on_intervals) finish(measure(kernels, row, samples));
  return rows;
}

}  // namespace

std::vector<FunctionAccuracy> measure_accuracy(OperationKernels& kernels, std::size_t samples,
                                               const std::function<void(double)>& progress) {
  return measure_all(&kernels, samples, progress);
}

}  // namespace verisq::device

namespace verisq {

std::vector<FunctionAccuracy> host_accuracy(std::size_t samples, const std::function<void(double)>& progress) {
  return device::measure_all(nullptr, samples, progress);
}

std::vector<FunctionAccuracy> device_accuracy(std::size_t index, std::size_t samples,
                                              const std::function<void(double)>& progress) {
  const device::Selection selection = device::select_device(std::to_string(index));
  const device::Device& device = *selection.device;
  try {
    const cl::Program program =
        device::build_program(device.context, device.device, device.vector_width, device::self_test_sources());
    device::OperationKernels kernels(device.context, device.device, program, device.vector_width);
    return device::measure_accuracy(kernels, samples, progress);
  } catch (const cl::Error& error) {
    throw Error(ErrorKind::failure,
                fmt::format("{}: {} failed with OpenCL error {}", device.name, error.what(), error.err()));
  }
}

}  // namespace verisq
