/// Support functions of sections of bent solids: no point reaches farther, and thin sections reach almost as far.
#include <gtest/gtest.h>

#include <vector>

#include "tests/oracle/bent_surface.hpp"
#include "verify/search/primitive_pair_distance.hpp"

namespace verisq::verify {
namespace {

using oracle::BentSurfacePoint;
using oracle::dot_of;
using oracle::random_bend;
using oracle::random_long_solid;
using oracle::random_surface_points;
using oracle::RandomCases;

double reach(const SectionedPrimitive& primitive, const Point& n, const SectionedPrimitive::Section& section) {
  return primitive.support_up({Interval(n[0]), Interval(n[1]), Interval(n[2])}, section);
}

TEST(SectionedPrimitiveTest, NoPointOfASectionReachesFarther) {
  RandomCases cases(61);
  for (int trial = 0; trial < 60; ++trial) {
    const Superquadric solid = random_long_solid(cases);
    const Bend bend = random_bend(cases, solid);
    const SectionedPrimitive primitive({"", solid, {}, bend});
    std::vector<SectionedPrimitive::Section> sections{primitive.whole()};
    for (std::size_t i = 0; i < 7; ++i) {
      const auto halves = primitive.halves(sections[i]);
      ASSERT_TRUE(halves);
      sections.insert(sections.end(), halves->begin(), halves->end());
    }
    const std::vector<BentSurfacePoint> samples = random_surface_points(cases, solid, bend, 2000);
    for (int directions = 0; directions < 10; ++directions) {
      const Point n = cases.direction();
      for (const SectionedPrimitive::Section& section : sections) {
        const double bound = reach(primitive, n, section);
        for (const auto& [point, height] : samples) {
          if (height < section.lower.height || height > section.upper.height) continue;
          ASSERT_LE(dot_of(n, point), bound + 1e-12) << "trial " << trial;
        }
      }
    }
  }
}

TEST(SectionedPrimitiveTest, ProposedPointsReachAsFarAsTheBoundButForTheSlack) {
  RandomCases cases(62);
  for (int trial = 0; trial < 2000; ++trial) {
    const Superquadric solid = random_long_solid(cases);
    Bend bend = random_bend(cases, solid);
    bend.curvature *= 0.1;
    const SectionedPrimitive primitive({"", solid, {}, bend});
    SectionedPrimitive::Section section = primitive.whole();
    for (int i = 0; i < 10; ++i) {
      const Point n = cases.direction();
      const double bound = reach(primitive, n, section);
      const double proposed = dot_of(n, primitive.support_point(n, section));
      EXPECT_LE(proposed, bound + 1e-12);
      EXPECT_GE(proposed, bound - 2.0 * primitive.slack(section) - 1e-10) << "trial " << trial << " depth " << i;
      section = (*primitive.halves(section))[cases.choice(2)];
    }
  }
}

TEST(SectionedPrimitiveTest, WithoutABendItIsTheSupportFunction) {
  const SectionedPrimitive ball({"", {{2.0, 2.0, 2.0}, {1.0, 1.0}}, {}});
  EXPECT_FALSE(ball.halves(ball.whole()));
  EXPECT_EQ(ball.slack(ball.whole()), 0.0);
  for (const Point& n : {Point{1, 0, 0}, Point{0, -1, 0}, Point{0.6, 0, 0.8}}) {
    EXPECT_NEAR(reach(ball, n, ball.whole()), 2.0, 1e-14);
  }
  // About the centre, not the focus: the ends of the axis stay.
  const SectionedPrimitive tapered({"", {{1.0, 1.0, 3.0}, {1.0, 1.0}, 4.0}, {}});
  EXPECT_NEAR(reach(tapered, {0, 0, 1}, tapered.whole()), 3.0, 1e-13);
  EXPECT_NEAR(reach(tapered, {0, 0, -1}, tapered.whole()), 3.0, 1e-13);
}

}  // namespace
}  // namespace verisq::verify
