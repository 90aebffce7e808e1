/// Certificates of pairs with bends and set operations prove what was found, and never what is false.
/// VERISQ_FORGED_SOLID_PAIRS says how many pairs are tried.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_solids.hpp"
#include "verisq/distance.hpp"
#include "verisq/files.hpp"

namespace verisq {
namespace {

using oracle::moved;
using oracle::RandomCases;
using oracle::with_wrong_digit;

struct Answer {
  Model a;
  Model b;
  Pose pose;
  double tolerance;
  Enclosure found;
  Enclosure proven;
  PairCertificate certificate;
};

Answer certified(const Model& a, const Model& b, const Pose& pose, double tolerance) {
  const ModelSearch search(a, b);
  const SearchOptions options{.tolerance = tolerance};
  const SearchedDistance found = search(pose, options);
  const auto [claimed, certificate] = search.certified(pose, found, options);
  const PairChecker checker(a, b);
  EXPECT_EQ(checker(pose, claimed, certificate).verdict, Verdict::proved);
  return {a, b, pose, tolerance, found.distance, checker.prove(pose, certificate), certificate};
}

Pose at(double x, double y, double z, const std::array<double, 4>& quaternion = {1.0, 0.0, 0.0, 0.0}) {
  return {{x, y, z}, quaternion};
}

Model example(std::string_view name) {
  return read_model(places::example(name));
}

/// Two bent solids of several primitives, side by side or nearly meeting.
Answer random_answer(std::size_t k) {
  RandomCases random(900 + k);
  const auto turn = [&] { return random.uniform(-1.0, 1.0); };
  const double gap = random.log_uniform(0.02, 1.0);
  const Pose pose = at(0.05 + gap, 0.3 * gap * turn(), 0.2 * turn(), {1.0, 0.4 * turn(), 0.4 * turn(), turn()});
  const char* const other = std::array{"bent_stem.json", "stem.json"}[k % 2];
  return certified(example("bent_stem.json"), example(other), pose, 1e-4);
}

bool contains(const Enclosure& a, const Enclosure& b) {
  return a.lo <= b.lo && b.hi <= a.hi;
}

Finding check(const Answer& answer, const Enclosure& claimed) {
  return PairChecker(answer.a, answer.b)(answer.pose, claimed, answer.certificate);
}

TEST(SolidPairTest, ProvesWhatWasFoundOfBentStems) {
  int apart = 0;
  for (std::size_t k = 0; k < 40; ++k) {
    const Answer answer = random_answer(k);
    SCOPED_TRACE(k);
    EXPECT_TRUE(contains(answer.found, answer.proven)) << "[" << answer.proven.lo << ", " << answer.proven.hi
                                                       << "] of [" << answer.found.lo << ", " << answer.found.hi << "]";
    if (answer.found.lo > 0.0) ++apart;
  }
  EXPECT_GT(apart, 25);
}

/// Whatever the models are, what is proven has something in common with what was found; mostly it is the same.
TEST(SolidPairTest, NeverContradictsTheSearch) {
  oracle::RandomSolids solids(17);
  int same = 0;
  constexpr int pairs = 60;
  for (int k = 0; k < pairs; ++k) {
    const auto [a, b] = solids.pair();
    const double size = std::max(std::abs(a.primitives[0].superquadric.semi_axes[0]), 1e-3);
    const Answer answer = certified(a, b, {}, 1e-3 * size);
    EXPECT_LE(answer.proven.lo, answer.found.hi) << k;
    EXPECT_GE(answer.proven.hi, answer.found.lo) << k;
    if (contains(answer.found, answer.proven)) ++same;
  }
  fmt::print("{} of {} random pairs are proven as they were found\n", same, pairs);
  EXPECT_GT(same, pairs / 2);
}

/// A head in a cup that is a hollow: planes cannot separate them, the ball about the head does.
TEST(SolidPairTest, BallsProveHeadsInHollows) {
  const auto ball = [](double radius) { return Superquadric{{radius, radius, radius}, {1.0, 1.0}}; };
  const Model cup{"",
                  {{"shell", ball(28.0), {}},
                   {"hollow", ball(16.5), {}},
                   {"opening", {{60.0, 60.0, 60.0}, {0.1, 0.1}}, at(0, 0, 60.5)}},
                  SetExpression{{{.primitive = 0}, {.primitive = 1}, {.primitive = 2}}, SetOperation::subtract}};
  const Model head{"", {{"head", ball(16.0), {}}}};
  const Answer in_cup = certified(head, cup, at(0.0, 0.0, 0.25), 1e-6);
  EXPECT_LE(in_cup.proven.width(), 1e-6);
  EXPECT_GT(in_cup.proven.lo, 0.2499);
  EXPECT_EQ(in_cup.certificate.balls_a.size(), 1U);
  const Answer other_way = certified(cup, head, at(0.0, 0.0, -0.25), 1e-6);
  EXPECT_LE(other_way.proven.width(), 1e-6);
  EXPECT_EQ(other_way.certificate.balls_b.size(), 1U);
  const Model egg{"", {{"egg", {{15.0, 15.5, 16.0}, {1.0, 1.0}}, at(0.1, 0.0, -0.1)}}};
  EXPECT_GT(certified(egg, cup, {}, 1e-4).proven.lo, 0.0);
}

TEST(SolidPairTest, ACommonPointNeedsNothingElse) {
  const Answer answer = certified(example("bent_stem.json"), example("bent_stem.json"), at(0.001, 0.0, 0.0), 1e-4);
  ASSERT_TRUE(answer.certificate.common.has_value());
  EXPECT_EQ(answer.proven, (Enclosure{0.0, 0.0}));
}

/// What is removed from the certificate is proven no more.
TEST(SolidPairTest, NeverProvesAForgery) {
  oracle::Forgeries forgeries;
  const auto try_out = [&](const Answer& answer, const Enclosure& claimed, const char* what) {
    forgeries.expect_not_proved(check(answer, claimed), claimed, what);
  };
  /// The certificate changed: what it proves still holds, and less than all is proven no more.
  const auto change = [&](const Answer& answer, const char* what, const auto& make) {
    Answer changed = answer;
    make(changed.certificate);
    const Enclosure& truth = answer.found;
    try_out(changed, {moved(truth.hi, infinity), infinity}, what);
    if (truth.lo > 0.0) try_out(changed, {0.0, moved(truth.lo, -infinity)}, what);
  };
  for (std::size_t k = 0; k < oracle::requested_count("VERISQ_FORGED_SOLID_PAIRS", 16); ++k) {
    const Answer answer = random_answer(k);
    const Enclosure& truth = answer.found;
    RandomCases random(k);
    try_out(answer, {moved(truth.hi, infinity), infinity}, "lo past the truth");
    try_out(answer, {truth.hi, truth.lo - 1.0}, "lo above hi");
    Answer without = answer;
    without.certificate = {};
    try_out(without, {truth.lo, truth.hi}, "no proof");
    if (truth.lo == 0.0) continue;
    try_out(answer, {0.0, moved(truth.lo, -infinity)}, "hi past the truth");
    for (std::size_t i = 0; i < answer.certificate.divisions.size(); ++i) {
      const auto division = [i](PairCertificate& of) -> DividedSeparation& { return of.divisions[i]; };
      if (answer.certificate.divisions[i].planes.size() > 1) {
        change(answer, "a section without a plane", [&](PairCertificate& of) {
          division(of).cuts.pop_back();
          division(of).planes.pop_back();
        });
        change(answer, "one plane for all sections", [&](PairCertificate& of) {
          division(of).cuts = {SectionCut::none};
          division(of).planes.resize(1);
        });
      }
      for (int turn = 0; turn < 4; ++turn) {
        change(answer, "a digit of a plane", [&](PairCertificate& of) {
          SectionPlane& plane = division(of).planes[random.choice(division(of).planes.size())];
          const std::array numbers{plane.normal.data(), &plane.normal[1], &plane.normal[2], &plane.slope_a,
                                   &plane.slope_b};
          double& number = *numbers[random.choice(numbers.size())];
          number = with_wrong_digit(number, random);
        });
      }
    }
    change(answer, "a digit of a near point", [&](PairCertificate& of) {
      double& number = (*of.near_points)[random.choice(2)][random.choice(3)];
      number = with_wrong_digit(number, random);
    });
    change(answer, "a common point made up", [&](PairCertificate& of) { of.common = (*of.near_points)[0]; });
  }
  EXPECT_GT(forgeries.told(), 900U);
}

/// Of sections that have no plane nobody knows how far they are.
TEST(SolidPairTest, TreesThatAreCutShortProveNothing) {
  std::size_t cut_short = 0;
  for (std::size_t k = 0; k < 12; ++k) {
    const Answer answer = random_answer(k);
    const PairChecker checker(answer.a, answer.b);
    for (std::size_t i = 0; i < answer.certificate.divisions.size(); ++i) {
      DividedSeparation whole = answer.certificate.divisions[i];
      for (std::size_t length = 0; length < whole.cuts.size(); ++length, ++cut_short) {
        PairCertificate changed = answer.certificate;
        DividedSeparation& division = changed.divisions[i];
        division.cuts.resize(length);
        EXPECT_LE(checker.prove(answer.pose, changed).lo, answer.found.hi);
        division.planes.resize(static_cast<std::size_t>(std::ranges::count(division.cuts, SectionCut::none)));
        EXPECT_LE(checker.prove(answer.pose, changed).lo, answer.found.hi);
      }
    }
  }
  EXPECT_GT(cut_short, 100U);
}

/// Another case: the same certificate says nothing false of it.
TEST(SolidPairTest, CertificatesOfOtherCasesProveNothingFalse) {
  for (std::size_t k = 0; k < 20; ++k) {
    const Answer answer = random_answer(k);
    const Answer other = random_answer(k + 2);
    const Enclosure proven = PairChecker(other.a, other.b).prove(other.pose, answer.certificate);
    EXPECT_LE(proven.lo, other.found.hi);
    EXPECT_GE(proven.hi, other.found.lo);
  }
}

/// Whatever stands in a certificate, what is proved holds.
TEST(SolidPairTest, ProvesNothingFalseFromNonsense) {
  const Answer answer = random_answer(0);
  const PairChecker checker(answer.a, answer.b);
  RandomCases random(3);
  const std::array<double, 7> extremes{0.0, -0.0, 1e308, 5e-324, -1e-200, infinity, std::nan("")};
  const auto number = [&] { return random.choice(2) == 0 ? extremes[random.choice(7)] : random.uniform(-0.5, 0.5); };
  const auto vector = [&] { return Point{number(), number(), number()}; };
  for (int i = 0; i < 800; ++i) {
    PairCertificate nonsense = answer.certificate;
    for (DividedSeparation& division : nonsense.divisions) {
      if (random.choice(3) == 0) division.primitive_a = static_cast<std::uint32_t>(random.choice(6));
      if (random.choice(3) == 0) division.cuts.insert(division.cuts.begin(), SectionCut(random.choice(3)));
      for (SectionPlane& plane : division.planes) {
        if (random.choice(3) == 0) plane = {vector(), number(), number()};
      }
    }
    if (random.choice(4) == 0) nonsense.common = vector();
    if (random.choice(2) == 0) nonsense.near_points = {vector(), vector()};
    if (random.choice(3) == 0) {
      nonsense.balls_a = {{static_cast<std::uint32_t>(random.choice(6)), vector(), number(), number(), {{}, {}}}};
      nonsense.balls_a[0].proof.normals = {{static_cast<std::uint32_t>(random.choice(6)), vector()}};
    }
    const Enclosure proven = checker.prove(answer.pose, nonsense);
    EXPECT_LE(proven.lo, answer.found.hi);
    EXPECT_GE(proven.hi, answer.found.lo);
  }
}

}  // namespace
}  // namespace verisq
