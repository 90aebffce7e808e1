/// The proof that a ball lies inside a superquadric: up to the depth, never beyond.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {
namespace {

struct DepthCase {
  Superquadric solid;
  Proposal q;
  double depth;  ///< exact
};

class ContainedBallTest : public testing::TestWithParam<DepthCase> {};

TEST_P(ContainedBallTest, ReachesTheDepthAndNotBeyond) {
  const auto& [solid, q, depth] = GetParam();
  const SuperquadricBounds<Real> bounds(solid);
  EXPECT_TRUE(contains_ball(solid, bounds, precise(q), 0.0));
  EXPECT_TRUE(contains_ball(solid, bounds, precise(q), depth * (1.0 - 1e-6)));
  EXPECT_FALSE(contains_ball(solid, bounds, precise(q), depth * (1.0 + 1e-12)));
  EXPECT_FALSE(contains_ball(solid, bounds, precise(q), depth * 2.0));
  EXPECT_FALSE(contains_ball(solid, bounds, precise(q), INFINITY));
}

INSTANTIATE_TEST_SUITE_P(
    KnownDepths, ContainedBallTest,
    testing::Values(DepthCase{{{2.0, 2.0, 2.0}, {1.0, 1.0}}, {0.0L, 0.0L, 0.0L}, 2.0},     // centre: a continuum
                    DepthCase{{{2.0, 2.0, 2.0}, {1.0, 1.0}}, {0.75L, 0.0L, -1.0L}, 0.75},  // sphere
                    DepthCase{{{1.0, 1.0, 5.0}, {1.0, 1.0}}, {0.0L, 0.0L, 0.5L}, 0.9947780321927768},  // spindle
                    DepthCase{{{3.0, 2.0, 1.0}, {2.0, 2.0}}, {0.0L, 0.0L, 0.0L}, 6.0 / 7.0},           // octahedron
                    DepthCase{{{4.0, 0.5, 4.0}, {1.0, 1.0}}, {0.0L, 0.0L, 0.0L}, 0.5}));               // flat

TEST(ContainedBallTest, NothingLiesInsideAboutAPointOutside) {
  const Superquadric solid{{1.0, 2.0, 3.0}, {0.5, 1.5}};
  const SuperquadricBounds<Real> bounds(solid);
  EXPECT_FALSE(contains_ball(solid, bounds, precise(Proposal{0.99L, 1.99L, 0.0L}), 0.0));
  EXPECT_FALSE(contains_ball(solid, bounds, precise(Proposal{0.0L, 0.0L, 3.0000001L}), 1e-300));
}

/// A flat solid with sharp edges: the distance to its face is the depth almost to the edge, and the cones find it.
TEST(ContainedBallTest, FacesOfABoxAreProvenToTheLastBits) {
  const Superquadric box{{1.0, 1.0, 1.0}, {0.05, 0.05}};
  const SuperquadricBounds<Real> bounds(box);
  EXPECT_TRUE(contains_ball(box, bounds, precise(Proposal{0.0L, 0.0L, 0.0L}), 1.0 - 1e-12));
  EXPECT_FALSE(contains_ball(box, bounds, precise(Proposal{0.0L, 0.0L, 0.0L}), 1.0 + 1e-12));
}

/// The proof would succeed; interrupted, it stays open and looks at no further cone.
TEST(ContainedBallTest, EndsOnceInterrupted) {
  const Superquadric solid{{3.0, 2.0, 1.0}, {0.7, 0.8}};
  const SuperquadricBounds<Real> bounds(solid);
  const PreciseVector q = precise(Proposal{0.3L, 0.2L, 0.1L});
  int asked = 0;
  const auto after = [&asked](int most) { return [&asked, most] { return ++asked > most; }; };
  ASSERT_TRUE(contains_ball(solid, bounds, q, 0.89, after(1000)));
  ASSERT_GT(asked, 2);  // once a cone that is cut in two
  asked = 0;
  EXPECT_FALSE(contains_ball(solid, bounds, q, 0.89, after(1)));
  EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace verisq::verify
