/// Every rounding primitive and elementary function of the kernels against MPFR, for every vector width: no result may
/// lie on the wrong side of the exact value, and NaN may not get lost. VERISQ_ARITHMETIC_SAMPLES sets the samples an
/// operation and width.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpfr.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/device/sample_operations.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::size_t samples() {
  return oracle::requested_count("VERISQ_ARITHMETIC_SAMPLES", 100'000);
}

// A binary64 number of MPFR, or a longer one; released with its owner.
class Number {
 public:
  explicit Number(mpfr_prec_t bits = 53) { mpfr_init2(value_, bits); }
  ~Number() { mpfr_clear(value_); }
  Number(const Number&) = delete;
  Number& operator=(const Number&) = delete;
  mpfr_ptr get() { return value_; }
  mpfr_ptr set(double x) {
    mpfr_set_d(value_, x, MPFR_RNDN);
    return value_;
  }

 private:
  mpfr_t value_;
};

// What an operand is drawn from: infinities included, unlike SampleOperands.
enum class Distribution { any, divisor, nonnegative, exponent, base, tangent };

struct Operation {
  const char* name;
  unsigned down;  // index in kernels/self_test.cl
  unsigned up;
  Distribution a, b, c;
  double tightness;  // largest relative distance of a bound from the exact value, as the kernels document it
};

constexpr double one_step = 0x1p-51;
constexpr double elementary = 0x1p-50;
constexpr double inverse_tangent = 0x1.99p-50;
const Operation operations[] = {
    {"add", 7, 8, Distribution::any, Distribution::any, Distribution::any, one_step},
    {"sub", 9, 10, Distribution::any, Distribution::any, Distribution::any, one_step},
    {"mul", 11, 12, Distribution::any, Distribution::any, Distribution::any, one_step},
    {"div", 13, 14, Distribution::any, Distribution::divisor, Distribution::any, one_step},
    {"fma", 15, 16, Distribution::any, Distribution::any, Distribution::any, one_step},
    {"sqrt", 17, 18, Distribution::nonnegative, Distribution::any, Distribution::any, one_step},
    {"exp", 19, 20, Distribution::exponent, Distribution::any, Distribution::any, elementary},
    {"log", 21, 22, Distribution::nonnegative, Distribution::any, Distribution::any, elementary},
    {"pow_unit", 23, 24, Distribution::base, Distribution::nonnegative, Distribution::any, infinity},
    {"atan_ratio", 25, 26, Distribution::tangent, Distribution::any, Distribution::any, inverse_tangent},
};

// atan(a)/a of |a|, or 1. The arc is rounded far beyond binary64, in the same direction.
void divided_arc(mpfr_ptr result, double a, mpfr_rnd_t rounding) {
  thread_local Number size;
  thread_local Number arc(256);
  if (a == 0.0) {
    mpfr_set_ui(result, 1, rounding);
    return;
  }
  size.set(std::abs(a));
  mpfr_atan(arc.get(), size.get(), rounding);
  mpfr_div(result, arc.get(), size.get(), rounding);
}

// The exact value rounded down or up to a binary64 number: a binary64 bound is right exactly if it does not cross it.
double reference(const Operation& operation, const Operands& o, mpfr_rnd_t rounding) {
  thread_local Number a;
  thread_local Number b;
  thread_local Number c;
  thread_local Number result;
  a.set(o.a);
  b.set(o.b);
  c.set(o.c);
  switch (operation.down) {
    case 7: mpfr_add(result.get(), a.get(), b.get(), rounding); break;
    case 9: mpfr_sub(result.get(), a.get(), b.get(), rounding); break;
    case 11: mpfr_mul(result.get(), a.get(), b.get(), rounding); break;
    case 13: mpfr_div(result.get(), a.get(), b.get(), rounding); break;
    case 15: mpfr_fma(result.get(), a.get(), b.get(), c.get(), rounding); break;
    case 17: mpfr_sqrt(result.get(), a.get(), rounding); break;
    case 19: mpfr_exp(result.get(), a.get(), rounding); break;
    case 21: mpfr_log(result.get(), a.get(), rounding); break;
    case 25: divided_arc(result.get(), o.a, rounding); break;
    default: mpfr_pow(result.get(), a.get(), b.get(), rounding); break;
  }
  return mpfr_get_d(result.get(), rounding);
}

class Sampler {
 public:
  double draw(Distribution distribution) {
    switch (distribution) {
      case Distribution::any: return any();
      case Distribution::divisor: {
        const double x = any();
        return x == 0.0 ? 1.0 : x;
      }
      case Distribution::nonnegative: return std::abs(any());
      case Distribution::exponent: return pick_(generator_) < 2 ? any() : 740.0 * (2.0 * unit_(generator_) - 1.0);
      case Distribution::tangent: return pick_(generator_) < 2 ? any() : tangent();
      case Distribution::base: break;
    }
    return pick_(generator_) < 2 ? std::min(std::abs(any()), 1.0) : unit_(generator_);
  }

 private:
  // Special values, numbers near powers of two, the middle of the range, the whole range with subnormals.
  double any() {
    static constexpr double special[] = {0.0,
                                         -0.0,
                                         1.0,
                                         -1.0,
                                         2.0,
                                         0.5,
                                         0x1p-1022,
                                         -0x1p-1022,
                                         0x1p-1074,
                                         0x1p-1060,
                                         0x1.fffffffffffffp1023,
                                         0x1.fffffffffffffp-1,
                                         0x1.0000000000001p0,
                                         0x1.6a09e667f3bcdp-1,
                                         0x1.6a09e667f3bccp0,
                                         0x1.6a09e667f3bcdp0,
                                         -708.0,
                                         709.0,
                                         infinity};
    const int kind = pick_(generator_);
    if (kind == 0) return special[generator_() % std::size(special)];
    const double sign = (generator_() & 1U) != 0 ? 1.0 : -1.0;
    if (kind == 1) return sign * (1.0 + std::ldexp(unit_(generator_), -static_cast<int>(generator_() % 53)));
    const int range = kind < 7 ? 12 : 1070;
    const int exponent = std::min(static_cast<int>(generator_() % static_cast<unsigned>(2 * range)) - range, 1023);
    return sign * std::ldexp(1.0 + unit_(generator_), exponent);
  }

  // Numbers in [-4, 4], and near those at which the kernels change their course.
  double tangent() {
    static constexpr double borders[] = {1.0, 0x1p1021, 0x1p-511, 0x1p-1022};
    const double sign = (generator_() & 1U) != 0 ? 1.0 : -1.0;
    if (pick_(generator_) < 7) return sign * 4.0 * unit_(generator_);
    const double border = borders[generator_() % std::size(borders)];
    return sign * border * (1.0 + std::ldexp(unit_(generator_) - 0.5, -static_cast<int>(generator_() % 53)));
  }

  std::mt19937_64 generator_{511};
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
  std::uniform_int_distribution<int> pick_{0, 9};
};

struct Tally {
  std::uint64_t checked = 0;
  std::uint64_t escapes = 0;
  double loosest = 0.0;  // relative distance from the exact value, where that is a normal number
  std::string first_escape;
};

// NaN concludes nothing, and is allowed only where the exact value overflows or, as for inf - inf, does not exist.
bool nothing_concluded(double exact, double result) {
  return std::isnan(result) && !(std::abs(exact) <= 0x1p1023);
}

void check(const Operation& operation, const Operands& o, double down, double up, Tally& tally) {
  const double exact_down = reference(operation, o, MPFR_RNDD);
  const double exact_up = reference(operation, o, MPFR_RNDU);
  ++tally.checked;
  const bool below = down <= exact_down || nothing_concluded(exact_up, down);
  const bool above = up >= exact_up || nothing_concluded(exact_up, up);
  if (!below || !above) {
    if (tally.escapes++ == 0)
      tally.first_escape = fmt::format("{}({:a}, {:a}, {:a}): [{:a}, {:a}] misses [{:a}, {:a}]", operation.name, o.a,
                                       o.b, o.c, down, up, exact_down, exact_up);
    return;
  }
  const double size = std::min(std::abs(exact_down), std::abs(exact_up));
  if (size > 0x1p-960 && size < 0x1p1000 && std::isfinite(down) && std::isfinite(up))
    tally.loosest = std::max(tally.loosest, std::max(exact_down - down, up - exact_up) / size);
}

class KernelArithmetic : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const Selection selection = select_device("auto");
    if (!selection.device) GTEST_SKIP() << "no OpenCL device: " << selection.notice;
    const Device& device = *selection.device;
    const cl::Program program = build_program(device.context, device.device, GetParam(), device::self_test_sources());
    kernels_.emplace(device.context, device.device, program, GetParam());
  }

  std::optional<OperationKernels> kernels_;
};

TEST_P(KernelArithmetic, ContainsTheExactValue) {
  constexpr std::size_t chunk = 1U << 15U;
  for (const Operation& operation : operations) {
    Sampler sampler;
    Tally tally;
    for (std::size_t done = 0; done < samples(); done += chunk) {
      std::vector<Operands> operands(chunk);
      for (Operands& o : operands) {
        o = {sampler.draw(operation.a), sampler.draw(operation.b), sampler.draw(operation.c)};
        // What contraction or a lost residual would show: a product and its negative rounded value.
        if (operation.down == 15 && (&o - operands.data()) % 2 == 0 && std::isfinite(o.a * o.b)) o.c = -(o.a * o.b);
      }
      const std::vector<double> down = kernels_->apply(operation.down, operands);
      const std::vector<double> up = kernels_->apply(operation.up, operands);
      for (std::size_t i = 0; i < chunk; ++i) check(operation, operands[i], down[i], up[i], tally);
    }
    fmt::print("width {:2} {:8}: {} samples, {} escapes, loosest bound 2^{:.2f}\n", GetParam(), operation.name,
               tally.checked, tally.escapes, std::log2(tally.loosest));
    EXPECT_EQ(tally.escapes, 0U) << tally.first_escape;
    EXPECT_LE(tally.loosest, operation.tightness) << operation.name;
  }
}

// What no number is compared with: no lane may pass on NaN, or conclude anything from it.
TEST_P(KernelArithmetic, ArcOfNoNumberIsTrivial) {
  const std::vector<Operands> operands = {{nan, 0.0, 0.0}, {-nan, 0.0, 0.0}};
  EXPECT_EQ(kernels_->apply(25, operands), std::vector<double>(2, 0.0));
  EXPECT_EQ(kernels_->apply(26, operands), std::vector<double>(2, 1.0));
}

// All pairs of what overflow, 0 / 0 and the logarithm of 0 may leave.
std::vector<Operands> special_pairs() {
  const double largest = std::numeric_limits<double>::max();
  const std::vector<double> specials = {nan, -infinity, -largest, -1.0, 0.0, 2.0, largest, infinity};
  std::vector<Operands> pairs;
  for (const double a : specials)
    for (const double b : specials) pairs.push_back({a, b, 0.0});
  return pairs;
}

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

TEST_P(KernelArithmetic, LeastAndGreatestHandNanOn) {
  const std::vector<Operands> pairs = special_pairs();
  const std::vector<double> least = kernels_->apply(27, pairs);
  const std::vector<double> greatest = kernels_->apply(28, pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [a, b, c] = pairs[i];
    const bool either_is_nan = std::isnan(a) || std::isnan(b);
    EXPECT_TRUE(same(least[i], either_is_nan ? nan : std::min(a, b))) << a << " " << b << ": " << least[i];
    EXPECT_TRUE(same(greatest[i], either_is_nan ? nan : std::max(a, b))) << a << " " << b << ": " << greatest[i];
  }
}

// Of an operand that is not finite, and where a step overflows, it may know nothing, but claim nothing false.
TEST_P(KernelArithmetic, LogNormBoundsSpecialOperands) {
  const std::vector<Operands> pairs = special_pairs();
  const std::vector<double> norms = kernels_->apply(29, pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [a, b, c] = pairs[i];
    if (std::isfinite(a) && std::isfinite(b))
      EXPECT_FALSE(norms[i] < std::max(a, b)) << a << " " << b;
    else
      EXPECT_FALSE(norms[i] < infinity) << a << " " << b << ": " << norms[i];
  }
}

INSTANTIATE_TEST_SUITE_P(Widths, KernelArithmetic, testing::Values(16, 8, 4, 1), testing::PrintToStringParamName());

}  // namespace
}  // namespace verisq::device
