/// The fitness function against MPFR: what is proven contains every value, and searches see the same function.
#include <gtest/gtest.h>
#include <mpfr.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/fixtures/error_matchers.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

constexpr double kMax = std::numeric_limits<double>::max();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// f(d) at so many bits that its ends, rounded to binary64, are right to the last bit for the numbers used here.
class ExactFitness {
 public:
  ExactFitness() { mpfr_inits2(2400, apart_, inside_, result_, nullptr); }
  ExactFitness(const ExactFitness&) = delete;
  ExactFitness& operator=(const ExactFitness&) = delete;
  ~ExactFitness() { mpfr_clears(apart_, inside_, result_, nullptr); }

  Enclosure operator()(const Fitness& fitness, double distance) {
    mpfr_set_d(apart_, distance, MPFR_RNDN);
    mpfr_sub_d(apart_, apart_, fitness.target, MPFR_RNDN);
    mpfr_div_d(apart_, apart_, fitness.scale, MPFR_RNDN);
    mpfr_sqr(apart_, apart_, MPFR_RNDN);
    mpfr_add_ui(apart_, apart_, 1, MPFR_RNDN);
    mpfr_ui_div(result_, 1, apart_, MPFR_RNDN);
    mpfr_set_d(inside_, std::fmin(distance, 0.0), MPFR_RNDN);
    mpfr_div_d(inside_, inside_, fitness.scale, MPFR_RNDN);
    mpfr_sqr(inside_, inside_, MPFR_RNDN);
    mpfr_sub(result_, result_, inside_, MPFR_RNDN);
    return {mpfr_get_d(result_, MPFR_RNDD), mpfr_get_d(result_, MPFR_RNDU)};
  }

 private:
  mpfr_t apart_, inside_, result_;
};

/// Distances and sizes of many magnitudes, around 0 and around the target.
class RandomFitness {
 public:
  Fitness fitness() { return {std::fabs(number()) * (coin_(random_) ? 1.0 : 0.0), std::fabs(number()), {}}; }

  double distance(const Fitness& fitness) {
    switch (kind_(random_)) {
      case 0: return number();
      case 1: return fitness.target + fitness.scale * uniform_(random_) * 3.0;
      case 2: return fitness.scale * uniform_(random_);
      case 3: return fitness.target;
      case 4: return std::nextafter(fitness.target, uniform_(random_) * kMax);
      default: return coin_(random_) ? 0.0 : -0.0;
    }
  }

  double share() { return (uniform_(random_) + 1.0) / 2.0; }

 private:
  double number() { return uniform_(random_) * std::exp2(exponent_(random_)); }

  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
  std::uniform_int_distribution<int> exponent_{-40, 40};
  std::uniform_int_distribution<int> kind_{0, 5};
  std::bernoulli_distribution coin_{0.7};
};

TEST(Fitness, EnclosureContainsEveryValue) {
  RandomFitness random;
  ExactFitness exact;
  for (int i = 0; i < 20000; ++i) {
    const Fitness fitness = random.fitness();
    const double a = random.distance(fitness);
    const double b = random.distance(fitness);
    const Enclosure distance{std::fmin(a, b), std::fmax(a, b)};
    const Enclosure found = value(fitness, distance);
    std::vector<double> samples{distance.lo, distance.hi};
    for (const double x : {0.0, fitness.target, distance.lo + random.share() * (distance.hi - distance.lo)})
      if (distance.contains(x)) samples.push_back(x);
    for (const double x : samples) {
      const Enclosure at = exact(fitness, x);
      ASSERT_LE(found.lo, at.lo) << x << " in [" << a << ", " << b << "]";
      ASSERT_GE(found.hi, at.hi) << x << " in [" << a << ", " << b << "]";
    }
  }
}

TEST(Fitness, EnclosureIsTight) {
  RandomFitness random;
  ExactFitness exact;
  for (int i = 0; i < 20000; ++i) {
    const Fitness fitness = random.fitness();
    const double x = random.distance(fitness);
    const Enclosure found = value(fitness, {x, x});
    const Enclosure at = exact(fitness, x);
    // A few roundings of terms that are at most 1 + |f| each.
    EXPECT_LE(found.width(), 4e-15 * (1.0 + std::fabs(at.lo))) << x;
  }
}

TEST(Fitness, EnclosureOverTheTargetReachesOne) {
  const Fitness fitness = cemented(0.5, 0.25);
  EXPECT_EQ(value(fitness, {0.5, 0.5}), (Enclosure{1.0, 1.0}));
  EXPECT_EQ(value(fitness, {0.0, 3.0}).hi, 1.0);
  EXPECT_EQ(value(fitness, {0.25, 0.75}), (Enclosure{0.5, 1.0}));
  EXPECT_EQ(value(fitness, {-0.25, 0.5}).lo, value(fitness, {-0.25, -0.25}).lo);
}

TEST(Fitness, InfiniteEnds) {
  const Fitness fitness = cementless(2.0, 0.5);
  EXPECT_EQ(value(fitness, {-infinity, infinity}), (Enclosure{-infinity, 1.0}));
  EXPECT_EQ(value(fitness, {infinity, infinity}), (Enclosure{0.0, 0.0}));
  const Enclosure outside = value(fitness, {2.0, infinity});
  EXPECT_EQ(outside, (Enclosure{0.0, 0.5}));
  const Enclosure inside = value(fitness, {-infinity, -2.0});
  EXPECT_EQ(inside, (Enclosure{-infinity, -0.5}));
}

TEST(Fitness, NothingIsKnownOfWhatIsNoInterval) {
  const Fitness fitness = cementless(2.0, 0.5);
  for (const Enclosure& distance : {Enclosure{kNaN, 1.0}, Enclosure{0.0, kNaN}, Enclosure{1.0, 0.0}})
    EXPECT_EQ(value(fitness, distance), (Enclosure{-infinity, 1.0}));
}

TEST(Fitness, HugeAndTinyNumbers) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  ExactFitness exact;
  for (const Fitness& fitness : {Fitness{0.0, tiny, {}}, Fitness{0.0, kMax, {}}, Fitness{kMax, tiny, {}},
                                 Fitness{kMax, kMax, {}}, Fitness{tiny, 1.0, {}}}) {
    for (const double x : {-kMax, -1.0, -tiny, 0.0, tiny, 1.0, kMax}) {
      const Enclosure found = value(fitness, {x, x});
      EXPECT_LE(found.lo, exact(fitness, x).lo) << x;
      EXPECT_GE(found.hi, exact(fitness, x).hi) << x;
      EXPECT_FALSE(std::isnan(slope(fitness, x))) << x;
    }
  }
}

TEST(Fitness, ValueToNearest) {
  RandomFitness random;
  ExactFitness exact;
  for (int i = 0; i < 5000; ++i) {
    const Fitness fitness = random.fitness();
    const double x = random.distance(fitness);
    const double expected = exact(fitness, x).lo;
    EXPECT_NEAR(value(fitness, x), expected, 2e-15 * (1.0 + std::fabs(expected)));
  }
}

TEST(Fitness, SlopeIsTheDerivative) {
  const Fitness fitness = cemented(0.5, 0.25);
  for (double x = -2.0; x < 4.0; x += 0.0371) {
    const double h = 1e-6;
    EXPECT_NEAR(slope(fitness, x), (value(fitness, x + h) - value(fitness, x - h)) / (2.0 * h), 1e-6) << x;
  }
  EXPECT_EQ(slope(fitness, 0.5), 0.0);
  EXPECT_EQ(slope(fitness, infinity), 0.0);
}

TEST(Fitness, Cementless) {
  const Fitness fitness = cementless(2.0, 0.5);
  EXPECT_EQ(fitness.target, 0.0);
  EXPECT_EQ(fitness.scale, 2.0);
  EXPECT_EQ(fitness.serves, (Enclosure{-0.5, 2.0}));
}

TEST(Fitness, BandOfCementIsRoundedInward) {
  const Fitness fitness = cemented(0.5, 0.1);
  EXPECT_EQ(fitness.target, 0.5);
  EXPECT_EQ(fitness.scale, 0.1);
  mpfr_t end;
  mpfr_init2(end, 200);
  mpfr_set_d(end, 0.5, MPFR_RNDN);
  mpfr_sub_d(end, end, 0.1, MPFR_RNDN);
  EXPECT_EQ(fitness.serves.lo, mpfr_get_d(end, MPFR_RNDU));
  mpfr_set_d(end, 0.5, MPFR_RNDN);
  mpfr_add_d(end, end, 0.1, MPFR_RNDN);
  EXPECT_EQ(fitness.serves.hi, mpfr_get_d(end, MPFR_RNDD));
  mpfr_clear(end);
  const Fitness narrow = cemented(1.0, 1e-30);
  EXPECT_LE(narrow.serves.lo, narrow.serves.hi);
}

TEST(Fitness, RefusesWhatIsNoFitness) {
  const auto refused = [](auto make, const std::string& message) {
    testing::expect_error([&] { (void)make(); }, ErrorKind::input, "", message);
  };
  refused([] { return cementless(0.0, 0.5); }, "gap: must be positive and finite, not 0");
  refused([] { return cementless(kNaN, 0.5); }, "gap: must be positive and finite, not nan");
  refused([] { return cementless(2.0, -0.5); }, "penetration limit: must be finite and at least 0, not -0.5");
  refused([] { return cementless(2.0, infinity); }, "penetration limit: must be finite and at least 0, not inf");
  refused([] { return cemented(-1.0, 0.5); }, "gap: must be finite and at least 0, not -1");
  refused([] { return cemented(1.0, 0.0); }, "tolerance: must be positive and finite, not 0");
}

}  // namespace
}  // namespace verisq
