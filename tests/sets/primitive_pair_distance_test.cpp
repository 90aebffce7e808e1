/// Lower bounds of the distance of two primitives: beside the proof of convex pairs, and across the hollow of a bend.
#include "verify/search/primitive_pair_distance.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>

#include "tests/oracle/random_cases.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

constexpr std::uint64_t many = 100000;

bool never() {
  return false;
}

double lower(const Primitive& a, const Primitive& b, const Pose& pose, double tolerance) {
  const SeparablePrimitive of_a(a);
  const SeparablePrimitive of_b(b);
  PrimitivePairDistance distance(of_a, of_b, pose, tolerance);
  distance.raise(infinity, many, never);
  return distance.lower();
}

TEST(PrimitivePairDistanceTest, ConvexPairsAreWithinTheToleranceOfTheirProof) {
  RandomCases cases(71);
  const auto solid = [&] {
    return Superquadric{{cases.uniform(0.3, 1.5), cases.uniform(0.3, 1.5), cases.uniform(0.3, 1.5)},
                        {cases.uniform(0.2, 1.8), cases.uniform(0.2, 1.8)}};
  };
  for (int trial = 0; trial < 100; ++trial) {
    const Primitive a = cases.solid(solid());
    const Primitive b = cases.solid(solid());
    Point towards = cases.direction();
    for (double& t : towards) t *= 8.0;
    const Pose pose{towards, {cases.uniform(-1, 1), cases.uniform(-1, 1), cases.uniform(-1, 1), 0.5}};
    const Enclosure proven = PairDistance(Model{"", {a}}, Model{"", {b}})(pose).distance;
    const double found = lower(a, b, pose, 1e-7);
    EXPECT_LE(found, proven.hi);
    EXPECT_GE(found, proven.lo - 1e-7) << "trial " << trial;
  }
}

TEST(PrimitivePairDistanceTest, ABallInTheHollowOfABend) {
  // A thin rod bent by a third of a turn to the circle of radius 1 about (1, 0, 0), with a ball about that centre: no
  // plane separates the two, and every section is as near.
  constexpr double thin = 0.05;
  const Primitive rod{"", {{thin, thin, std::numbers::pi / 3}, {0.1, 1.0}}, {}, Bend{1.0, 0.0}};
  const Primitive ball{"", {{0.5, 0.5, 0.5}, {1.0, 1.0}}, {}};
  const double found = lower(rod, ball, {{1.0, 0.0, 0.0}, {1, 0, 0, 0}}, 1e-4);
  EXPECT_LE(found, 0.5 - thin);
  EXPECT_GE(found, 0.5 - thin - 3e-4);
}

TEST(PrimitivePairDistanceTest, SolidsThatMeetAreNotSeparated) {
  const Primitive ball{"", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}};
  EXPECT_EQ(lower(ball, ball, {{1.5, 0.0, 0.0}, {1, 0, 0, 0}}, 1e-6), 0.0);
  const Primitive bent{"", {{0.5, 0.5, 1.0}, {1.0, 1.0}}, {}, Bend{0.5, 30.0}};
  EXPECT_EQ(lower(bent, ball, {{0.5, 0.5, 0.0}, {1, 0, 0, 0}}, 1e-6), 0.0);
}

TEST(PrimitivePairDistanceTest, WhatIsNotYetKnownIsNotClaimed) {
  const SeparablePrimitive ball({"", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}});
  PrimitivePairDistance distance(ball, ball, {{5.0, 0.0, 0.0}, {1, 0, 0, 0}}, 1e-6);
  EXPECT_EQ(distance.lower(), 0.0);
  EXPECT_FALSE(distance.near_points());
  EXPECT_FALSE(distance.raise(infinity, many, [] { return true; }));
  EXPECT_EQ(distance.lower(), 0.0);
  EXPECT_TRUE(distance.raise(infinity, many, never));
  EXPECT_NEAR(distance.lower(), 3.0, 1e-6);
  ASSERT_TRUE(distance.near_points());
  EXPECT_NEAR(distance.near_points()->on_a[0], 1.0, 1e-3);
  EXPECT_NEAR(distance.near_points()->on_b[0], -1.0, 1e-3);
}

}  // namespace
}  // namespace verisq::verify
