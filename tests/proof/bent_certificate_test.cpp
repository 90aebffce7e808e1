/// Certificates of bent primitives: what they prove holds, is tight where it can be, and no forgery is proved.
/// VERISQ_FORGED_BENDS says about how many models are tried.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/solid_reference.hpp"
#include "verisq/checker.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"

namespace verisq {
namespace {

using oracle::moved;

using oracle::Membership;

struct BentCase {
  Model model;
  std::vector<Point> points;
};

/// One bent superquadric, or a union with a ball beside it.
BentCase bent_case(std::size_t k, std::size_t count) {
  oracle::RandomSolids random(900 + k);
  BentCase result{random.model(k % 3 == 2 ? oracle::ModelFamily::tiny_curvature : oracle::ModelFamily::bent), {}};
  result.model.csg.reset();
  const oracle::PlacedModel placed(result.model);
  for (std::size_t i = 0; i < count; ++i) {
    result.points.push_back(
        random.point(placed, oracle::solid_point_families[i % oracle::solid_point_families.size()]));
  }
  if (k % 2 == 1) {
    Primitive ball{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}};
    const Primitive& bent = result.model.primitives.front();
    for (double& a : ball.superquadric.semi_axes) a = bent.superquadric.semi_axes[0];
    ball.pose.translation = bent.pose.translation;
    ball.pose.translation[0] += 1.5 * bent.superquadric.semi_axes[0];
    result.model.primitives.push_back(ball);
  }
  return result;
}

std::string describe(std::size_t k, const Point& x, const Enclosure& claimed, const Finding& finding) {
  return fmt::format("model {}, point ({}, {}, {}), claimed [{}, {}], proven [{}, {}]", k, x[0], x[1], x[2], claimed.lo,
                     claimed.hi, finding.proven.lo, finding.proven.hi);
}

/// Against a reference that shares nothing with the proofs.
TEST(BentCertificate, ProvesWhatHolds) {
  constexpr std::size_t points_a_model = 14;
  for (std::size_t k = 0; k < 8; ++k) {
    const auto [model, points] = bent_case(k, points_a_model);
    const oracle::SolidReference reference(model);
    const SignedDistance distance(model);
    const Checker check(model);
    for (const Point& x : points) {
      const CertifiedEnclosure found = distance.certified(x, 1e-6 * reference.size());
      const Finding finding = check(x, found.distance, found.certificate);
      EXPECT_EQ(finding.verdict, Verdict::proved) << describe(k, x, found.distance, finding);
      const oracle::SolidFacts facts = reference.facts(x, 0);
      EXPECT_TRUE(!(oracle::Real(found.distance.lo) > facts.upper)) << describe(k, x, found.distance, finding);
      EXPECT_TRUE(!(oracle::Real(found.distance.hi) < facts.lower)) << describe(k, x, found.distance, finding);
      if (facts.side == Membership::inside) {
        EXPECT_LE(found.distance.lo, 0.0);
      } else if (facts.side == Membership::outside) {
        EXPECT_GE(found.distance.hi, 0.0);
      }
    }
  }
}

/// The certificate itself, that of another point, one with its vector turned and stretched, one without its escape.
std::vector<Certificate> forged(const Certificate& certificate, const Certificate& of_another,
                                oracle::RandomCases& random) {
  std::vector<Certificate> forgeries{certificate, of_another};
  for (int i = 0; i < 2 && !certificate.normals.empty(); ++i) {
    Certificate changed = certificate;
    for (double& c : changed.normals.front().vector) c *= random.uniform(0.5, 2.0);
    if (i == 1) changed.escape.reset();
    forgeries.push_back(changed);
  }
  return forgeries;
}

/// Those that exclude `truth`, of its ends that are finite.
std::vector<Enclosure> false_claims(const Enclosure& truth) {
  std::vector<Enclosure> claims;
  if (std::isfinite(truth.hi)) claims.push_back({moved(truth.hi, infinity), infinity});
  if (std::isfinite(truth.lo)) claims.push_back({-infinity, moved(truth.lo, -infinity)});
  return claims;
}

struct Verdicts {
  std::size_t all = 0;
  std::size_t refuted = 0;
};

void expect_nothing_proved(std::size_t k, const Checker& check, const Point& x, const Enclosure& truth,
                           std::span<const Certificate> certificates, Verdicts& verdicts) {
  for (const Certificate& certificate : certificates) {
    for (const Enclosure& claim : false_claims(truth)) {
      const Finding finding = check(x, claim, certificate);
      EXPECT_NE(finding.verdict, Verdict::proved) << describe(k, x, claim, finding);
      ++verdicts.all;
      if (finding.verdict == Verdict::refuted) ++verdicts.refuted;
    }
  }
}

/// Ends past the truth, also with the normals of another point, a vector turned, stretched or with the escape left out.
TEST(BentCertificate, NeverProvesAForgery) {
  constexpr std::size_t points_a_model = 14;
  Verdicts verdicts;
  std::size_t tight = 0;
  for (std::size_t k = 0; k < oracle::requested_count("VERISQ_FORGED_BENDS", 6); ++k) {
    const auto [model, points] = bent_case(k, points_a_model);
    const double size = bounding_radius(model);
    const SignedDistance distance(model);
    const Checker check(model);
    oracle::RandomCases random(k);
    Certificate of_another;
    for (const Point& x : points) {
      const CertifiedEnclosure found = distance.certified(x, 1e-6 * size);
      const Enclosure searched = distance(x, 1e-9 * size);
      const Enclosure truth{std::max(found.distance.lo, searched.lo), std::min(found.distance.hi, searched.hi)};
      if (found.distance.width() <= 1e-9 * size) ++tight;
      expect_nothing_proved(k, check, x, truth, forged(found.certificate, of_another, random), verdicts);
      of_another = found.certificate;
    }
  }
  fmt::print("{} forgeries, none proved, {} refuted outright; {} points tight\n", verdicts.all, verdicts.refuted,
             tight);
  EXPECT_GT(verdicts.all, 400U);
}

/// A rod of constant curvature: beside it and inside it closed forms.
TEST(BentCertificate, IsTightBesideAndInsideARod) {
  const Model rod{"", {{"rod", {{0.2, 0.3, 1.5}, {0.4, 1.0}}, {}, Bend{0.3, 0.0}}}};
  const SignedDistance distance(rod);
  for (const Point& x : {Point{0.0, 1.0, 0.0}, Point{-0.7, 0.1, 0.2}, Point{0.6, 0.0, -0.3}, Point{0.15, 0.0, 0.0}}) {
    const CertifiedEnclosure found = distance.certified(x, 0.0);
    EXPECT_LE(found.distance.width(), 1e-9) << found.distance.lo << ", " << found.distance.hi;
    EXPECT_EQ(Checker(rod)(x, found.distance, found.certificate).verdict, Verdict::proved);
  }
}

/// Whatever stands in a certificate, a claim that excludes the truth is not proved.
TEST(BentCertificate, ProvesNothingFalseFromNonsense) {
  const Model rod{"", {{"rod", {{0.2, 0.3, 1.5}, {0.4, 1.0}}, {}, Bend{0.3, 20.0}}}};
  const Checker check(rod);
  const SignedDistance distance(rod);
  oracle::RandomCases random(5);
  const std::vector<double> extremes{0.0, -0.0, 1e308, 5e-324, -1e-200, infinity, std::nan(""), 1e25};
  const auto number = [&] {
    return random.choice(3) == 0 ? extremes[random.choice(extremes.size())] : random.uniform(-1.0, 1.0);
  };
  const auto vector = [&] { return Point{number(), number(), number()}; };
  for (const Point& x : {Point{0.05, 0.0, 0.1}, Point{0.6, 0.0, -0.3}, Point{1.0 / 0.3, 0.0, 0.0}, Point{9.0, 0.0, 0.0},
                         Point{1e25, 1e25, -1e25}}) {
    const Enclosure truth = distance(x, 1e-6);
    for (int i = 0; i < 300; ++i) {
      Certificate certificate;
      for (std::size_t n = random.choice(3); n > 0; --n)
        certificate.normals.push_back({static_cast<std::uint32_t>(random.choice(2)), vector()});
      if (random.choice(2) == 0) certificate.escape = vector();
      const Finding above = check(x, {moved(truth.hi, infinity), infinity}, certificate);
      const Finding below = check(x, {-infinity, moved(truth.lo, -infinity)}, certificate);
      EXPECT_NE(above.verdict, Verdict::proved);
      EXPECT_NE(below.verdict, Verdict::proved);
    }
  }
}

/// Normals prove nothing of triangles about bends, which have no support function: a wrong one least of all.
TEST(BentCertificate, ProvesTrianglesByCoversAlone) {
  const Model rod{"", {{"rod", {{0.2, 0.3, 1.5}, {0.4, 1.0}}, {}, Bend{0.3, 20.0}}}};
  const Triangle triangle{Point{1.0, 0.0, 0.0}, Point{1.0, 1.0, 0.0}, Point{1.0, 0.0, 1.0}};
  Certificate certificate;
  certificate.normals.push_back({0, {1.0, 0.0, 0.0}});
  EXPECT_EQ(Checker(rod)(triangle, {0.1, infinity}, certificate).verdict, Verdict::unproved);
  const CertifiedEnclosure found = TriangleSearch(rod).certified(triangle, 1e-6);
  EXPECT_LE(found.distance.width(), 1e-6);
  EXPECT_EQ(Checker(rod)(triangle, found.distance, found.certificate).verdict, Verdict::proved);
}

}  // namespace
}  // namespace verisq
