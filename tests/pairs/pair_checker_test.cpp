/// Certificates of pairs prove what was found, and never what is false. VERISQ_FORGED_PAIRS says how many pairs are
/// tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_pairs.hpp"
#include "verisq/distance.hpp"

namespace verisq {
namespace {

using oracle::moved;
using oracle::with_wrong_digit;

struct Answer {
  Model a;
  Model b;
  Pose pose;
  ModelDistance found;
};

Pose random_pose(oracle::RandomCases& random, double size) {
  const auto shift = [&] { return random.uniform(-size, size); };
  const auto turn = [&] { return random.uniform(-1.0, 1.0); };
  return {{shift(), shift(), shift()}, {1.0, turn(), turn(), turn()}};
}

/// Every second one of unions of two.
Answer random_answer(std::size_t k) {
  oracle::RandomCases random(500 + k);
  const oracle::RandomPair pair = random_pair(random);
  Answer answer{{"", {pair.a}}, {"", {pair.b}}, {}, {}};
  const double size = std::ranges::max(pair.a.superquadric.semi_axes);
  if (k % 2 == 1) {
    answer.pose = random_pose(random, size);
    answer.a.primitives.push_back(pair.a);
    for (double& t : answer.a.primitives.back().pose.translation) t += random.uniform(-size, size);
  }
  answer.found = PairDistance(answer.a, answer.b)(answer.pose);
  return answer;
}

Finding check(const Answer& answer, const Enclosure& claimed) {
  return PairChecker(answer.a, answer.b)(answer.pose, claimed, answer.found.certificate);
}

/// Another case: one number of the models or the pose is another one.
Answer of_another_case(Answer answer, oracle::RandomCases& random) {
  Primitive& primitive = random.choice(2) == 0 ? answer.a.primitives[0] : answer.b.primitives[0];
  const std::array vectors{&primitive.superquadric.semi_axes, &primitive.pose.translation, &answer.pose.translation};
  const std::size_t chosen = random.choice(3);
  double& number = (*vectors[chosen])[random.choice(3)];
  const double wrong = with_wrong_digit(number, random);
  if (chosen != 0 || wrong > 0.0) number = wrong;  // semi-axes are positive
  return answer;
}

/// Whether a claim has nothing in common with the distance of a case.
bool is_false(const Enclosure& claimed, const Answer& of) {
  const Enclosure truth = PairDistance(of.a, of.b)(of.pose).distance;
  return claimed.lo > truth.hi || claimed.hi < truth.lo;
}

TEST(PairCheckerTest, ProvesWhatWasFound) {
  for (std::size_t k = 0; k < 60; ++k) {
    const Answer answer = random_answer(k);
    EXPECT_EQ(check(answer, answer.found.distance).verdict, Verdict::proved) << k;
  }
}

TEST(PairCheckerTest, NeverProvesAForgery) {
  oracle::Forgeries forgeries;
  const auto try_out = [&](const Answer& answer, const Enclosure& claimed, const char* what) {
    forgeries.expect_not_proved(check(answer, claimed), claimed, what);
  };
  for (std::size_t k = 0; k < oracle::requested_count("VERISQ_FORGED_PAIRS", 40); ++k) {
    const Answer answer = random_answer(k);
    const Enclosure& truth = answer.found.distance;
    oracle::RandomCases random(k);
    try_out(answer, {moved(truth.hi, infinity), 2.0 * moved(truth.hi, infinity)}, "lo past the truth");
    if (truth.lo > 0.0) try_out(answer, {0.0, moved(truth.lo, -infinity)}, "hi past the truth");
    try_out(answer, {truth.hi, truth.lo - 1.0}, "lo above hi");
    for (int i = 0; i < 4; ++i) {
      const double hi = with_wrong_digit(truth.hi, random);
      const double lo = with_wrong_digit(truth.lo, random);
      if (hi < truth.lo) try_out(answer, {truth.lo, hi}, "a digit of hi");
      if (lo > truth.hi) try_out(answer, {lo, truth.hi}, "a digit of lo");
      const Answer other = of_another_case(answer, random);
      if (is_false(truth, other)) try_out(other, truth, "another case");
    }
    Answer without = answer;
    without.found.certificate = {};
    if (truth.hi < infinity) try_out(without, truth, "no proof");
  }
  EXPECT_GT(forgeries.told(), 250U);
}

/// Whatever stands in a certificate, what is proved holds.
TEST(PairCheckerTest, ProvesNothingFalseFromNonsense) {
  const Answer answer = random_answer(0);
  const Enclosure& truth = answer.found.distance;
  const PairChecker checker(answer.a, answer.b);
  oracle::RandomCases random(3);
  const std::array<double, 7> extremes{0.0, -0.0, 1e308, 5e-324, -1e-200, infinity, std::nan("")};
  const auto number = [&] { return random.choice(2) == 0 ? extremes[random.choice(7)] : random.uniform(-3.0, 3.0); };
  const auto vector = [&] { return Point{number(), number(), number()}; };
  for (int i = 0; i < 1000; ++i) {
    PairCertificate nonsense;
    for (std::size_t n = random.choice(3); n > 0; --n) {
      nonsense.separations.push_back({static_cast<std::uint32_t>(random.choice(2)), 0, vector(), vector(), vector()});
    }
    if (random.choice(4) == 0) nonsense.common = vector();
    const Enclosure proven = checker.prove(answer.pose, nonsense);
    EXPECT_LE(proven.lo, truth.hi);
    EXPECT_GE(proven.hi, truth.lo);
  }
}

}  // namespace
}  // namespace verisq
