/// Covers about primitives prove pairs that nothing else does, necks beside the rims of cups, and never what is false.
/// VERISQ_FORGED_JOINTS says how many pairs are tried.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/hip_joint.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verisq/distance.hpp"

namespace verisq {
namespace {

using oracle::moved;
using oracle::RandomCases;
using testing::hip_joint;
using testing::hip_pose;
using testing::HipJoint;

constexpr double tolerance = 1e-3;

struct Answer {
  HipJoint joint;
  Pose pose;
  SearchedDistance found;
  CertifiedDistance certified;
};

Answer answer_of(RandomCases& random) {
  const HipJoint joint = hip_joint(random);
  const Pose pose = hip_pose(random);
  const ModelSearch search(joint.cup, joint.neck);
  const SearchOptions options{.tolerance = tolerance};
  const SearchedDistance found = search(pose, options);
  return {joint, pose, found, search.certified(pose, found, options)};
}

TEST(SurroundedPrimitiveTest, ProvesNecksBesideRims) {
  RandomCases random(71);
  int apart = 0;
  int covered = 0;
  int tight = 0;
  for (int k = 0; k < 30; ++k) {
    SCOPED_TRACE(k);
    const Answer answer = answer_of(random);
    const Enclosure& proven = answer.certified.distance;
    const PairChecker checker(answer.joint.cup, answer.joint.neck);
    EXPECT_EQ(checker(answer.pose, proven, answer.certified.certificate).verdict, Verdict::proved);
    EXPECT_LE(proven.lo, answer.found.distance.hi);
    if (!(answer.found.distance.lo > 0.0)) continue;
    ++apart;
    covered += answer.certified.certificate.covers_b.empty() ? 0 : 1;
    tight += proven.width() <= 1.01 * tolerance ? 1 : 0;
  }
  fmt::print("{} apart, {} by covers, {} to the tolerance\n", apart, covered, tight);
  EXPECT_GT(apart, 15);
  EXPECT_GT(covered, 10);
  EXPECT_GT(tight, apart * 8 / 10);
}

TEST(SurroundedPrimitiveTest, ProvesThemOfEitherModel) {
  RandomCases random(72);
  const HipJoint joint = hip_joint(random);
  const ModelSearch search(joint.neck, joint.cup);
  const SearchOptions options{.tolerance = tolerance};
  const Pose pose{{0.1, 0.2, 0.3}, {1.0, 0.15, 0.1, 0.3}};
  const CertifiedDistance certified = search.certified(pose, search(pose, options), options);
  EXPECT_GT(certified.distance.lo, 0.0);
  EXPECT_LE(certified.distance.width(), 1.01 * tolerance);
  EXPECT_FALSE(certified.certificate.covers_a.empty() && certified.certificate.covers_b.empty());
  EXPECT_EQ(PairChecker(joint.neck, joint.cup)(pose, certified.distance, certified.certificate).verdict,
            Verdict::proved);
}

/// Points of the primitive, beside the search: none is nearer to the cup than the cover says.
TEST(SurroundedPrimitiveTest, NoPointOfThePrimitiveIsNearer) {
  RandomCases random(73);
  std::size_t seen = 0;
  for (int k = 0; k < 8; ++k) {
    SCOPED_TRACE(k);
    const Answer answer = answer_of(random);
    const SignedDistance distance(answer.joint.cup);
    for (const SurroundedPrimitive& cover : answer.certified.certificate.covers_b) {
      const Primitive primitive = posed(answer.joint.neck, answer.pose).primitives[cover.primitive];
      const auto farthest = verify::posed_set<double>(primitive);
      for (int i = 0; i < 60; ++i, ++seen) {
        const auto x = farthest({random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
        EXPECT_GE(distance({x[0], x[1], x[2]}, 1e-3).hi, cover.distance - 1e-9);
      }
    }
  }
  EXPECT_GT(seen, 200U);
}

TEST(SurroundedPrimitiveTest, NoForgeryIsProved) {
  oracle::Forgeries forgeries;
  RandomCases random(74);
  for (std::size_t k = 0; k < oracle::requested_count("VERISQ_FORGED_JOINTS", 6); ++k) {
    SCOPED_TRACE(k);
    const Answer answer = answer_of(random);
    const Enclosure& truth = answer.found.distance;
    if (!(truth.lo > 0.0)) continue;
    const PairChecker checker(answer.joint.cup, answer.joint.neck);
    const Pose other = hip_pose(random);
    const Enclosure found = ModelSearch(answer.joint.cup, answer.joint.neck)(other, {.tolerance = 0.1}).distance;
    const auto try_out = [&](const char* what, const auto& change) {
      PairCertificate forged = answer.certified.certificate;
      for (SurroundedPrimitive& cover : forged.covers_b) change(cover);
      for (const Enclosure& claim : {Enclosure{moved(truth.hi, 1.0), infinity}, Enclosure{0.0, moved(truth.lo, -1.0)}})
        forgeries.expect_not_proved(checker(answer.pose, claim, forged), claim, what);
      // Of a place of which nothing is known but what is proven anew.
      EXPECT_LE(checker.prove(other, forged).lo, found.hi) << what;
    };
    try_out("nothing changed", [](SurroundedPrimitive&) {});
    try_out("a larger distance", [&](SurroundedPrimitive& c) { c.distance = moved(truth.hi, 1.0); });
    try_out("a much larger distance", [&](SurroundedPrimitive& c) { c.distance *= 2.0; });
    try_out("no number", [](SurroundedPrimitive& c) { c.distance = std::numeric_limits<double>::quiet_NaN(); });
    try_out("without end", [](SurroundedPrimitive& c) { c.distance = infinity; });
    try_out("below 0", [](SurroundedPrimitive& c) { c.distance = -1.0; });
    try_out("one cell", [&](SurroundedPrimitive& c) {
      c.distance = moved(truth.hi, 1.0);
      c.cover = {false};
    });
    try_out("cut short", [&](SurroundedPrimitive& c) {
      c.distance = moved(truth.hi, 1.0);
      c.cover.resize(c.cover.size() / 2);
    });
    try_out("no primitive", [](SurroundedPrimitive& c) { c.primitive = 7; });
    try_out("another primitive", [](SurroundedPrimitive& c) { c.primitive = 1 - c.primitive; });
    for (int i = 0; i < 6; ++i) {
      try_out("a bit", [&](SurroundedPrimitive& c) {
        c.distance = moved(truth.hi, 1.0);
        const std::size_t at = random.choice(c.cover.size());
        c.cover[at] = !c.cover[at];
      });
    }
  }
  EXPECT_GT(forgeries.told(), 100U);
}

/// A cover, too, ends within its cells: what is proven then is less, and true.
TEST(SurroundedPrimitiveTest, AnInterruptedCheckProvesLess) {
  RandomCases random(76);
  Answer answer = answer_of(random);
  while (answer.certified.certificate.covers_b.empty()) answer = answer_of(random);
  const PairChecker checker(answer.joint.cup, answer.joint.neck);
  int asked = 0;
  const Enclosure whole = checker.prove(answer.pose, answer.certified.certificate, [&] {
    ++asked;
    return false;
  });
  EXPECT_GT(whole.lo, 0.0);
  const int all = std::exchange(asked, 0);
  ASSERT_GT(all, 1);
  const Enclosure less = checker.prove(answer.pose, answer.certified.certificate, [&] { return ++asked > 1; });
  EXPECT_LT(less.lo, whole.lo);
  EXPECT_GE(less.hi, whole.hi);
  EXPECT_LE(asked, all);
}

/// Of a bend the support function would be that of another solid.
TEST(SurroundedPrimitiveTest, BentPrimitivesHaveNoCovers) {
  RandomCases random(75);
  Answer answer = answer_of(random);
  while (answer.certified.certificate.covers_b.empty()) answer = answer_of(random);
  for (Primitive& primitive : answer.joint.neck.primitives)
    primitive.bend = Bend{.curvature = 0.01, .angle_degrees = 0.0};
  const PairChecker checker(answer.joint.cup, answer.joint.neck);
  PairCertificate covers_alone;
  covers_alone.covers_b = answer.certified.certificate.covers_b;
  EXPECT_EQ(checker.prove(answer.pose, covers_alone).lo, 0.0);
}

}  // namespace
}  // namespace verisq
