/// Certificates by witnesses and covers, of set operations, bends and overlaps: what they prove holds, is as tight as
/// asked for, and no forgery is proved. VERISQ_FORGED_COVERS says about how many models are tried.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
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

struct CoverCase {
  Model model;
  std::vector<Point> points;
};

CoverCase cover_case(std::size_t k, std::size_t count) {
  oracle::RandomSolids random(400 + k);
  CoverCase result{random.model(oracle::model_families[k % oracle::model_families.size()]), {}};
  const oracle::PlacedModel placed(result.model);
  for (std::size_t i = 0; i < count; ++i) {
    result.points.push_back(
        random.point(placed, oracle::solid_point_families[i % oracle::solid_point_families.size()]));
  }
  return result;
}

std::string describe(std::size_t k, const Point& x, const Enclosure& claimed, const Finding& finding) {
  return fmt::format("model {}, point ({}, {}, {}), claimed [{}, {}], proven [{}, {}]", k, x[0], x[1], x[2], claimed.lo,
                     claimed.hi, finding.proven.lo, finding.proven.hi);
}

/// Against a reference that shares nothing with the proofs.
TEST(CoverCertificate, ProvesWhatHolds) {
  constexpr std::size_t points_a_model = 10;
  std::size_t all = 0;
  std::size_t narrow = 0;
  for (std::size_t k = 0; k < 2 * oracle::model_families.size(); ++k) {
    const auto [model, points] = cover_case(k, points_a_model);
    const oracle::SolidReference reference(model);
    const SignedDistance distance(model);
    const Checker check(model);
    const double tolerance = 1e-4 * bounding_radius(model);
    for (const Point& x : points) {
      const CertifiedEnclosure found = distance.certified(x, tolerance);
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
      ++all;
      if (found.distance.width() <= tolerance) ++narrow;
    }
  }
  fmt::print("{} of {} within the tolerance\n", narrow, all);
  EXPECT_GE(10 * narrow, 8 * all);
}

/// The certificate itself, that of another point, leaves removed, halved and joined, points moved, normals turned.
std::vector<Certificate> forged(const Certificate& certificate, const Certificate& of_another, const Point& x,
                                oracle::RandomCases& random) {
  std::vector<Certificate> forgeries(9, certificate);
  forgeries[1] = of_another;
  forgeries[2].cover = {false};
  forgeries[3].cover = {true, false, false};
  if (!certificate.cover.empty()) {
    forgeries[4].cover.pop_back();
    const std::size_t at = random.choice(certificate.cover.size());
    forgeries[5].cover[at] = !forgeries[5].cover[at];
  }
  forgeries[6].witness = x;
  forgeries[7].escape = x;
  for (Normal& normal : forgeries[8].normals) {
    for (double& c : normal.vector) c *= random.uniform(0.5, 2.0);
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

/// The model's first primitive a little larger, or smaller: of it the claims about the other one are false, too, as
/// they exclude the truth by more than such a change can move it.
TEST(CoverCertificate, NeverProvesAForgery) {
  constexpr std::size_t points_a_model = 10;
  std::size_t all = 0;
  std::size_t refuted = 0;
  std::size_t covers = 0;
  for (std::size_t k = 0; k < oracle::requested_count("VERISQ_FORGED_COVERS", 8); ++k) {
    const auto [model, points] = cover_case(k, points_a_model);
    const double size = bounding_radius(model);
    const SignedDistance distance(model);
    const Checker check(model);
    oracle::RandomCases random(k);
    Certificate of_another;
    for (const Point& x : points) {
      const CertifiedEnclosure found = distance.certified(x, 1e-4 * size);
      const Enclosure searched = distance(x, 1e-7 * size);
      const Enclosure truth{std::max(found.distance.lo, searched.lo), std::min(found.distance.hi, searched.hi)};
      if (found.certificate.cover.size() > 1) ++covers;
      for (const Certificate& certificate : forged(found.certificate, of_another, x, random)) {
        for (const Enclosure& claim : false_claims(truth)) {
          const Finding finding = check(x, claim, certificate);
          EXPECT_NE(finding.verdict, Verdict::proved) << describe(k, x, claim, finding);
          ++all;
          if (finding.verdict == Verdict::refuted) ++refuted;
        }
      }
      of_another = found.certificate;
    }
  }
  fmt::print("{} forgeries, none proved, {} refuted outright; {} points with covers of several cells\n", all, refuted,
             covers);
  EXPECT_GT(all, 1000U);
}

SetExpression leaf(std::uint32_t primitive) {
  return {.operands = {}, .operation = SetOperation::unite, .primitive = primitive};
}

/// A ball with a smaller one cut out of its side: along the rim, closed forms.
TEST(CoverCertificate, ProvesTheRimOfADifference) {
  Model model{"", {{"ball", {{1, 1, 1}, {1, 1}}, {}}, {"cut", {{0.5, 0.5, 0.5}, {1, 1}}, {}}}};
  model.primitives[1].pose.translation = {1.0, 0.0, 0.0};
  model.csg = SetExpression{{leaf(0), leaf(1)}, SetOperation::subtract};
  // The rim lies in x = 7/8, |(y, z)| = √15/8.
  const Point x{1.2, 0.1, 0.0};
  const double rim = std::hypot(1.2 - 0.875, 0.1 - std::sqrt(15.0) / 8);
  const CertifiedEnclosure found = SignedDistance(model).certified(x, 1e-6);
  EXPECT_LE(found.distance.lo, rim);
  EXPECT_GE(found.distance.hi, rim);
  EXPECT_LE(found.distance.width(), 1e-6);
  const Checker check(model);
  EXPECT_EQ(check(x, found.distance, found.certificate).verdict, Verdict::proved);
  EXPECT_NE(check(x, Enclosure{rim + 1e-12, infinity}, found.certificate).verdict, Verdict::proved);
  Certificate leafless = found.certificate;
  leafless.cover.pop_back();
  EXPECT_EQ(check(x, found.distance, leafless).verdict, Verdict::unproved);
}

/// Where two balls touch in a face of a common box, that face lies inside: no escape is on it.
TEST(CoverCertificate, KnowsThatASharedFaceLiesInside) {
  Model boxes{"", {{"left", {{1, 1, 1}, {0.1, 0.1}}, {}}, {"right", {{1, 1, 1}, {0.1, 0.1}}, {}}}};
  boxes.primitives[1].pose.translation = {2.0, 0.0, 0.0};
  const Checker check(boxes);
  const Point face{1.0, 0.0, 0.0};
  Certificate certificate;
  certificate.escape = face;
  EXPECT_NE(check(Point{0.9, 0.0, 0.0}, Enclosure{-0.2, infinity}, certificate).verdict, Verdict::proved);
}

/// A corner at a hard point, the others from near to far; some are segments or points.
Triangle triangle_at(const Point& x, double size, oracle::RandomCases& random) {
  const double edge = size * random.log_uniform(1e-4, 2.0);
  Triangle triangle{x, x, x};
  for (std::size_t i = random.choice(6) == 0 ? 2 : 1; i < 3; ++i) {
    const Point way = random.direction();
    for (std::size_t k = 0; k < 3; ++k) triangle[i][k] += edge * way[k];
  }
  return triangle;
}

Point point_of(const Triangle& triangle, double first, double second) {
  Point result;
  for (std::size_t k = 0; k < 3; ++k) {
    result[k] = triangle[0][k] + first * (triangle[1][k] - triangle[0][k]) + second * (triangle[2][k] - triangle[0][k]);
  }
  return result;
}

std::string describe(std::size_t k, const Triangle& t, const Enclosure& claimed, const Finding& finding) {
  return describe(k, t[0], claimed, finding) +
         fmt::format(", corners ({}), ({})", fmt::join(t[1], ", "), fmt::join(t[2], ", "));
}

/// No point of the triangle that the reference knows is nearer, and the search agrees.
TEST(TriangleCoverCertificate, ProvesWhatHolds) {
  std::size_t all = 0;
  std::size_t narrow = 0;
  for (std::size_t k = 0; k < 2 * oracle::model_families.size(); ++k) {
    const auto [model, points] = cover_case(k, 6);
    const oracle::SolidReference reference(model);
    const TriangleSearch search(model);
    const Checker check(model);
    const double size = bounding_radius(model);
    oracle::RandomCases random(900 + k);
    for (const Point& x : points) {
      const Triangle triangle = triangle_at(x, size, random);
      const CertifiedEnclosure found = search.certified(triangle, 1e-4 * size);
      const Finding finding = check(triangle, found.distance, found.certificate);
      EXPECT_EQ(finding.verdict, Verdict::proved) << describe(k, triangle, found.distance, finding);
      const Enclosure searched = search(triangle, 1e-4 * size);
      EXPECT_LE(found.distance.lo, searched.hi) << describe(k, triangle, found.distance, finding);
      EXPECT_GE(found.distance.hi, searched.lo) << describe(k, triangle, found.distance, finding);
      const double rounding = 1e-12 * (size + std::hypot(x[0], x[1], x[2]));
      for (const auto& [first, second] : std::vector<std::array<double, 2>>{{0, 0}, {1, 0}, {0, 1}, {0.3, 0.3}}) {
        const oracle::SolidFacts facts = reference.facts(point_of(triangle, first, second), 0);
        EXPECT_TRUE(!(oracle::Real(found.distance.lo - rounding) > facts.upper))
            << describe(k, triangle, found.distance, finding);
      }
      ++all;
      if (found.distance.width() <= 1e-4 * size) ++narrow;
    }
  }
  fmt::print("{} of {} within the tolerance\n", narrow, all);
  EXPECT_GE(10 * narrow, 9 * all);
}

TEST(TriangleCoverCertificate, NeverProvesAForgery) {
  std::size_t all = 0;
  std::size_t refuted = 0;
  for (std::size_t k = 0; k < oracle::requested_count("VERISQ_FORGED_COVERS", 8); ++k) {
    const auto [model, points] = cover_case(k, 10);
    const double size = bounding_radius(model);
    const TriangleSearch search(model);
    const Checker check(model);
    oracle::RandomCases random(k);
    Certificate of_another;
    for (const Point& x : points) {
      const Triangle triangle = triangle_at(x, size, random);
      const CertifiedEnclosure found = search.certified(triangle, 1e-4 * size);
      const Enclosure searched = search(triangle, 1e-6 * size);
      const Enclosure truth{std::max(found.distance.lo, searched.lo), std::min(found.distance.hi, searched.hi)};
      std::vector<Certificate> forgeries = forged(found.certificate, of_another, x, random);
      for (const double weight : {0.0, 1.0, 1.5, -0.5}) {
        forgeries.push_back(found.certificate);
        forgeries.back().weights = {weight, 1.0 - weight};
      }
      for (const Certificate& certificate : forgeries) {
        std::vector<Enclosure> claims{{moved(truth.hi, infinity), infinity}};
        if (truth.lo > 0.0) claims.push_back({0.0, moved(truth.lo, -infinity)});
        for (const Enclosure& claim : claims) {
          const Finding finding = check(triangle, claim, certificate);
          EXPECT_NE(finding.verdict, Verdict::proved) << describe(k, triangle, claim, finding);
          ++all;
          if (finding.verdict == Verdict::refuted) ++refuted;
        }
      }
      of_another = found.certificate;
    }
  }
  fmt::print("{} forgeries, none proved, {} refuted outright\n", all, refuted);
  EXPECT_GT(all, 1000U);
}

/// The rim of the ball with a bite, and an edge that passes it: closed form.
TEST(TriangleCoverCertificate, ProvesTheRimOfADifference) {
  Model model{"", {{"ball", {{1, 1, 1}, {1, 1}}, {}}, {"cut", {{0.5, 0.5, 0.5}, {1, 1}}, {}}}};
  model.primitives[1].pose.translation = {1.0, 0.0, 0.0};
  model.csg = SetExpression{{leaf(0), leaf(1)}, SetOperation::subtract};
  // In the plane (0.96, 0.28, 0)·x = 1.5: of the rim in x = 7/8 the point with z = 0 is nearest.
  const auto corner = [](double along, double z) {
    return Point{1.5 * 0.96 - 0.28 * along, 1.5 * 0.28 + 0.96 * along, z};
  };
  const double rim = 1.5 - (0.96 * 0.875 + 0.28 * std::sqrt(15.0) / 8);
  const Triangle triangle{corner(-3, -3), corner(3, -3), corner(0, 5)};
  const CertifiedEnclosure found = TriangleSearch(model).certified(triangle, 1e-6);
  EXPECT_LE(found.distance.lo, rim);
  EXPECT_GE(found.distance.hi, rim);
  EXPECT_LE(found.distance.width(), 1e-6);
  const Checker check(model);
  EXPECT_EQ(check(triangle, found.distance, found.certificate).verdict, Verdict::proved);
  EXPECT_NE(check(triangle, Enclosure{rim + 1e-12, infinity}, found.certificate).verdict, Verdict::proved);
}

/// What is left to the exact distance costs its logarithm in cells.
TEST(TriangleCoverCertificate, IsTightAboutBends) {
  Model model{"", {{"stem", {{0.4, 0.3, 1.0}, {0.5, 1.0}}, {}}}};
  model.primitives[0].bend = Bend{0.5, 30.0};
  const Triangle triangle{{{1.2, -2.0, 0.5}, {1.3, 2.0, 0.4}, {1.0, 0.1, 3.0}}};
  const TriangleSearch search(model);
  std::size_t cells = 0;
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    const CertifiedEnclosure found = search.certified(triangle, tolerance);
    EXPECT_LE(found.distance.width(), tolerance);
    if (cells > 0) {
      EXPECT_LT(found.certificate.cover.size(), cells + 1000);
    }
    cells = found.certificate.cover.size();
    EXPECT_EQ(Checker(model)(triangle, found.distance, found.certificate).verdict, Verdict::proved);
  }
}

/// Small motions open gaps between primitives: of intervals nothing is proven by several of them together.
TEST(CoverCertificate, IsNotForWhatIsNotExact) {
  Model model{"", {{"a", {{1, 1, 1}, {1, 1}}, {}}, {"b", {{1, 1, 1}, {1, 1}}, {}}}};
  model.primitives[1].pose.translation = {0.5, 0.0, 0.0};
  const Point x{0.25, 0.0, 0.0};
  const CertifiedEnclosure found = SignedDistance(model).certified(x, 1e-6);
  EXPECT_LT(found.distance.hi, -0.9);  // one alone proves -0.75
  EXPECT_EQ(Checker(model)(x, found.distance, found.certificate).verdict, Verdict::proved);
  EXPECT_NE(Checker(model, 1e-9)(x, found.distance, found.certificate).verdict, Verdict::proved);
  model.csg = SetExpression{{leaf(0), leaf(1)}, SetOperation::intersect};
  EXPECT_THROW(Checker(model, 1e-9), Error);
}

}  // namespace
}  // namespace verisq
