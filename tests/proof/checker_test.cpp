/// The checker proves what maps claim, from their certificates alone, and nothing that is false.
/// VERISQ_CHECKED_MODELS multiplies the number of random models whose maps are checked.
#include "verisq/checker.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/files.hpp"

namespace verisq {
namespace {

using oracle::moved;

/// Certified rows of one model at one tolerance.
struct CertifiedMap {
  Model model;
  std::vector<Point> points;
  std::vector<Enclosure> enclosures;
  std::vector<Certificate> certificates;
};

double size_of(const Model& model) {
  double size = 0.0;
  for (const Primitive& primitive : model.primitives)
    size = std::max(size, std::ranges::max(primitive.superquadric.semi_axes));
  return size;
}

/// A solid of the soundness test, or several of like size about the same place.
Model random_model(oracle::RandomCases& random, std::size_t primitives) {
  Model model{"", {random.solid()}};
  const double size = size_of(model);
  for (std::size_t i = 1; i < primitives; ++i) {
    Primitive next = random.solid();
    const double scale = size / std::ranges::max(next.superquadric.semi_axes);
    for (double& axis : next.superquadric.semi_axes) axis *= scale;
    for (std::size_t k = 0; k < 3; ++k)
      next.pose.translation[k] = model.primitives[0].pose.translation[k] + random.uniform(-size, size);
    model.primitives.push_back(next);
  }
  return model;
}

std::vector<Point> random_points(oracle::RandomCases& random, const Model& model, std::size_t count) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(random.point(model.primitives[random.choice(model.primitives.size())]).point);
  return points;
}

CertifiedMap certified_map(const Model& model, const std::vector<Point>& points, double tolerance,
                           const std::string& device, bool covers = false) {
  const oracle::FinishedMap map = oracle::map_in_memory(
      model, points, {.tolerance = tolerance, .device = device, .certificates = true, .covers = covers});
  CertifiedMap result{model, points, {}, map.certificates};
  for (const MapResult& row : map.rows) result.enclosures.push_back(row.distance);
  return result;
}

std::string describe(const CertifiedMap& map, std::size_t i, const Finding& finding) {
  const Superquadric& solid = map.model.primitives.front().superquadric;
  return fmt::format(
      "point ({}, {}, {}), claimed [{}, {}], proven [{}, {}], first of {} primitives: axes {} {} {}, e {} {}",
      map.points[i][0], map.points[i][1], map.points[i][2], map.enclosures[i].lo, map.enclosures[i].hi,
      finding.proven.lo, finding.proven.hi, map.model.primitives.size(), solid.semi_axes[0], solid.semi_axes[1],
      solid.semi_axes[2], solid.exponents[0], solid.exponents[1]);
}

struct MapCase {
  std::string name;
  std::string device;
  std::size_t primitives;
  double relative_tolerance;
  std::size_t models;
  bool covers = false;
};

std::size_t model_factor() {
  return oracle::requested_count("VERISQ_CHECKED_MODELS", 1);
}

class CheckerMapTest : public testing::TestWithParam<MapCase> {};

TEST_P(CheckerMapTest, ProvesEveryRowOfAMap) {
  const MapCase& parameters = GetParam();
  constexpr std::size_t points_a_model = 100;
  std::size_t not_proved = 0;
  for (std::size_t k = 0; k < parameters.models * model_factor(); ++k) {
    oracle::RandomCases random(1000 * parameters.primitives + k);
    const Model model = random_model(random, parameters.primitives);
    const CertifiedMap map =
        certified_map(model, random_points(random, model, points_a_model),
                      parameters.relative_tolerance * size_of(model), parameters.device, parameters.covers);
    ASSERT_EQ(map.certificates.size(), points_a_model);
    const Checker check(model);
    for (std::size_t i = 0; i < points_a_model; ++i) {
      const Finding finding = check(map.points[i], map.enclosures[i], map.certificates[i]);
      if (finding.verdict == Verdict::proved) continue;
      if (not_proved++ < 10) ADD_FAILURE() << describe(map, i, finding);
    }
  }
  EXPECT_EQ(not_proved, 0U);
}

INSTANTIATE_TEST_SUITE_P(
    Maps, CheckerMapTest,
    testing::Values(MapCase{"DeviceOneSolid", "auto", 1, 1e-6, 100},
                    MapCase{"DeviceOneSolidTightest", "auto", 1, 0.0, 20}, MapCase{"DeviceUnion", "auto", 4, 1e-6, 40},
                    MapCase{"DeviceUnionTightest", "auto", 4, 0.0, 10}, MapCase{"HostOneSolid", "host", 1, 1e-6, 40},
                    MapCase{"HostOneSolidTightest", "host", 1, 0.0, 20}, MapCase{"HostUnion", "host", 4, 1e-6, 20},
                    MapCase{"DeviceUnionWithCovers", "auto", 4, 1e-6, 4, true},
                    MapCase{"HostUnionWithCovers", "host", 4, 1e-6, 2, true}),
    [](const auto& test) { return test.param.name; });

TEST(CheckerTest, CertifiedHostEnclosuresAreAsTightAsTheOthers) {
  double worst = 0.0;
  for (std::size_t k = 0; k < 50; ++k) {
    oracle::RandomCases random(k);
    const Model model = random_model(random, 1);
    const SignedDistance distance(model);
    for (const Point& point : random_points(random, model, 20)) {
      const double magnitude = std::max({size_of(model), std::abs(point[0]), std::abs(point[1]), std::abs(point[2])});
      const double tolerance = 1e-6 * size_of(model);
      const double excess = distance.certified(point, tolerance).distance.width() - distance(point, tolerance).width();
      worst = std::max(worst, excess / magnitude);
    }
  }
  EXPECT_LT(worst, 1e-13);
}

/// Ends past the truth, by 1e-12 of their value, are never proved. The truth lies in the enclosure of the host at
/// tolerance 0, so that ends beyond its other side are past it.
TEST(CheckerTest, NeverProvesAnEndPastTheTruth) {
  std::size_t refuted = 0;
  std::size_t cases = 0;
  for (std::size_t k = 0; k < 20; ++k) {
    oracle::RandomCases random(77 + k);
    const Model model = random_model(random, 1 + k % 2);
    const CertifiedMap map = certified_map(model, random_points(random, model, 50), 1e-6 * size_of(model), "auto");
    const SignedDistance host(model);
    const Checker check(model);
    for (std::size_t i = 0; i < map.points.size(); ++i) {
      const Enclosure truth = host(map.points[i], 0.0);
      const Enclosure& honest = map.enclosures[i];
      for (const Enclosure& false_claim :
           {Enclosure{moved(truth.hi, infinity), std::max(honest.hi, moved(truth.hi, infinity))},
            Enclosure{std::min(honest.lo, moved(truth.lo, -infinity)), moved(truth.lo, -infinity)}}) {
        if (!std::isfinite(false_claim.lo) || !std::isfinite(false_claim.hi)) continue;
        const Finding finding = check(map.points[i], false_claim, map.certificates[i]);
        ASSERT_NE(finding.verdict, Verdict::proved) << describe(map, i, finding);
        ++cases;
        refuted += finding.verdict == Verdict::refuted ? 1 : 0;
      }
    }
  }
  fmt::print("{} false claims, none proved, {} refuted outright\n", cases, refuted);
  EXPECT_GT(refuted, cases / 4);
}

TEST(CheckerTest, RefutesAnEmptyEnclosure) {
  const Model sphere{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  const Finding finding = Checker(sphere)(Point{2.0, 0.0, 0.0}, {1.5, 0.5}, {{{0, {1.0, 0.0, 0.0}}}, {}});
  EXPECT_EQ(finding.verdict, Verdict::refuted);
}

TEST(CheckerTest, RefutesClaimsOnTheWrongSideOfTheSurface) {
  const Model sphere{"", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}}}};
  const Checker check(sphere);
  const Certificate certificate{{{0, {1.0, 0.0, 0.0}}}, {}};
  EXPECT_EQ(check(Point{2.0, 0.0, 0.0}, {1.0, 1.0}, certificate).verdict, Verdict::proved);
  EXPECT_EQ(check(Point{2.0, 0.0, 0.0}, {-1.0, -0.5}, certificate).verdict, Verdict::refuted);
  EXPECT_EQ(check(Point{0.5, 0.0, 0.0}, {0.4, 0.5}, certificate).verdict, Verdict::refuted);
}

/// Whatever stands in a certificate, a claim that excludes the truth is not proved.
TEST(CheckerTest, ProvesNothingFalseFromNonsense) {
  const Model model = parse_model(
      R"({"format": "verisq-model/1", "primitives": [
          {"name": "a", "superquadric": {"semi_axes": [1, 1, 1], "exponents": [1, 1]}},
          {"name": "b", "superquadric": {"semi_axes": [1, 2, 1], "exponents": [0.4, 1.7]},
           "pose": {"translation": [3, 0, 0], "quaternion": [1, 2, 3, 4]}}]})",
      "nonsense");
  const Checker check(model);
  oracle::RandomCases random(5);
  const std::array<double, 7> extremes{0.0, -0.0, 1e308, 5e-324, -1e-200, infinity, std::nan("")};
  const auto number = [&] { return random.choice(2) == 0 ? extremes[random.choice(7)] : random.uniform(-3.0, 3.0); };
  const auto vector = [&] { return Point{number(), number(), number()}; };
  const Point x{0.0, -3.0, 0.0};  // at a distance of 2 from the ball, farther from the other
  for (int i = 0; i < 3000; ++i) {
    Certificate certificate;
    for (std::size_t n = random.choice(4); n > 0; --n)
      certificate.normals.push_back({static_cast<std::uint32_t>(random.choice(3)), vector()});
    if (random.choice(2) == 0) certificate.escape = vector();
    EXPECT_NE(check(x, {2.0000001, 3.0}, certificate).verdict, Verdict::proved);
    EXPECT_NE(check(x, {-1.0, 1.9999999}, certificate).verdict, Verdict::proved);
    EXPECT_NE(check(Point{0.0, 0.0, 0.0}, {-3.0, -1.0000001}, certificate).verdict, Verdict::proved);
  }
}

/// A digit of a certificate's vector changed in the way of a typing error.
std::array<double, 3> with_wrong_digit(std::array<double, 3> v, std::size_t component, std::size_t digit) {
  std::string text = fmt::format("{:.16e}", v[component]);
  const std::size_t at = text.find_first_of("123456789") + (digit == 0 ? 0 : digit + 1);
  text[at] = static_cast<char>('0' + (text[at] - '0' + 5) % 10);
  std::from_chars(text.data(), text.data() + text.size(), v[component]);
  return v;
}

/// Outside, the normal's leading digits carry the proof: changing one of them loses it. (Trailing digits need not: any
/// normal proves something, and a bound is second order in its error.)
TEST(CheckerTest, ALeadingDigitOfANormalMatters) {
  const Model model{"", {{"egg", {{1.0, 2.0, 3.0}, {0.9, 1.1}}, {{0.1, 0.2, 0.3}, {1.0, 2.0, 3.0, 4.0}}}}};
  const CertifiedMap map = certified_map(model, {{3.0, 4.0, 5.0}, {-2.0, 1.0, 7.0}, {9.0, -9.0, 9.0}}, 0.0, "auto");
  const Checker check(model);
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    for (std::size_t component = 0; component < 3; ++component) {
      for (std::size_t digit = 0; digit < 5; ++digit) {
        Certificate falsified = map.certificates[i];
        falsified.normals[0].vector = with_wrong_digit(falsified.normals[0].vector, component, digit);
        EXPECT_EQ(check(map.points[i], map.enclosures[i], falsified).verdict, Verdict::unproved)
            << describe(map, i, check(map.points[i], map.enclosures[i], falsified)) << " digit " << digit
            << " of component " << component;
      }
    }
  }
}

/// Nearly a sphere: the proof that a ball nearly as large lies inside fails after all of its 50,000 corners. One row
/// that names the primitive many times must not cost that many of them.
TEST(CheckerTest, RepeatedNormalsCostOneProof) {
  const Checker checker(Model{"", {{"s", {{1.0, 1.0, 1.0}, {1.0, 1.0000001}}, {}}}});
  Certificate certificate;
  certificate.normals.assign(1000, {0, {0.0, 1.0, 0.0}});
  EXPECT_EQ(checker(Point{0.0, 0.0, 0.0}, {-infinity, -0.99999}, certificate).verdict, Verdict::unproved);
}

/// Many different normals of one row, the best ones last: none of those is tried once interrupted.
TEST(CheckerTest, EndsBetweenTheNormalsOfARow) {
  const Checker checker(Model{"", {{"ellipsoid", {{1.0, 2.0, 1.0}, {1.0, 1.0}}, {}}}});
  Certificate certificate;
  for (int i = 1000; i > 0; --i) certificate.normals.push_back({0, {1.0, 1e-3 * i, 0.0}});
  const auto proven = [&](const auto& query, int most) {
    int asked = 0;
    return checker(query, {1.0, 1.0}, certificate, [&] { return ++asked > most; }).proven;
  };
  const Point point{2.0, 0.0, 0.0};
  const Triangle triangle{point, {3.0, 0.0, 0.0}, {3.0, 1.0, 0.0}};
  EXPECT_GT(proven(point, 1'000'000).lo, 0.999);
  EXPECT_LT(proven(point, 3).lo, 0.9);
  EXPECT_GT(proven(triangle, 1'000'000).lo, 0.999);
  EXPECT_LT(proven(triangle, 3).lo, 0.9);
}

/// In the middle of such a proof, too: of an exact model, and of one whose radius is not.
TEST(CheckerTest, EndsWithinARowOnceInterrupted) {
  const UncertainModel exact(Model{"", {{"s", {{1.0, 1.0, 1.0}, {1.0, 1.0000001}}, {}}}});
  UncertainModel uncertain = exact;
  uncertain.primitives[0].semi_axes[0].hi = 1.0000001;
  const Certificate certificate{{{0, {0.0, 1.0, 0.0}}}, {}};
  for (const UncertainModel& model : {exact, uncertain}) {
    int asked = 0;
    const Finding finding =
        Checker(model)(Point{0.0, 0.0, 0.0}, {-infinity, -0.99999}, certificate, [&asked] { return ++asked > 100; });
    EXPECT_EQ(finding.verdict, Verdict::unproved);
    EXPECT_GT(asked, 100);
    EXPECT_LT(asked, 110);
    EXPECT_LE(finding.proven.lo, -1.0);
    EXPECT_GE(finding.proven.hi, -1.0);
  }
}

}  // namespace
}  // namespace verisq
