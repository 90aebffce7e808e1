/// Interval arithmetic on the host and in the kernels, operation by operation, with the semantics of IEEE 1788-2015
/// (set-based flavour): at the limits of binary64 and for operations that the vectors of interval_vectors_test.cpp
/// lack, and against exact ranges of random operands.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host/device/device.hpp"
#include "host/device/sample_operations.hpp"
#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {
namespace {

using verify::Interval;

constexpr double inf = infinity;
constexpr double max = std::numeric_limits<double>::max();
constexpr double tiny = 0x1p-1074;
constexpr double normal = 0x1p-1022;
constexpr double below_one = 0x1.fffffffffffffp-1;
constexpr double above_one = 0x1.0000000000001p0;
constexpr Ends entire{-inf, inf};
constexpr Ends empty = empty_interval;
constexpr Ends unused{1.0, 1.0};

constexpr std::size_t random_samples = 100'000;

/// A result is the tightest enclosure in binary64.
struct Vector {
  const char* operation;
  Ends a, b;
  Ends tightest;
};

const std::vector<Vector> vectors = {
    {"neg", {-0.0, inf}, unused, {-inf, 0}},
    {"abs", {-tiny, tiny}, unused, {0, tiny}},

    {"add", {0, 0}, {0, 0}, {0, 0}},
    {"add", {1, 1}, {0x1p-60, 0x1p-60}, {1, above_one}},
    {"add", {1, 1}, {-0x1p-60, -0x1p-60}, {below_one, 1}},
    {"add", {1, 1}, {tiny, tiny}, {1, above_one}},
    {"add", {tiny, tiny}, {-normal, -normal}, {-0x0.fffffffffffffp-1022, -0x0.fffffffffffffp-1022}},
    {"add", {max, max}, {max, max}, {max, inf}},
    {"add", {-max, -max}, {-max, -max}, {-inf, -max}},
    {"add", {max, max}, {0x1p969, 0x1p969}, {max, inf}},
    {"add", {max, max}, {-max, -max}, {0, 0}},
    {"add", {-inf, -1}, {1, inf}, entire},
    {"add", entire, {1, 2}, entire},

    {"sub", {1, 1}, {0.9, 0.9}, {0x1.9999999999998p-4, 0x1.9999999999998p-4}},
    {"sub", {0, 0}, {tiny, tiny}, {-tiny, -tiny}},
    {"sub", {1, 1}, {tiny, tiny}, {below_one, 1}},
    {"sub", {max, max}, {-max, -max}, {max, inf}},
    {"sub", {1, 2}, entire, entire},
    {"sub", empty, {1, 2}, empty},

    {"mul", {above_one, above_one}, {above_one, above_one}, {0x1.0000000000002p0, 0x1.0000000000003p0}},
    {"mul", {0, 1}, {1, inf}, {0, inf}},
    {"mul", {0, 1}, {-inf, -1}, {-inf, 0}},
    {"mul", {-1, 0}, {-inf, 0}, {0, inf}},
    {"mul", {0, 1}, entire, entire},
    {"mul", {tiny, 1}, entire, entire},
    {"mul", {tiny, tiny}, {0.5, 0.5}, {0, tiny}},
    {"mul", {-tiny, -tiny}, {0.5, 0.5}, {-tiny, 0}},
    {"mul", {0x1p-537, 0x1p-537}, {0x1p-537, 0x1p-537}, {tiny, tiny}},
    {"mul", {0x1p-600, 0x1p-600}, {0x1p-600, 0x1p-600}, {0, tiny}},
    {"mul", {tiny, tiny}, {0, inf}, {0, inf}},
    {"mul", {max, max}, {2, 2}, {max, inf}},
    {"mul", {-max, max}, {2, 2}, entire},

    {"div", {1, 1}, {3, 3}, {0x1.5555555555555p-2, 0x1.5555555555556p-2}},
    // 0 in its interior
    {"div", {1, 1}, {-tiny, tiny}, entire},
    {"div", {tiny, tiny}, {-max, max}, entire},
    {"div", {1, 1}, entire, entire},
    {"div", {1, 1}, {tiny, tiny}, {max, inf}},
    {"div", {1, 1}, {0, tiny}, {max, inf}},
    {"div", {-1, -1}, {0, tiny}, {-inf, -max}},
    {"div", {tiny, tiny}, {2, 2}, {0, tiny}},
    {"div", {tiny, tiny}, {max, max}, {0, tiny}},
    {"div", {-tiny, -tiny}, {max, max}, {-tiny, 0}},
    {"div", {tiny, tiny}, {tiny, tiny}, {1, 1}},
    {"div", {max, max}, {0.5, 0.5}, {max, inf}},

    {"square", {1, 2}, unused, {1, 4}},
    {"square", {-3, -2}, unused, {4, 9}},
    {"square", {0, 0}, unused, {0, 0}},
    {"square", {above_one, above_one}, unused, {0x1.0000000000002p0, 0x1.0000000000003p0}},
    {"square", {tiny, tiny}, unused, {0, tiny}},
    {"square", {max, max}, unused, {max, inf}},
    {"square", {-inf, -1}, unused, {1, inf}},

    {"sqrt", {2, 2}, unused, {0x1.6a09e667f3bccp0, 0x1.6a09e667f3bcdp0}},
    {"sqrt", {0, 0}, unused, {0, 0}},
    {"sqrt", {-1, 0}, unused, {0, 0}},
    {"sqrt", {-2, -1}, unused, empty},
    {"sqrt", {-1, -tiny}, unused, empty},
    {"sqrt", {tiny, tiny}, unused, {0x1p-537, 0x1p-537}},
    {"sqrt", {max, max}, unused, {0x1.fffffffffffffp511, 0x1p512}},
    {"sqrt", {1, inf}, unused, {1, inf}},

    {"exp", {0, 0}, unused, {1, 1}},
    {"exp", {1, 1}, unused, {0x1.5bf0a8b145769p1, 0x1.5bf0a8b14576ap1}},
    {"exp", {tiny, tiny}, unused, {1, above_one}},
    {"exp", {-tiny, -tiny}, unused, {below_one, 1}},
    {"exp", {710, 710}, unused, {max, inf}},
    {"exp", {-800, -800}, unused, {0, tiny}},
    {"exp", {-max, max}, unused, {0, inf}},

    {"log", {2, 2}, unused, {0x1.62e42fefa39efp-1, 0x1.62e42fefa39f0p-1}},
    {"log", {-1, 1}, unused, {-inf, 0}},
    {"log", {0, 0}, unused, empty},
    {"log", {-1, 0}, unused, empty},
    {"log", {-2, -1}, unused, empty},

    {"pow", {1, 1}, entire, {1, 1}},
    {"pow", {2, 2}, entire, {0, inf}},
    {"pow", entire, {0, 0}, {1, 1}},
    {"pow", {1, 1}, empty, empty},

    // a.lo b + a
    {"scaled_add", {2, 3}, {1, 4}, {4, 11}},
    {"scaled_add", {-2, 0}, {1, 4}, {-10, -2}},
    {"scaled_add", {0, 1}, {5, 6}, {0, 1}},
    {"scaled_add", {0, 1}, entire, {0, 1}},
    {"scaled_add", {1, 1}, entire, entire},
    {"scaled_add", {-1, 1}, {-inf, 0}, {-1, inf}},
    {"scaled_add", {above_one, above_one}, {-above_one, -above_one}, {-0x1.0000000000001p-52, -0x1.0000000000001p-52}},
    {"scaled_add", {max, max}, {2, 2}, {max, inf}},
    {"scaled_add", {0, 1}, empty, empty},
    {"scaled_add", empty, {1, 2}, empty},

    {"min", {-inf, 1}, {0, 0}, {-inf, 0}},
    {"max", {-inf, 1}, {0, inf}, {0, inf}},
    {"hull", empty, {1, 2}, {1, 2}},
    {"intersection", {1, 4}, {2, 3}, {2, 3}},
    {"intersection", {1, 2}, {3, 4}, empty},
    {"intersection", {3, 4}, {1, 2}, empty},
    {"intersection", {-1, -tiny}, {tiny, 1}, empty},
    {"intersection", entire, {1, 2}, {1, 2}},
    {"intersection", empty, entire, empty},

    // falls with the distance from 0, from 1 at 0; pi/4 at 1
    {"atan_ratio", {0, 0}, unused, {1, 1}},
    {"atan_ratio", {1, 1}, unused, {0x1.921fb54442d18p-1, 0x1.921fb54442d19p-1}},
    {"atan_ratio", {-1, 1}, unused, {0x1.921fb54442d18p-1, 1}},
    {"atan_ratio", {-1, 0}, unused, {0x1.921fb54442d18p-1, 1}},
    {"atan_ratio", {1, inf}, unused, {0, 0x1.921fb54442d19p-1}},
    {"atan_ratio", {-inf, -1}, unused, {0, 0x1.921fb54442d19p-1}},
    {"atan_ratio", {tiny, tiny}, unused, {below_one, 1}},
    {"atan_ratio", {-normal, tiny}, unused, {below_one, 1}},
    {"atan_ratio", {0x1p1020, 0x1p1021}, unused, {0x1.921fb54442d18p-1021, 0x1.921fb54442d19p-1020}},
    {"atan_ratio", {max, inf}, unused, {0, 0x1.921fb54442d1cp-1024}},
    {"atan_ratio", entire, unused, {0, 1}},
    {"atan_ratio", empty, unused, empty},
};

/// The vectors, and each with the other signs of its zeros, which no operation may notice.
std::vector<Vector> with_signed_zeros() {
  const auto flipped = [](Ends a) { return Ends{a.lo == 0.0 ? -a.lo : a.lo, a.hi == 0.0 ? -a.hi : a.hi}; };
  std::vector<Vector> all;
  for (const Vector& v : vectors) {
    all.push_back(v);
    all.push_back({v.operation, flipped(v.a), v.b, v.tightest});
    all.push_back({v.operation, v.a, flipped(v.b), v.tightest});
    all.push_back({v.operation, flipped(v.a), flipped(v.b), v.tightest});
  }
  return all;
}

unsigned index_of(std::string_view name) {
  const auto operations = interval_operations();
  const auto found = std::find_if(operations.begin(), operations.end(), [name](const IntervalOperation& operation) {
    return std::string_view(operation.name).substr(std::string_view("interval_").size()) == name;
  });
  if (found == operations.end()) throw std::invalid_argument(std::string(name));
  return static_cast<unsigned>(found - operations.begin());
}

bool same(Ends a, Ends b) {
  return (is_empty(a) && is_empty(b)) || (a.lo == b.lo && a.hi == b.hi);
}

std::string text(Ends a) {
  return is_empty(a) ? "empty" : fmt::format("[{:a}, {:a}]", a.lo, a.hi);
}

std::string text(std::string_view operation, const IntervalOperands& operands, Ends expected, Ends got) {
  return fmt::format("{} of {} and {}: expected {}, got {}", operation, text(operands.a), text(operands.b),
                     text(expected), text(got));
}

// ---------------------------------------------------------------- the reference

/// What random operands are compared with must agree with what was written down by hand.
TEST(IntervalStandard, TheReferenceGivesTheVectors) {
  for (const Vector& v : with_signed_zeros()) {
    const Ends range = range_of(interval_operations()[index_of(v.operation)], {v.a, v.b});
    EXPECT_TRUE(same(range, v.tightest)) << text(v.operation, {v.a, v.b}, v.tightest, range);
  }
}

TEST(IntervalStandard, EveryOperationHasVectors) {
  for (const IntervalOperation& operation : interval_operations()) {
    EXPECT_TRUE(std::any_of(vectors.begin(), vectors.end(), [&](const Vector& v) {
      return operation.name == "interval_" + std::string(v.operation);
    })) << operation.name;
  }
}

// ---------------------------------------------------------------- the host

using HostOperation = Interval (*)(const Interval&, const Interval&);

HostOperation host_operation(std::string_view name) {
  if (name == "neg") return [](const Interval& a, const Interval&) { return -a; };
  if (name == "abs") return [](const Interval& a, const Interval&) { return abs(a); };
  if (name == "add") return [](const Interval& a, const Interval& b) { return a + b; };
  if (name == "sub") return [](const Interval& a, const Interval& b) { return a - b; };
  if (name == "mul") return [](const Interval& a, const Interval& b) { return a * b; };
  if (name == "div") return [](const Interval& a, const Interval& b) { return a / b; };
  if (name == "square") return [](const Interval& a, const Interval&) { return square(a); };
  if (name == "sqrt") return [](const Interval& a, const Interval&) { return sqrt(a); };
  if (name == "exp") return [](const Interval& a, const Interval&) { return exp(a); };
  if (name == "log") return [](const Interval& a, const Interval&) { return log(a); };
  if (name == "pow") return [](const Interval& a, const Interval& b) { return pow(a, b); };
  if (name == "hull") return [](const Interval& a, const Interval& b) { return hull(a, b); };
  return nullptr;
}

/// The host's log and pow are those of positive numbers: they do not intersect their arguments with the domain.
bool host_takes(std::string_view name, Ends a) {
  if (name == "log" || name == "pow") return a.lo >= 0.0 && a.hi > 0.0;
  return host_operation(name) != nullptr;
}

/// Nothing where the host refuses.
std::optional<Ends> on_host(std::string_view name, const IntervalOperands& operands) {
  try {
    const auto& [a, b] = operands;
    const Interval result = host_operation(name)({a.lo, a.hi}, {b.lo, b.hi});
    return Ends{result.lower(), result.upper()};
  } catch (const std::domain_error&) {
    return std::nullopt;
  }
}

/// What is wrong on the host, which has no empty interval: it refuses empty operands and empty results.
std::string host_fault(std::string_view name, const IntervalOperands& operands, Ends tightest) {
  const auto result = on_host(name, operands);
  const bool refuses = is_empty(tightest) || is_empty(operands.a) || is_empty(operands.b);
  if (refuses ? !result : result && same(*result, tightest)) return {};
  return text(name, operands, tightest, result.value_or(empty));
}

TEST(HostInterval, IsTightestToTheLastBit) {
  for (const Vector& v : with_signed_zeros()) {
    if (!host_takes(v.operation, v.a)) continue;
    EXPECT_EQ(host_fault(v.operation, {v.a, v.b}, v.tightest), "");
  }
}

TEST(HostInterval, IsTightestForRandomOperands) {
  for (const IntervalOperation& operation : interval_operations()) {
    const std::string_view name = std::string_view(operation.name).substr(std::string_view("interval_").size());
    SampleOperands samples(1);
    for (std::size_t i = 0; i < random_samples; ++i) {
      const IntervalOperands o{samples.interval(operation.a_domain), samples.interval(operation.b_domain)};
      if (!host_takes(name, o.a)) continue;
      ASSERT_EQ(host_fault(name, o, range_of(operation, o)), "");
    }
  }
}

TEST(HostInterval, RefusesWhatIsNoSetOfNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Interval(nan, nan), std::domain_error);
  EXPECT_THROW(Interval(nan, 1.0), std::domain_error);
  EXPECT_THROW(Interval(2.0, 1.0), std::domain_error);
  EXPECT_THROW(Interval(inf, -inf), std::domain_error);
}

/// Where the host is stricter than the standard, which takes the part of the argument in the domain.
TEST(HostInterval, RefusesLogarithmsOfNegativeNumbers) {
  EXPECT_THROW(log(Interval(-1.0, 2.0)), std::domain_error);
  EXPECT_THROW(log(Interval(-2.0, -1.0)), std::domain_error);
}

/// Where it is wider: in the standard 0^0 has no value.
TEST(HostInterval, CountsZeroToTheZeroAsOne) {
  const Interval result = pow(Interval(0.0), Interval(0.0));
  EXPECT_EQ(result.lower(), 1.0);
  EXPECT_EQ(result.upper(), 1.0);
}

// ---------------------------------------------------------------- the kernels

std::vector<Device> devices_that_passed() {
  std::vector<Device> devices;
  for (const DeviceReport& report : test_devices()) {
    if (report.passed) devices.push_back(*select_device(std::to_string(report.index)).device);
  }
  return devices;
}

class KernelInterval : public testing::Test {
 protected:
  void SetUp() override {
    if (devices.empty()) GTEST_SKIP() << "NO OPENCL DEVICE: the kernels' intervals were NOT tested";
  }

  /// `check` sees the operations of every device at every vector width.
  template <class Check>
  void for_all_kernels(Check check) {
    for (const Device& device : devices) {
      for (const int width : {16, 8, 4, 1}) {
        SCOPED_TRACE(fmt::format("{}, width {}", device.name, width));
        const cl::Program program = build_program(device.context, device.device, width, device::self_test_sources());
        OperationKernels kernels(device.context, device.device, program, width);
        check(kernels);
      }
    }
  }

  const std::vector<Device> devices = devices_that_passed();
};

/// The vectors of all operations, in their order, so that neighbouring lanes hold unlike cases.
TEST_F(KernelInterval, ContainsTheVectorsTightly) {
  const std::vector<Vector> all = with_signed_zeros();
  std::vector<IntervalOperands> operands;
  operands.reserve(all.size());
  for (const Vector& v : all) operands.push_back({v.a, v.b});
  for_all_kernels([&](OperationKernels& kernels) {
    for (unsigned index = 0; index < interval_operations().size(); ++index) {
      const IntervalOperation& operation = interval_operations()[index];
      const std::vector<Ends> results = kernels.apply_to_intervals(index, operands);
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (index_of(all[i].operation) != index) continue;
        EXPECT_EQ(fault(operation, operands[i], all[i].tightest, results[i]), "")
            << text(operation.name, operands[i], all[i].tightest, results[i]);
      }
    }
  });
}

TEST_F(KernelInterval, ContainsRandomRangesTightly) {
  for (unsigned index = 0; index < interval_operations().size(); ++index) {
    const IntervalOperation& operation = interval_operations()[index];
    SampleOperands samples(2);
    std::vector<IntervalOperands> operands(random_samples);
    std::vector<Ends> ranges;
    for (IntervalOperands& o : operands) {
      o = {samples.interval(operation.a_domain), samples.interval(operation.b_domain)};
      ranges.push_back(range_of(operation, o));
    }
    for_all_kernels([&](OperationKernels& kernels) {
      const std::vector<Ends> results = kernels.apply_to_intervals(index, operands);
      for (std::size_t i = 0; i < operands.size(); ++i) {
        ASSERT_EQ(fault(operation, operands[i], ranges[i], results[i]), "")
            << text(operation.name, operands[i], ranges[i], results[i]);
      }
    });
  }
}

TEST_F(KernelInterval, EndsOfArithmeticLieAtMostTwoUnitsOutside) {
  for (const char* name : {"add", "sub", "mul", "div", "square", "sqrt", "scaled_add"}) {
    const IntervalOperation& operation = interval_operations()[index_of(name)];
    for (const double end : {1.0, 0x1.8p0, 1.0 / 3.0, 1e300})
      EXPECT_LE(operation.slack(unused, unused, end), 2.0 * std::ldexp(1.0, std::ilogb(end) - 52)) << name;
    EXPECT_EQ(operation.slack(unused, unused, 0.0), 0x1p-1021) << name;
  }
}

// ---------------------------------------------------------------- the accuracy report

testing::Matcher<const FunctionAccuracy&> tight_to(double units) {
  return testing::AllOf(testing::Field(&FunctionAccuracy::down, testing::Le(units)),
                        testing::Field(&FunctionAccuracy::up, testing::Le(units)));
}

/// Of all operations but powers.
double promised_units(const std::string& function) {
  if (function.ends_with("exp") || function.ends_with("log")) return 8.0;
  return function.ends_with("atan_ratio") ? 13.0 : 2.0;
}

TEST(AccuracyReport, FindsTheHostExact) {
  for (const FunctionAccuracy& row : host_accuracy(1000)) {
    EXPECT_EQ(row.unsound, 0U) << row.function;
    if (row.samples == 0) continue;
    EXPECT_THAT(row, tight_to(0.0)) << row.function;
  }
}

TEST(AccuracyReport, FindsTheKernelsSoundAndTight) {
  for (const DeviceReport& device : test_devices()) {
    if (!device.passed) continue;
    const std::vector<FunctionAccuracy> rows = device_accuracy(device.index, 1000);
    EXPECT_GT(rows.size(), interval_operations().size());
    for (const FunctionAccuracy& row : rows) {
      EXPECT_GT(row.samples, 500U) << row.function;
      EXPECT_EQ(row.unsound, 0U) << row.function;
      if (row.function.find("pow") != std::string::npos) continue;
      EXPECT_THAT(row, tight_to(promised_units(row.function))) << row.function;
    }
  }
}

/// Without the outward step half of the results lie on the wrong side.
TEST_F(KernelInterval, ReportCountsUnsoundBounds) {
  const Device& device = devices.front();
  std::string sources = device::self_test_sources();
  const std::string step = "return c - fma(REAL(ROUNDING_PHI), fabs(c), REAL(ROUNDING_ETA));";
  ASSERT_NE(sources.find(step), std::string::npos);
  sources.replace(sources.find(step), step.size(), "return c;");
  const cl::Program program(device.context, sources);
  program.build({device.device}, "-cl-std=CL1.2 -DVECTOR_WIDTH=4");
  OperationKernels kernels(device.context, device.device, program, 4);
  const std::vector<FunctionAccuracy> rows = measure_accuracy(kernels, 1000, {});
  EXPECT_GT(rows.front().unsound, 100U) << rows.front().function;
}

}  // namespace
}  // namespace verisq::device
