/// The branch and bound against closed forms: two spheres combined, boxes, bends.
#include "verify/search/solid_distance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>

#include "tests/fixtures/random.hpp"

namespace verisq::verify {
namespace {

using testing::Random;

constexpr Enclosure nothing_known{-infinity, infinity};

bool never() {
  return false;
}

Enclosure distance(const Model& model, const Point& x, double tolerance, const Enclosure& known = nothing_known) {
  return SolidDistance(model)(x, tolerance, known, never);
}

Primitive sphere(const Point& centre, double radius) {
  return {"", {{radius, radius, radius}, {1.0, 1.0}}, {centre, {1.0, 0.0, 0.0, 0.0}}};
}

SetExpression leaf(std::uint32_t primitive) {
  return {.operands = {}, .operation = SetOperation::unite, .primitive = primitive};
}

/// All primitives in their order, under one operation.
Model combined(std::vector<Primitive> primitives, SetOperation operation) {
  SetExpression all{.operands = {}, .operation = operation};
  for (std::uint32_t i = 0; i < primitives.size(); ++i) all.operands.push_back(leaf(i));
  return {"", std::move(primitives), all};
}

/// Two balls on the x axis whose surfaces meet in a circle.
struct TwoBalls {
  double centre1, radius1, centre2, radius2;

  [[nodiscard]] Model model(SetOperation operation) const {
    return combined({sphere({centre1, 0.0, 0.0}, radius1), sphere({centre2, 0.0, 0.0}, radius2)}, operation);
  }
  [[nodiscard]] long double apart1(long double x, long double rho) const { return std::hypot(x - centre1, rho); }
  [[nodiscard]] long double apart2(long double x, long double rho) const { return std::hypot(x - centre2, rho); }

  /// The boundary consists of parts of both spheres and the circle in which they meet.
  [[nodiscard]] long double signed_distance(SetOperation operation, const Point& p) const {
    const long double x = p[0];
    const long double rho = std::hypot(static_cast<long double>(p[1]), static_cast<long double>(p[2]));
    const long double apart = centre2 - centre1;
    const long double along = (apart * apart + radius1 * radius1 - radius2 * radius2) / (2 * apart);
    const long double rim = std::sqrt(radius1 * radius1 - along * along);
    long double least = std::hypot(x - centre1 - along, rho - rim);
    const long double s1 = radius1 / apart1(x, rho);
    const long double s2 = radius2 / apart2(x, rho);
    const bool foot1_in_2 = apart2(centre1 + s1 * (x - centre1), s1 * rho) < radius2;
    const bool foot2_in_1 = apart1(centre2 + s2 * (x - centre2), s2 * rho) < radius1;
    if (foot1_in_2 == (operation == SetOperation::intersect))
      least = std::min(least, std::fabs(apart1(x, rho) - radius1));
    if (foot2_in_1 == (operation != SetOperation::unite)) least = std::min(least, std::fabs(apart2(x, rho) - radius2));
    const bool in1 = apart1(x, rho) < radius1;
    const bool in2 = apart2(x, rho) < radius2;
    const bool inside = operation == SetOperation::unite       ? in1 || in2
                        : operation == SetOperation::intersect ? in1 && in2
                                                               : in1 && !in2;
    return inside ? -least : least;
  }
};

void expect_encloses(const Enclosure& found, long double exact, double width, const Point& x) {
  const long double rounding = 1e-17L;
  EXPECT_LE(found.lo, exact + rounding) << x[0] << ' ' << x[1] << ' ' << x[2];
  EXPECT_GE(found.hi, exact - rounding) << x[0] << ' ' << x[1] << ' ' << x[2];
  EXPECT_LE(found.width(), width) << x[0] << ' ' << x[1] << ' ' << x[2] << " exact " << static_cast<double>(exact)
                                  << " found " << found.lo << ' ' << found.hi;
}

class TwoBallsTest : public ::testing::TestWithParam<SetOperation> {};

TEST_P(TwoBallsTest, ReachTheTolerance) {
  const TwoBalls balls{-0.5, 1.0, 0.625, 0.75};
  const SolidDistance search(balls.model(GetParam()));
  Random random(1);
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    for (int i = 0; i < 60; ++i) {
      const Point x = random.point(i % 2 == 0 ? 2.0 : 0.8);
      expect_encloses(search(x, tolerance, nothing_known, never), balls.signed_distance(GetParam(), x), tolerance, x);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SolidDistance, TwoBallsTest,
                         ::testing::Values(SetOperation::unite, SetOperation::intersect, SetOperation::subtract));

TEST(SolidDistanceTest, OnTheSurfaceZeroIsEnclosed) {
  for (const SetOperation operation : {SetOperation::unite, SetOperation::intersect, SetOperation::subtract}) {
    const TwoBalls balls{-0.5, 1.0, 0.5, 1.0};
    const double rim = std::sqrt(0.75);
    for (const Point& x : {Point{0.0, rim, 0.0}, Point{0.0, 0.0, -rim}, Point{0.0, 0.6 * rim, 0.8 * rim}}) {
      const Enclosure found = distance(balls.model(operation), x, 1e-6);
      EXPECT_LE(found.width(), 1e-6);
      EXPECT_LE(found.lo, 2e-16);  // how far the rounding of x may take it from the rim
      EXPECT_GE(found.hi, -2e-16);
    }
  }
  expect_encloses(distance(combined({sphere({}, 1.0)}, SetOperation::unite), {1.0, 0.0, 0.0}, 1e-9), 0.0L, 1e-9, {});
}

TEST(SolidDistanceTest, OfAnEmptySolidOnlyTheUpperEndIsInfinite) {
  const Model empty = combined({sphere({-2.0, 0.0, 0.0}, 1.0), sphere({2.0, 0.0, 0.0}, 1.0)}, SetOperation::intersect);
  for (const Point& x : {Point{0.0, 0.0, 0.0}, Point{-2.0, 0.0, 0.0}, Point{9.0, 9.0, 9.0}}) {
    const Enclosure found = distance(empty, x, 1e-6);
    EXPECT_GT(found.lo, 1e3);
    EXPECT_TRUE(std::isfinite(found.lo));
    EXPECT_EQ(found.hi, infinity);
  }
  // Balls that touch: the solid is the point between them, which no strict proof finds.
  const Model touching =
      combined({sphere({-1.0, 0.0, 0.0}, 1.0), sphere({1.0, 0.0, 0.0}, 1.0)}, SetOperation::intersect);
  const Enclosure found = distance(touching, {0.0, 3.0, 0.0}, 1e-6);
  EXPECT_LE(found.lo, 3.0);
  EXPECT_GE(found.lo, 2.9);
  EXPECT_EQ(found.hi, infinity);
}

TEST(SolidDistanceTest, ClosedBetweenSolidsThatShareAFace) {
  // The point between is inside; that the two together surround it, no cube shows. Wide, and right.
  const Primitive left{"", {{1.0, 1.0, 1.0}, {1e-3, 1e-3}}, {{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}};
  const Primitive right{"", {{1.0, 1.0, 1.0}, {1e-3, 1e-3}}, {{1.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}};
  const Enclosure found = distance(combined({left, right}, SetOperation::unite), {0.0, 0.1, 0.2}, 1e-3);
  EXPECT_LE(found.lo, -0.79);
  EXPECT_GE(found.hi, -0.8);
}

// A - (A - B) is A's boundary and the lens of both, for a difference removes interiors.
TEST(SolidDistanceTest, TheBoundaryThatIsLeftOfADifferenceOfDifferencesIsFound) {
  const SetExpression a{.primitive = 0};
  const SetExpression b{.primitive = 1};
  const SetExpression cut{{a, {{a, b}, SetOperation::subtract}}, SetOperation::subtract};
  Random random(6);
  constexpr double tolerance = 1e-5;
  for (int i = 0; i < 60; ++i) {
    const Point centre = random.point(1.0);
    const double radius = random.uniform(0.3, 1.2);
    const SolidDistance search({"", {sphere({}, 1.0), sphere(centre, radius)}, cut});
    const Point x = random.point(i % 3 == 0 ? 0.9 : 3.0);
    const double to_a = std::hypot(x[0], x[1], x[2]) - 1.0;
    const double to_b = std::hypot(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]) - radius;
    if (std::abs(to_a) < 0.01 || std::abs(to_b) < 0.01) continue;
    const Enclosure found = search(x, tolerance, nothing_known, never);
    EXPECT_LE(found.width(), tolerance) << x[0] << ' ' << x[1] << ' ' << x[2];
    double least = to_a;
    double most = to_a;
    if (to_a < 0.0 && to_b < 0.0) least = most = std::max(to_a, to_b);  // in the lens
    if (to_a < 0.0 && to_b > 0.0) {  // between the boundary and the lens, whose nearest point may lie on its edge
      least = std::min(-to_a, to_b);
      most = -to_a;
    }
    EXPECT_LE(found.lo, most + 1e-14);
    EXPECT_GE(found.hi, least - 1e-14);
  }
}

TEST(SolidDistanceTest, OfAnySizeAndPlace) {
  const TwoBalls balls{-0.5, 1.0, 0.625, 0.75};
  Random random(2);
  for (const double size : {0x1p-300, 0x1p-40, 0x1p40, 0x1p300}) {
    const TwoBalls scaled{size * balls.centre1, size * balls.radius1, size * balls.centre2, size * balls.radius2};
    for (const SetOperation operation : {SetOperation::unite, SetOperation::intersect, SetOperation::subtract}) {
      const SolidDistance search(scaled.model(operation));
      for (int i = 0; i < 5; ++i) {
        const Point p = random.point(1.0);
        const Point x{size * p[0], size * p[1], size * p[2]};
        const Enclosure found = search(x, 1e-6 * size, nothing_known, never);
        expect_encloses({found.lo / size, found.hi / size}, balls.signed_distance(operation, p), 1e-6, p);
      }
    }
  }
}

TEST(SolidDistanceTest, FarFromEverything) {
  const TwoBalls balls{-0.5, 1.0, 0.625, 0.75};
  for (const SetOperation operation : {SetOperation::unite, SetOperation::intersect, SetOperation::subtract}) {
    const Point x{1e6, -2e6, 3e6};
    expect_encloses(distance(balls.model(operation), x, 1e-6), balls.signed_distance(operation, x), 1e-6, x);
  }
}

TEST(SolidDistanceTest, NumbersAtTheEndOfTheRangeDoNotThrow) {
  const double huge = 1e308;
  const Model model = combined({{"", {{huge, huge, huge}, {1.0, 1.0}}, {{huge, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}},
                                {"", {{1.0, 1e-308, 1.0}, {0.5, 0.5}}, {}, Bend{0.5, 10.0}}},
                               SetOperation::subtract);
  const SolidDistance search(model);
  for (const Point& x : {Point{}, Point{huge, huge, huge}, Point{-huge, 1.0, 0.0}, Point{1e-308, 1e-320, 0.0}}) {
    const Enclosure found = search(x, 1.0, nothing_known, never);
    EXPECT_LE(found.lo, found.hi);
  }
}

TEST(SolidDistanceTest, KeepsWhatIsKnown) {
  const TwoBalls balls{-0.5, 1.0, 0.625, 0.75};
  const Point x{0.1, 0.2, 0.3};
  const long double exact = balls.signed_distance(SetOperation::unite, x);
  const Enclosure known{static_cast<double>(exact) - 1e-4, static_cast<double>(exact) + 1e-4};
  const Enclosure found = distance(balls.model(SetOperation::unite), x, 1e-3, known);
  EXPECT_GE(found.lo, known.lo);
  EXPECT_LE(found.hi, known.hi);
  expect_encloses(found, exact, 2e-4, x);
}

/// Outside, inside and where the sign is open; what is taken for known lies below or above the truth.
TEST(SolidDistanceTest, NoticesThatWhatIsKnownIsWrong) {
  const Model ball{"", {sphere({0.0, 0.0, 0.0}, 1.0)}};
  struct Wrong {
    Point x;
    Enclosure known;
  };
  for (const Wrong& wrong : {Wrong{{4.0, 0.0, 0.0}, {1.0, 2.0}}, Wrong{{4.0, 0.0, 0.0}, {4.0, 5.0}},
                             Wrong{{4.0, 0.0, 0.0}, {-2.0, -1.0}}, Wrong{{0.0, 0.125, 0.0}, {-6.0, -5.0}},
                             Wrong{{0.0, 0.125, 0.0}, {-0.5, -0.25}}, Wrong{{0.0, 0.125, 0.0}, {1.0, 2.0}},
                             Wrong{{1.0, 0.0, 0.0}, {2.0, 3.0}}, Wrong{{1.0, 0.0, 0.0}, {-3.0, -2.0}}}) {
    const auto search = [&] { (void)distance(ball, wrong.x, 1e-6, wrong.known); };
    EXPECT_THAT(search, ::testing::ThrowsMessage<Error>(::testing::AllOf(::testing::HasSubstr("contradict"),
                                                                         ::testing::HasSubstr("please report"))))
        << wrong.x[0] << ": [" << wrong.known.lo << ", " << wrong.known.hi << "]";
  }
  for (const Enclosure& right : {Enclosure{3.0, 3.0}, Enclosure{2.0, 3.0}, Enclosure{3.0, 4.0}}) {
    EXPECT_NO_THROW((void)distance(ball, {4.0, 0.0, 0.0}, 1e-6, right));
  }
}

TEST(SolidDistanceTest, InterruptedItIsValidAndWide) {
  const TwoBalls balls{-0.5, 1.0, 0.625, 0.75};
  const Model model = balls.model(SetOperation::subtract);
  const SolidDistance search(model);
  Random random(3);
  for (int polls = 0; polls < 20; ++polls) {
    const Point x = random.point(1.0);
    int polled = 0;
    const Enclosure found = search(x, 1e-9, nothing_known, [&] { return ++polled > polls; });
    expect_encloses(found, balls.signed_distance(SetOperation::subtract, x), infinity, x);
  }
}

TEST(SolidDistanceTest, BoxesInAndOutOfBoxes) {
  // Nearly boxes: a corner of the gauge's unit ball is within 3^(e/2) - 1 of the box's.
  const double e = 1e-6;
  const Primitive outer{"", {{2.0, 2.0, 2.0}, {e, e}}, {}};
  const Primitive inner{"", {{1.0, 1.0, 3.0}, {e, e}}, {}};
  const SolidDistance frame(combined({outer, inner}, SetOperation::subtract));
  const auto expect = [&](const Point& x, long double exact) {
    const Enclosure found = frame(x, 1e-6, nothing_known, never);
    EXPECT_NEAR(found.lo, static_cast<double>(exact), 5e-6) << x[0] << ' ' << x[1] << ' ' << x[2];
    EXPECT_NEAR(found.hi, static_cast<double>(exact), 5e-6) << x[0] << ' ' << x[1] << ' ' << x[2];
    EXPECT_LE(found.width(), 1e-6);
  };
  expect({0.25, 0.5, 0.0}, 0.5L);             // in the hole
  expect({0.5, 0.0, 3.0}, std::sqrt(1.25L));  // above the hole: the rim
  expect({1.3, 0.0, 0.0}, -0.3L);             // in the wall
  expect({1.8, 0.0, 0.0}, -0.2L);
  expect({1.3, 1.4, 0.0}, -0.5L);  // in a corner of the frame: the inner edge or an outer face
  expect({3.0, 3.0, 3.0}, std::sqrt(3.0L));
}

/// A bent primitive and the same without its bend.
Model one(const Superquadric& superquadric, const Pose& pose, std::optional<Bend> bend) {
  return {"", {{"", superquadric, pose, bend}}};
}

TEST(SolidDistanceTest, BendsThatVanish) {
  const Superquadric superquadric{{0.4, 0.5, 1.0}, {0.6, 1.2}};
  const Pose pose{{0.1, 0.2, 0.3}, {0.9, 0.1, -0.2, 0.3}};
  const SignedDistance unbent(one(superquadric, pose, std::nullopt));
  Random random(4);
  for (const double k : {0.0, 1e-300, -1e-300, 1e-9, 1e-5}) {
    const SolidDistance bent(one(superquadric, pose, Bend{k, 25.0}));
    for (int i = 0; i < 6; ++i) {
      const Point x = random.point(1.2);
      const Enclosure plain = unbent(x, 1e-12);
      const Enclosure found = bent(x, 1e-7, nothing_known, never);
      EXPECT_LE(found.width(), 1e-7);
      // No point of the solid moves farther than |k| (1 + 0.5)^2.
      EXPECT_LE(found.lo, plain.hi + 2.25 * std::fabs(k));
      EXPECT_GE(found.hi, plain.lo - 2.25 * std::fabs(k));
    }
  }
}

TEST(SolidDistanceTest, AroundTheMiddleOfABentCylinder) {
  // The circle about the middle of the axis keeps its place in the plane Z = 0; e1 makes it the widest there.
  const double radius = 0.25;
  for (const double k : {0.4, -0.9, 1.5}) {
    const SolidDistance cylinder(one({{radius, radius, 1.5}, {0.1, 1.0}}, {}, Bend{k, 0.0}));
    // Beyond the outer side of the arc and inside, the middle is nearest; towards the centre, the ends would be.
    const double outward = k > 0.0 ? -1.0 : 1.0;
    for (const double apart : {0.1, 0.24, 0.3, 1.0, 3.0}) {
      for (const double degrees : {0.0, 40.0, 80.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        const Point x{outward * apart * std::cos(angle), apart * std::sin(angle), 0.0};
        const long double exact = std::hypot(static_cast<long double>(x[0]), static_cast<long double>(x[1])) - radius;
        expect_encloses(cylinder(x, 1e-6, nothing_known, never), exact, 1e-6, x);
      }
    }
  }
}

TEST(SolidDistanceTest, BeyondTheTipOfABentSpindle) {
  const double k = 0.5;
  const double height = 1.0;
  const SolidDistance spindle(one({{0.3, 0.3, height}, {1.99, 1.0}}, {}, Bend{k, 0.0}));
  const Point tip{(1.0 - std::cos(k * height)) / k, 0.0, std::sin(k * height) / k};
  for (const double beyond : {0.1, 1.0, 10.0}) {
    const Point x{tip[0] + beyond * std::sin(k * height), 0.0, tip[2] + beyond * std::cos(k * height)};
    const Enclosure found = spindle(x, 1e-4, nothing_known, never);
    EXPECT_LE(found.width(), 1e-4);
    EXPECT_LE(found.lo, beyond + 1e-14);
    EXPECT_GE(found.hi, beyond - 1e-14);
  }
}

TEST(SolidDistanceTest, EscapesLieOutside) {
  const TwoBalls balls{-0.5, 1.0, 0.625, 0.75};
  const SolidDistance search(balls.model(SetOperation::unite));
  Random random(5);
  for (int i = 0; i < 30; ++i) {
    const Point x = random.point(0.5);
    const long double depth = -balls.signed_distance(SetOperation::unite, x);
    if (!(depth > 0.0)) continue;
    const auto escape = search.escape(x, 1e-6, never);
    ASSERT_TRUE(escape);
    EXPECT_GT(balls.signed_distance(SetOperation::unite, *escape), 0.0L);
    EXPECT_LE(std::hypot((*escape)[0] - x[0], (*escape)[1] - x[1], (*escape)[2] - x[2]), depth + 1e-6);
  }
}

// --- The public entry ---

TEST(SolidDistanceTest, OverlapsNoLongerWidenUnions) {
  std::vector<Primitive> primitives;
  Random random(6);
  for (int i = 0; i < 4; ++i) {
    const auto size = [&] { return random.uniform(0.4, 0.8); };
    primitives.push_back({"",
                          {{size(), size(), size()}, {random.uniform(0.3, 1.7), random.uniform(0.3, 1.7)}},
                          {random.point(0.3), {random.uniform(-1, 1), random.uniform(-1, 1), 0.5, 0.3}}});
  }
  const Model model{"", primitives};
  const SignedDistance search(model);
  std::size_t inside = 0;
  for (int i = 0; i < 60; ++i) {
    const Point x = random.point(0.8);
    const Enclosure found = search(x, 1e-6);
    EXPECT_LE(found.width(), 1e-6);
    inside += found.hi < 0.0 ? 1 : 0;
    const CertifiedEnclosure certified = search.certified(
        x, 1e-6, [] { return false; }, false);
    const CertifiedEnclosure covered = search.certified(x, 1e-6);
    for (const Enclosure& e : {certified.distance, covered.distance}) {
      EXPECT_LE(e.lo, found.hi);
      EXPECT_GE(e.hi, found.lo);
    }
    EXPECT_LE(covered.distance.width(), certified.distance.width());
    if (!(found.hi < 0.0)) continue;
    // The lower end is as good; without covers one primitive alone proves the upper one.
    EXPECT_GE(certified.distance.lo, found.lo - 2e-6);
    double single = infinity;
    for (const Primitive& primitive : primitives) {
      single = std::min(single, SignedDistance(Model{"", {primitive}})(x, 1e-9).hi);
    }
    EXPECT_GE(certified.distance.hi, single - 1e-6);
  }
  EXPECT_GT(inside, 15U);
}

TEST(SolidDistanceTest, CertificatesOfSetOperationsAreCovers) {
  const TwoBalls balls{-0.5, 1.0, 0.625, 0.75};
  const SignedDistance difference(balls.model(SetOperation::subtract));
  const Point x{0.1, 0.9, 0.3};
  expect_encloses(difference(x, 1e-8), balls.signed_distance(SetOperation::subtract, x), 1e-8, x);
  expect_encloses(difference.certified(x, 1e-8).distance, balls.signed_distance(SetOperation::subtract, x), 1e-8, x);
  EXPECT_THROW(static_cast<void>(difference.certified(
                   x, 1e-8, [] { return false; }, false)),
               Error);
}

TEST(SolidDistanceTest, TheTightestIsAskedForWithZero) {
  const TwoBalls balls{-0.5, 1.0, 0.625, 0.75};
  Random random(7);
  const SignedDistance lens(balls.model(SetOperation::intersect));
  for (int i = 0; i < 10; ++i) {
    const Point x = random.point(1.0);
    expect_encloses(lens(x, 0.0), balls.signed_distance(SetOperation::intersect, x), 1e-9, x);
  }
}

}  // namespace
}  // namespace verisq::verify
