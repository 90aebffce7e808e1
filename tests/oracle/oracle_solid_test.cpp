/// The references of bent and combined models against closed forms, the forward bend, and each other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/solid_escape.hpp"
#include "tests/oracle/solid_reference.hpp"
#include "tests/oracle/sphere_models.hpp"
#include "tests/oracle/sphere_solid.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t cubes = 4000;

[[nodiscard]] Primitive sphere(const std::string& name, const Point& centre, double radius) {
  return {name, {{radius, radius, radius}, {1.0, 1.0}}, {centre, {1.0, 0.0, 0.0, 0.0}}, {}};
}

[[nodiscard]] SetExpression leaf(std::uint32_t primitive) {
  return {{}, SetOperation::unite, primitive};
}

/// The forward formula of verisq/model.hpp, to the letter.
[[nodiscard]] Vector bent(const Vector& local, const Bend& bend) {
  const Real angle = bend.angle_degrees * boost::math::constants::pi<Real>() / 180;
  const Real c = cos(angle);
  const Real s = sin(angle);
  const Real k = bend.curvature;
  const Real r = local[0] * c + local[1] * s;
  const Real across = local[1] * c - local[0] * s;
  const Real R = 1 / k - (1 / k - r) * cos(k * local[2]);
  const Real Z = (1 / k - r) * sin(k * local[2]);
  return {R * c - across * s, R * s + across * c, Z};
}

TEST(MembershipTest, DecidesPointsBentForwardNextToTheBoundary) {
  RandomSolids solids(1);
  RandomCases random(2);
  for (int i = 0; i < 100; ++i) {
    const Model model = solids.model(ModelFamily::bent);
    const Primitive& p = model.primitives.front();
    const ExactMembership exact(model);
    const PosedSolid solid(p.superquadric, p.pose);
    const Vector local = widened(random.boundary_point(p.superquadric).point);
    const auto scaled_to = [&](const Real& gauge) {
      return solid.from_own_frame(bent(scaled<Real>(local, gauge / solid.norm().gauge(local)), *p.bend));
    };
    EXPECT_EQ(exact(scaled_to(1 - ldexp(Real(1), -90))), Membership::inside) << model_json(model);
    EXPECT_EQ(exact(scaled_to(1 + ldexp(Real(1), -90))), Membership::outside) << model_json(model);
    EXPECT_EQ(exact(scaled_to(Real(1))), Membership::boundary) << model_json(model);
  }
}

TEST(MembershipTest, TinyCurvaturesDisplaceByTheirFirstOrder) {
  // To first order R = r + k z^2/2 and Z = z - k r z: the tip (0, 0, 1) comes to (k/2, 0, 1), (1, 0, 0) stays.
  for (const double k : {1e-5, -1e-9, 1e-300, -1e-300, 5e-324}) {
    const Model model{"", {{"bent", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}, Bend{k, 0.0}}}};
    const ExactMembership exact(model);
    EXPECT_EQ(exact({Real(0.5), Real(0), Real(0.5)}), Membership::inside);
    EXPECT_EQ(exact({Real(1.0625), Real(0), Real(0)}), Membership::outside);
    if (std::abs(k) < 1e-20) {
      // Closer to the unbent solid than the margin.
      EXPECT_EQ(exact({Real(0), Real(0), Real(1)}), Membership::boundary);
      EXPECT_EQ(exact({Real(1), Real(0), Real(0)}), Membership::boundary);
      continue;
    }
    const Real beside = sqrt(Real(0.5));
    // (r, z) = (beside, beside) comes to (beside + k/4, beside - k/2): the gauge of (beside, beside) falls by k/4 ...
    EXPECT_EQ(exact({beside, Real(0), beside}), k > 0 ? Membership::outside : Membership::inside);
    EXPECT_EQ(exact({-beside, Real(0), beside}), k > 0 ? Membership::inside : Membership::outside);
  }
}

Point in_box(RandomCases& random, const Superquadric& superquadric) {
  Point x;
  for (std::size_t i = 0; i < 3; ++i) x[i] = random.uniform(-1.0, 1.0) * superquadric.semi_axes[i];
  return x;
}

TEST(PlacedPrimitiveTest, OwnUndoesPlacedAndAgreesWithMpfr) {
  RandomSolids solids(3);
  RandomCases random(6);
  int decided = 0;
  for (const ModelFamily family : model_families) {
    for (int i = 0; i < 20; ++i) {
      const Model model = solids.model(family);
      const PlacedModel placed(model);
      const ExactMembership exact(model);
      for (const PlacedPrimitive& p : placed.primitives()) {
        // Beyond the pole of its inverse a taper is not undone.
        const Superquadric& s = p.primitive().superquadric;
        const Point q = is_tapered(s) ? p.placed(in_box(random, s)) : solids.point(placed, SolidPointFamily::around);
        const Point local = p.own(q);
        const Point again = p.placed(local);
        // Behind the centre of curvature the unbent point is not in the solid, yet comes back.
        EXPECT_LT(length(difference(again, q)), 1e-10 * placed.bounding_ball().radius) << model_json(model);
      }
      for (const SolidPointFamily points : solid_point_families) {
        const Point q = solids.point(placed, points);
        const Membership side = placed(q);
        if (side == Membership::boundary) continue;
        ++decided;
        EXPECT_EQ(exact(widened(q)), side) << model_json(model) << q[0] << ' ' << q[1] << ' ' << q[2];
      }
    }
  }
  EXPECT_GT(decided, 500);
}

TEST(PlacedModelTest, MembershipOfABallIsThatOfItsPoints) {
  RandomSolids solids(4);
  RandomCases random(5);
  int decided = 0;
  for (const ModelFamily family : model_families) {
    for (int i = 0; i < 40; ++i) {
      const PlacedModel placed(solids.model(family));
      const double size = placed.bounding_ball().radius;
      for (const SolidPointFamily points : solid_point_families) {
        const Ball ball{solids.point(placed, points), size * random.log_uniform(1e-3, 1.0)};
        const Membership side = placed(ball);
        if (side == Membership::boundary) continue;
        ++decided;
        for (int k = 0; k < 20; ++k) {
          const Point d = random.direction();
          Point x = ball.centre;
          for (std::size_t j = 0; j < 3; ++j) x[j] += ball.radius * d[j];
          EXPECT_EQ(placed(x), side);
        }
      }
    }
  }
  EXPECT_GT(decided, 300);
}

TEST(SphereSolidTest, LensShellAndBoredSphere) {
  const auto expect = [](const Model& model, const Point& q, const Real& distance) {
    const auto reference = SphereSolid(model).signed_distance(q);
    ASSERT_TRUE(reference);
    EXPECT_LE(abs(reference->lower - distance), ldexp(Real(1), -100)) << text(reference->lower);
    EXPECT_LE(abs(reference->upper - distance), ldexp(Real(1), -100)) << text(reference->upper);
  };
  // Two spheres of radius 5 whose circle, of radius 4, lies in the plane x = 0.
  Model model{"", {sphere("a", {-3, 0, 0}, 5), sphere("b", {3, 0, 0}, 5)}};
  expect(model, {0, 10, 0}, sqrt(Real(109)) - 5);
  expect(model, {1, 0.5, 0}, -sqrt(Real(13.25)));
  model.csg = SetExpression{{leaf(0), leaf(1)}, SetOperation::intersect, 0};
  expect(model, {0, 10, 0}, Real(6));
  expect(model, {1, 0.5, 0}, sqrt(Real(16.25)) - 5);
  expect(model, {3, 0, 0.5}, sqrt(Real(36.25)) - 5);
  model.csg->operation = SetOperation::subtract;
  expect(model, {0, 10, 0}, sqrt(Real(109)) - 5);  // the sphere a itself
  expect(model, {3, 7, 0}, sqrt(Real(18)));        // the rim
  expect(model, {-3, 0.5, 0}, -(sqrt(Real(36.25)) - 5));
  expect(model, {1, 0.5, 0}, 5 - sqrt(Real(4.25)));
}

TEST(SolidReferenceTest, EnclosesTheClosedFormOfSpheresTightly) {
  RandomCases random(6);
  int compared = 0;
  int near = 0;
  int close_below = 0;
  for (int i = 0; i < 12; ++i) {
    const Model model = random_spheres(random);
    const SphereSolid spheres(model);
    const SolidReference reference(model);
    RandomSolids solids(static_cast<std::uint64_t>(i));
    for (int k = 0; k < 35; ++k) {
      const Point q = solids.point(reference.placed(), solid_point_families[static_cast<std::size_t>(k) % 7]);
      const auto exact = spheres.signed_distance(q);
      if (!exact || !isfinite(exact->upper)) continue;
      const SolidFacts facts = reference.facts(q, cubes);
      ++compared;
      EXPECT_LE(facts.lower, exact->upper) << model_json(model) << q[0] << ',' << q[1] << ',' << q[2];
      EXPECT_GE(facts.upper, exact->lower) << model_json(model) << q[0] << ',' << q[1] << ',' << q[2];
      const Real distance = abs(exact->upper);
      const Real found = facts.side == Membership::inside ? Real(-facts.lower) : facts.upper;
      const Real clear = facts.side == Membership::inside ? Real(-facts.upper) : facts.lower;
      near += found <= distance * (1 + Real(1e-4)) + 1e-9 * reference.size() ? 1 : 0;
      close_below += clear >= Real(0.9) * distance - 1e-9 * reference.size() ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_GT(near, compared * 95 / 100);
  EXPECT_GT(close_below, compared * 9 / 10);
  RecordProperty("compared", compared);
}

TEST(SolidReferenceTest, AgreesWithTheReferenceOfConvexSolids) {
  int near = 0;
  int compared = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    RandomSolids solids(100 + i);
    Model model = solids.model(ModelFamily::bent);
    model.primitives.front().bend.reset();
    const Primitive& p = model.primitives.front();
    const PosedSolid solid(p.superquadric, p.pose);
    const SolidReference reference(model);
    for (int k = 0; k < 28; ++k) {
      const Point q = solids.point(reference.placed(), solid_point_families[static_cast<std::size_t>(k) % 7]);
      const ReferenceDistance exact = solid.signed_distance(q);
      const SolidFacts facts = reference.facts(q, cubes);
      EXPECT_LE(facts.lower, exact.upper) << model_json(model) << q[0] << ',' << q[1] << ',' << q[2];
      EXPECT_GE(facts.upper, exact.lower) << model_json(model) << q[0] << ',' << q[1] << ',' << q[2];
      ++compared;
      const Real distance = abs(exact.upper);
      const Real found = facts.side == Membership::inside ? Real(-facts.lower) : facts.upper;
      near += found <= distance * (1 + Real(1e-3)) + 1e-9 * reference.size() ? 1 : 0;
    }
  }
  EXPECT_GT(near, compared * 95 / 100);
}

TEST(SolidEscapeTest, ReportsEveryKind) {
  const Model model{"", {sphere("a", {0, 0, 0}, 1)}};
  const auto escapes = [&](const Enclosure& enclosure, double lower, double upper) {
    return escape(enclosure, model, {3, 0, 0}, Real(lower), Real(upper)).has_value();
  };
  EXPECT_FALSE(escapes({1.0, 3.0}, 2.0, 2.0));
  EXPECT_FALSE(escapes({2.0, 2.0}, 2.0, 2.0));
  EXPECT_TRUE(escapes({std::nextafter(2.0, 3.0), 3.0}, 1.0, 2.0));
  EXPECT_TRUE(escapes({1.0, std::nextafter(2.0, 1.0)}, 2.0, 3.0));
  EXPECT_TRUE(escapes({3.0, 1.0}, 2.0, 2.0));
  EXPECT_TRUE(escapes({std::nan(""), 3.0}, 2.0, 2.0));
}

}  // namespace
}  // namespace verisq::oracle
