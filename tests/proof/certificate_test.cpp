/// Gauge, support function and the certificates made of them: bounds that hold for any proposal, tight for good ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "verify/search/certified_distance.hpp"
#include "verify/search/contact.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

constexpr long double kNaN = std::numeric_limits<long double>::quiet_NaN();

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  Proposal direction() { return {normal_(engine_), normal_(engine_), normal_(engine_)}; }
  /// Exponents in [0.05, 2], at times 1 or 2 exactly; semi-axes with ratios to 400.
  Superquadric solid() {
    Superquadric solid{};
    for (double& a : solid.semi_axes) a = std::pow(400.0, uniform(0.0, 1.0));
    for (double& e : solid.exponents) {
      const double kind = uniform(0.0, 1.0);
      e = kind < 0.15 ? 2.0 : kind < 0.25 ? 1.0 : uniform(0.05, 2.0);
    }
    return solid;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

double middle(const PreciseInterval& x) {
  return static_cast<double>(x.lower().to_long_double());
}

double relative_width(const PreciseInterval& x) {
  return ((PreciseInterval(x.upper()) - PreciseInterval(x.lower())) / PreciseInterval(x.upper()))
      .upper()
      .to_double(Direction::up);
}

bool intersects(const PreciseInterval& a, const PreciseInterval& b) {
  return a.lower() <= b.upper() && b.lower() <= a.upper();
}

double largest(const Superquadric& solid) {
  return std::ranges::max(solid.semi_axes);
}

/// x / g(x), a point of the surface to within rounding.
Proposal on_surface(const SuperquadricBounds<Real>& bounds, const Proposal& x, long double factor = 1.0L) {
  const long double gauge = bounds.gauge(precise(x)).upper().to_long_double();
  return {x[0] / gauge * factor, x[1] / gauge * factor, x[2] / gauge * factor};
}

TEST(SuperquadricTest, EllipsoidHasEuclideanNorms) {
  const Superquadric ellipsoid{{2.0, 3.0, 5.0}, {1.0, 1.0}};
  const SuperquadricBounds<Real> bounds(ellipsoid);
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const PreciseVector v = precise(random.direction());
    PreciseVector scaled;
    PreciseVector shrunk;
    for (std::size_t k = 0; k < 3; ++k) {
      const PreciseInterval a = Real(ellipsoid.semi_axes[k]);
      scaled[k] = v[k] * a;
      shrunk[k] = v[k] / a;
    }
    EXPECT_TRUE(intersects(bounds.support(v), length<Real>(scaled)));
    EXPECT_TRUE(intersects(bounds.gauge(v), length<Real>(shrunk)));
    EXPECT_LT(relative_width(bounds.support(v)), 1e-36);
    EXPECT_LT(relative_width(bounds.gauge(v)), 1e-36);
  }
}

TEST(SuperquadricTest, OctahedronHasSumAndMaximumNorms) {
  const SuperquadricBounds<Real> bounds({{1.0, 2.0, 4.0}, {2.0, 2.0}});
  const PreciseVector v = precise(Proposal{-3.0L, 1.0L, -0.5L});
  EXPECT_DOUBLE_EQ(middle(bounds.gauge(v)), 3.0 + 0.5 + 0.125);
  EXPECT_EQ(bounds.support(v).lower().to_double(Direction::down), 3.0);
  EXPECT_EQ(bounds.support(v).upper().to_double(Direction::up), 3.0);
}

TEST(SuperquadricTest, BoxesOfPointsAreEnclosedWithoutOverestimation) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const SuperquadricBounds<double> bounds(random.solid());
    Vector3<double> box;
    Vector3<double> nearest;
    Vector3<double> farthest;
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = random.uniform(-3.0, 3.0);
      const double b = random.uniform(-3.0, 3.0);
      box[k] = Interval(std::min(a, b), std::max(a, b));
      nearest[k] = a * b < 0.0 ? 0.0 : std::min(std::fabs(a), std::fabs(b));
      farthest[k] = std::max(std::fabs(a), std::fabs(b));
    }
    EXPECT_EQ(bounds.gauge(box).lower(), bounds.gauge(nearest).lower());
    EXPECT_EQ(bounds.gauge(box).upper(), bounds.gauge(farthest).upper());
    EXPECT_EQ(bounds.support(box).upper(), bounds.support(farthest).upper());
  }
}

TEST(SuperquadricTest, BothPrecisionsAgree) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Superquadric solid = random.solid();
    const Proposal x = random.direction();
    const SuperquadricBounds<double> coarse(solid);
    const PreciseInterval fine = SuperquadricBounds<Real>(solid).gauge(precise(x));
    const Vector3<double> v(static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2]));
    const Interval wide = coarse.gauge(v);
    EXPECT_LE(wide.lower(), fine.upper().to_double(Direction::up));
    EXPECT_GE(wide.upper(), fine.lower().to_double(Direction::down));
    EXPECT_LT(wide.upper() - wide.lower(), 1e-14 * wide.upper());
  }
}

/// v·x <= g(x) h(v) for all x and v: a support function too small, or a gauge too small, would break it for some pair.
TEST(SuperquadricTest, GaugeAndSupportAreDual) {
  Random random(4);
  for (int i = 0; i < 5000; ++i) {
    const SuperquadricBounds<Real> bounds(random.solid());
    const PreciseVector x = precise(random.direction());
    const PreciseVector v = precise(random.direction());
    ASSERT_FALSE(v.dot(x).lower() > (bounds.gauge(x) * bounds.support(v)).upper());
  }
}

TEST(SuperquadricTest, ExtremeExponentsTendToBoxes) {
  for (const double e : {5e-324, 1e-300, 1e-16}) {
    const SuperquadricBounds<Real> bounds({{1.0, 2.0, 3.0}, {e, e}});
    EXPECT_NEAR(middle(bounds.gauge(precise(Proposal{0.5L, 1.5L, 1.0L}))), 0.75, 1e-12);
    EXPECT_NEAR(middle(bounds.support(precise(Proposal{1.0L, 1.0L, 1.0L}))), 6.0, 1e-12);
  }
  const double nearly_two = std::nextafter(2.0, 0.0);
  const SuperquadricBounds<Real> octahedron({{1.0, 1.0, 1.0}, {nearly_two, nearly_two}});
  EXPECT_NEAR(middle(octahedron.support(precise(Proposal{3.0L, 2.0L, 1.0L}))), 3.0, 1e-12);
}

TEST(CertificateTest, AnyDirectionBoundsFromBelow) {
  const SuperquadricBounds<Real> sphere({{2.0, 2.0, 2.0}, {1.0, 1.0}});
  Random random(5);
  for (const long double distance : {-1.5L, -1e-9L, 1e-9L, 1.0L, 1e6L}) {
    const PreciseVector q = precise(Proposal{0.0L, 2.0L + distance, 0.0L});
    const auto exact = static_cast<double>((2.0L + distance) - 2.0L);
    for (int i = 0; i < 100; ++i) EXPECT_LE(lower_bound(sphere, q, random.direction()), exact + 1e-15);
    EXPECT_NEAR(lower_bound(sphere, q, {0.0L, 7.0L, 0.0L}), exact, std::fabs(exact) * 3e-16);
  }
}

TEST(CertificateTest, AnyPointBoundsFromAbove) {
  const SuperquadricBounds<Real> sphere({{2.0, 2.0, 2.0}, {1.0, 1.0}});
  Random random(6);
  const PreciseVector q = precise(Proposal{0.0L, 0.0L, -5.0L});
  for (int i = 0; i < 100; ++i) EXPECT_GE(upper_bound(sphere, q, random.direction()), 3.0);
  EXPECT_EQ(upper_bound(sphere, q, {0.0L, 0.0L, -17.0L}), 3.0);
}

TEST(CertificateTest, UselessProposalsGiveUselessBounds) {
  const SuperquadricBounds<Real> sphere({{1.0, 1.0, 1.0}, {1.0, 1.0}});
  const PreciseVector q = precise(Proposal{0.0L, 3.0L, 4.0L});
  for (const Proposal& bad : {Proposal{0.0L, 0.0L, 0.0L}, Proposal{kNaN, 1.0L, 1.0L}, Proposal{1.0L, infinity, 0.0L}}) {
    EXPECT_EQ(lower_bound(sphere, q, bad), -infinity);
    EXPECT_EQ(upper_bound(sphere, q, bad), 5.0);
  }
}

/// A box of points gets bounds that hold for all of them.
TEST(CertificateTest, ThickPointsAreBoundedAsAWhole) {
  const SuperquadricBounds<Real> sphere({{1.0, 1.0, 1.0}, {1.0, 1.0}});
  const PreciseVector q(PreciseInterval(Real(2.5), Real(3.5)), PreciseInterval(0), PreciseInterval(0));
  EXPECT_LE(lower_bound(sphere, q, {1.0L, 0.0L, 0.0L}), 1.5);
  EXPECT_GE(upper_bound(sphere, q, {1.0L, 0.0L, 0.0L}), 2.5);
}

/// From 1e-9 to 1e6 radii outside, both certificates of the proposed contact meet at rounding level.
TEST(ExteriorTest, CertificatesMeet) {
  Random random(7);
  for (int i = 0; i < 3000; ++i) {
    const Superquadric solid = random.solid();
    const SuperquadricBounds<Real> bounds(solid);
    const Proposal outside = on_surface(bounds, random.direction(), 1.0L + std::exp(random.uniform(-20.0, 14.0)));
    const Contact contact = fast_contact(solid, outside);
    const PreciseVector q = precise(outside);
    const double lo = lower_bound(bounds, q, contact.normal);
    const double hi = upper_bound(bounds, q, contact.point);
    const double size = std::max(largest(solid), length<Real>(q).upper().to_double(Direction::up));
    ASSERT_GT(lo, 0.0);
    ASSERT_LE(lo, hi);
    ASSERT_LE(hi - lo, 1e-14 * size);
  }
}

TEST(ExteriorTest, CoordinatePlanesAxesAndNearlyZeroCoordinates) {
  Random random(8);
  for (int i = 0; i < 3000; ++i) {
    const Superquadric solid = random.solid();
    const SuperquadricBounds<Real> bounds(solid);
    Proposal x = random.direction();
    for (long double& c : x) {
      const double kind = random.uniform(0.0, 1.0);
      c *= kind < 0.3 ? 0.0L : kind < 0.5 ? 1e-12L : 1.0L;
    }
    if (!usable(x)) continue;
    const Proposal outside = on_surface(bounds, x, 1.0L + std::exp(random.uniform(-15.0, 7.0)));
    const Contact contact = fast_contact(solid, outside);
    const PreciseVector q = precise(outside);
    const double size = std::max(largest(solid), length<Real>(q).upper().to_double(Direction::up));
    ASSERT_LE(upper_bound(bounds, q, contact.point) - lower_bound(bounds, q, contact.normal), 1e-14 * size);
  }
}

/// At e = 2 the solid has faces, edges and vertices; each is the nearest feature of some point.
TEST(ExteriorTest, FacesEdgesAndVerticesOfTheOctahedron) {
  const Superquadric solid{{1.0, 1.0, 1.0}, {2.0, 2.0}};
  const SuperquadricBounds<Real> bounds(solid);
  const auto expect_distance = [&](const Proposal& q, double exact) {
    const Contact contact = fast_contact(solid, q);
    EXPECT_NEAR(lower_bound(bounds, precise(q), contact.normal), exact, 1e-15);
    EXPECT_NEAR(upper_bound(bounds, precise(q), contact.point), exact, 1e-15);
  };
  expect_distance({1.0L, 1.0L, 1.0L}, 2.0 / std::sqrt(3.0));       // face
  expect_distance({1.0L, 1.0L, 0.0L}, 1.0 / std::sqrt(2.0));       // edge of the section
  expect_distance({1.0L, 0.0L, -1.0L}, 1.0 / std::sqrt(2.0));      // edge to the pole
  expect_distance({0.25L, -0.25L, 3.0L}, std::sqrt(4.0 + 0.125));  // pole
  expect_distance({-4.0L, 0.5L, 0.5L}, std::sqrt(9.0 + 0.5));      // vertex of the section
}

/// Exponents far below 0.05 and next to 2 defeat logarithms in long double; the second proposal takes over.
TEST(ExteriorTest, EveryExponentIsTight) {
  Random random(9);
  for (int i = 0; i < 2000; ++i) {
    Superquadric solid = random.solid();
    for (double& e : solid.exponents) {
      const double kind = random.uniform(0.0, 1.0);
      if (kind < 0.4) e = std::exp(-random.uniform(3.0, 740.0));
      if (kind > 0.6) e = std::max(1.0, 2.0 - std::exp(-random.uniform(10.0, 36.0)));
    }
    const SuperquadricBounds<Real> bounds(solid);
    const Proposal outside = on_surface(bounds, random.direction(), 1.0L + std::exp(random.uniform(-15.0, 7.0)));
    const PreciseVector q = precise(outside);
    const double size = std::max(largest(solid), length<Real>(q).upper().to_double(Direction::up));
    ASSERT_LE(exterior_distance(solid, bounds, q, 0.0).distance.width(), 1.001e-14 * size);
  }
}

/// Against samples: no surface point is nearer than the proven depth, no plane nearer than the proven bound.
TEST(InteriorTest, DepthIsBelowEverySampledSurfacePoint) {
  Random random(10);
  for (int i = 0; i < 200; ++i) {
    const Superquadric solid = random.solid();
    const SuperquadricBounds<Real> bounds(solid);
    const Proposal inside = on_surface(bounds, random.direction(), random.uniform(0.0, 1.0));
    const PreciseVector q = precise(inside);
    ASSERT_TRUE(bounds.gauge(q).upper() <= Real(1));
    const double tolerance = 1e-6 * largest(solid);
    const PrimitiveDistance found = interior_distance(solid, bounds, q, tolerance);
    ASSERT_LE(found.distance.width(), tolerance);
    ASSERT_EQ(found.distance.lo, lower_bound(bounds, q, found.direction));
    for (int k = 0; k < 50; ++k) {
      const Proposal x = on_surface(bounds, random.direction());
      const double distance = length<Real>(PreciseVector(q - precise(x))).lower().to_double(Direction::down);
      ASSERT_GE(found.distance.hi, -distance * (1.0 + 1e-15));
      ASSERT_GE(found.distance.hi, lower_bound(bounds, q, random.direction()));
    }
  }
}

TEST(InteriorTest, ToleranceZeroReachesRoundingLevel) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const Superquadric solid = random.solid();
    const SuperquadricBounds<Real> bounds(solid);
    const PreciseVector q = precise(on_surface(bounds, random.direction(), random.uniform(0.05, 0.999)));
    ASSERT_LE(interior_distance(solid, bounds, q, 0.0).distance.width(), 5e-14 * largest(solid));
  }
}

/// Where whole circles of surface points are nearest, symmetry keeps the search short.
TEST(InteriorTest, SolidsOfRevolutionAreReducedToTheirProfile) {
  const std::vector<Superquadric> solids{{{1.0, 1.0, 3.0}, {1.0, 1.0}},
                                         {{3.0, 1.0, 1.0}, {1.0, 1.0}},
                                         {{1.0, 3.0, 1.0}, {1.0, 1.0}},
                                         {{2.0, 2.0, 1.0}, {1.5, 1.0}},
                                         {{1.0, 1.0, 5.0}, {2.0, 1.0}}};
  for (const Superquadric& solid : solids) {
    const SuperquadricBounds<Real> bounds(solid);
    for (const Proposal& q : {Proposal{0.0L, 0.0L, 0.0L}, Proposal{0.25L, 0.0L, 0.0L}, Proposal{0.0L, 0.25L, 0.0L},
                              Proposal{0.0L, 0.0L, 0.25L}, Proposal{-0.1L, 0.2L, 0.3L}}) {
      EXPECT_LE(interior_distance(solid, bounds, precise(q), 0.0).distance.width(), 5e-14);
    }
  }
}

}  // namespace
}  // namespace verisq::verify
