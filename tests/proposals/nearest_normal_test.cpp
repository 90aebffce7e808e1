/// Nearest normals: that the half-spaces and distances that they propose are tight, of flat, round and tapered solids.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "verify/proposals/gjk.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {
namespace {

class NearestNormalOf : public ::testing::TestWithParam<Superquadric> {};

TEST_P(NearestNormalOf, ProvesADistanceThatIsNearlyTheExactOne) {
  const Superquadric& solid = GetParam();
  const NearestNormal nearest(solid);
  const SuperquadricBounds<Real> bounds(solid);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int outside = 0;
  for (int i = 0; i < 300; ++i) {
    Coordinates<double> q{};
    for (std::size_t k = 0; k < 3; ++k) q[k] = 2.0 * solid.semi_axes[k] * uniform(random);
    const auto [normal, distance] = nearest(q);
    ASSERT_NEAR(std::hypot(normal[0], normal[1], normal[2]), 1.0, 1e-9);
    const PreciseVector exact{Real(q[0]), Real(q[1]), Real(q[2])};
    const double proven = lower_bound(bounds, exact, {normal[0], normal[1], normal[2]});
    if (distance > 0.0) {
      ++outside;
      EXPECT_NEAR(proven, distance, 1e-5 * (1.0 + distance)) << i;
    } else {
      EXPECT_LE(proven, distance + 1e-9) << i;  // the plane where the last walk ended is no nearer than that
    }
  }
  EXPECT_GT(outside, 100);
}

INSTANTIATE_TEST_SUITE_P(Solids, NearestNormalOf,
                         ::testing::Values(Superquadric{{4.0, 5.0, 12.0}, {1.0, 1.0}},
                                           Superquadric{{4.0, 5.0, 12.0}, {0.2, 0.3}},
                                           Superquadric{{6.0, 9.0, 60.0}, {0.4, 0.9}},
                                           Superquadric{{6.0, 9.0, 30.0}, {0.4, 0.9}, 3.0}));

}  // namespace
}  // namespace verisq::verify
