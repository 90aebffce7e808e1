/// Support functions of sections of bent solids: no point reaches farther, and thin sections reach almost as far.
#include "verify/sets/sectioned_primitive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/oracle/random_cases.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

Superquadric random_solid(RandomCases& cases) {
  Superquadric solid{{cases.uniform(0.3, 1.5), cases.uniform(0.3, 1.5), cases.uniform(0.5, 3.0)},
                     {cases.uniform(0.1, 2.0), cases.uniform(0.1, 2.0)}};
  if (cases.choice(3) == 0) solid.taper = cases.log_uniform(0.2, 5.0);
  return solid;
}

/// Admissible, whatever the taper, which makes sections up to twice as large.
Bend random_bend(RandomCases& cases, const Superquadric& solid) {
  const auto& [a1, a2, a3] = solid.semi_axes;
  const double most = std::min(0.45 / std::hypot(a1, a2), 3.0 / a3);
  return {cases.uniform(-most, most), cases.uniform(-180.0, 180.0)};
}

/// By the formulas of model.hpp, but for rounding: the boundary point of Eq. (1), tapered and bent, and its height.
struct Sample {
  Point bent;
  double height;
};

Sample sample(const Superquadric& solid, const Bend& bend, double polar, double azimuth) {
  const auto power = [](double x, double e) { return std::copysign(std::pow(std::fabs(x), e), x); };
  const auto [e1, e2] = solid.exponents;
  const double ring = power(std::cos(polar), e1);
  const double k = (solid.taper - 1.0) / (solid.taper + 1.0);
  const double z = power(std::sin(polar), e1);
  const double height = (z - k) / (1.0 - k * z);
  const double scale = 1.0 + k * height;
  const double x = scale * solid.semi_axes[0] * ring * power(std::cos(azimuth), e2);
  const double y = scale * solid.semi_axes[1] * ring * power(std::sin(azimuth), e2);
  const double along = solid.semi_axes[2] * height;
  const double angle = bend.angle_degrees * std::numbers::pi / 180.0;
  const double r = x * std::cos(angle) + y * std::sin(angle);
  const double s = y * std::cos(angle) - x * std::sin(angle);
  const double c = bend.curvature;
  const double bent_r = 1.0 / c - (1.0 / c - r) * std::cos(c * along);
  const double bent_z = (1.0 / c - r) * std::sin(c * along);
  return {{bent_r * std::cos(angle) - s * std::sin(angle), bent_r * std::sin(angle) + s * std::cos(angle), bent_z},
          along};
}

double dot_of(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double reach(const SectionedPrimitive& primitive, const Point& n, const SectionedPrimitive::Section& section) {
  return primitive.support_up({Interval(n[0]), Interval(n[1]), Interval(n[2])}, section);
}

TEST(SectionedPrimitiveTest, NoPointOfASectionReachesFarther) {
  RandomCases cases(61);
  for (int trial = 0; trial < 60; ++trial) {
    const Superquadric solid = random_solid(cases);
    const Bend bend = random_bend(cases, solid);
    const SectionedPrimitive primitive({"", solid, {}, bend});
    std::vector<SectionedPrimitive::Section> sections{primitive.whole()};
    for (std::size_t i = 0; i < 7; ++i) {
      const auto halves = primitive.halves(sections[i]);
      ASSERT_TRUE(halves);
      sections.insert(sections.end(), halves->begin(), halves->end());
    }
    std::vector<Sample> samples;
    samples.reserve(2000);
    for (int i = 0; i < 2000; ++i) {
      samples.push_back(sample(solid, bend, cases.uniform(-1.0, 1.0) * std::numbers::pi / 2,
                               cases.uniform(-1.0, 1.0) * std::numbers::pi));
    }
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
    const Superquadric solid = random_solid(cases);
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
