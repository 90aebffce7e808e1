/// How far sections reach, for any slope: no point of them reaches farther.
#include <gtest/gtest.h>

#include <vector>

#include "tests/oracle/bent_surface.hpp"
#include "verify/proof/solid_pair.hpp"
#include "verify/search/primitive_pair_distance.hpp"

namespace verisq::verify {
namespace {

using oracle::BentSurfacePoint;
using oracle::dot_of;
using oracle::random_bend;
using oracle::random_long_solid;
using oracle::random_surface_points;
using oracle::RandomCases;

double reach(const PosedSections& primitive, const Point& n, const PosedSections::Section& section, double slope) {
  return primitive.reach(precise(n), section, slope).to_double(Direction::up);
}

TEST(PosedSectionsTest, NoPointOfASectionReachesFartherWhateverTheSlope) {
  RandomCases cases(71);
  for (int trial = 0; trial < 40; ++trial) {
    const Superquadric solid = random_long_solid(cases);
    const Bend bend = random_bend(cases, solid);
    const PosedSections primitive({"", solid, {}, bend});
    std::vector<PosedSections::Section> sections{primitive.whole()};
    for (std::size_t i = 0; i < 7; ++i) {
      const auto parts = halves(sections[i]);
      ASSERT_TRUE(parts);
      sections.insert(sections.end(), parts->begin(), parts->end());
    }
    const std::vector<BentSurfacePoint> samples = random_surface_points(cases, solid, bend, 1000);
    for (const PosedSections::Section& section : sections) {
      const Point n = cases.direction();
      const double bound = reach(primitive, n, section, cases.uniform(-2.0, 2.0));
      for (const auto& [point, height] : samples) {
        if (height < section.lower || height > section.upper) continue;
        ASSERT_LE(dot_of(n, point), bound + 1e-12) << "trial " << trial;
      }
    }
  }
}

/// With the slopes that the search proposes its bounds, but for rounding.
TEST(PosedSectionsTest, ReachAsFarAsTheSearchSays) {
  RandomCases cases(72);
  for (int trial = 0; trial < 500; ++trial) {
    const Superquadric solid = random_long_solid(cases);
    const Bend bend = random_bend(cases, solid);
    const SectionedPrimitive searched({"", solid, {}, bend});
    const PosedSections primitive({"", solid, {}, bend});
    SectionedPrimitive::Section section = searched.whole();
    PosedSections::Section same = primitive.whole();
    for (int depth = 0; depth < 8; ++depth) {
      const Point n = cases.direction();
      const double found = searched.support_up({Interval(n[0]), Interval(n[1]), Interval(n[2])}, section);
      EXPECT_NEAR(reach(primitive, n, same, searched.slope({n[0], n[1], n[2]}, section)), found, 1e-11);
      const std::size_t half = cases.choice(2);
      section = (*searched.halves(section))[half];
      same = (*halves(same))[half];
    }
  }
}

TEST(PosedSectionsTest, WithoutABendItIsTheSupportFunctionAboutTheCentre) {
  const PosedSections ball({"", {{2.0, 2.0, 2.0}, {1.0, 1.0}}, {}});
  EXPECT_NEAR(reach(ball, {0.6, 0, 0.8}, ball.whole(), 7.0), 2.0, 1e-14);
  const PosedSections tapered({"", {{1.0, 1.0, 3.0}, {1.0, 1.0}, 4.0}, {}});
  EXPECT_NEAR(reach(tapered, {0, 0, 1}, tapered.whole(), 0.0), 3.0, 1e-13);
  EXPECT_NEAR(reach(tapered, {0, 0, -1}, tapered.whole(), 0.0), 3.0, 1e-13);
}

TEST(PosedSectionsTest, NothingIsHalvedBetweenNeighbouringNumbers) {
  EXPECT_FALSE(halves({1.0, 1.0 + 0x1p-52}));
  EXPECT_FALSE(halves({1.0, 1.0}));
}

}  // namespace
}  // namespace verisq::verify
