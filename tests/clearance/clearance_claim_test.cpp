/// What a fit claims is proved where it is so, and never where it is not: distances known exactly, sums in MPFR.
/// VERISQ_FORGED_CLAIMS says of how many fits.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "tests/fixtures/requested_count.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using Number =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>, boost::multiprecision::et_off>;

/// A fit to a bone whose distances are binary64 numbers.
struct KnownFit {
  ClearanceTerms terms;
  std::vector<double> distances;

  /// `width` wide, and containing them.
  [[nodiscard]] std::vector<Enclosure> enclosures(double width) const {
    std::vector<Enclosure> result;
    for (const double d : distances) result.push_back({d - width, d + width});
    return result;
  }
};

KnownFit known_fit(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> distance(-2.0, 6.0);
  std::uniform_real_distribution<double> weight(0.0, 4.0);
  const std::size_t points = 1 + engine() % 40;
  KnownFit fit{{seed % 2 == 0 ? cementless(2.0, 0.5) : cemented(1.5, 1.0), seed % 3 == 0 ? 0.0 : 0.5, {}, {}}, {}};
  for (const char* const name : {"proximal", "distal", "elsewhere"}) fit.terms.areas.push_back({name, weight(engine)});
  for (std::size_t n = 0; n < points; ++n) {
    fit.terms.area_of.push_back(static_cast<std::uint32_t>(engine() % 3));
    fit.distances.push_back(distance(engine));
  }
  return fit;
}

/// As the program claims them.
std::vector<ClearanceClaim> claims_about(const KnownFit& fit, double width) {
  return claims_of(clearance_of(fit.terms, fit.enclosures(width)));
}

Number exact_fitness(const Fitness& fitness, const Number& distance) {
  const Number apart = (distance - Number(fitness.target)) / Number(fitness.scale);
  const Number inside = distance < 0 ? Number(distance / Number(fitness.scale)) : Number(0);
  return 1 / (1 + apart * apart) - inside * inside;
}

/// The number that a claim is about, by words of its own.
Number truth(const KnownFit& fit, const ClearanceClaim& claim) {
  std::vector<double> of_claim;
  Number objective = 0;
  for (std::size_t n = 0; n < fit.distances.size(); ++n) {
    const Area& area = fit.terms.areas[fit.terms.area_of[n]];
    if (claim.area.empty() || area.name == claim.area) of_claim.push_back(fit.distances[n]);
    objective += Number(area.weight) * exact_fitness(fit.terms.fitness, fit.distances[n]);
  }
  std::ranges::sort(of_claim);
  const auto count_if = [&](const auto& holds) { return Number(std::ranges::count_if(of_claim, holds)); };
  const auto ranked = [&](std::size_t percent) {
    std::size_t rank = 1;
    while (100 * rank < percent * of_claim.size()) ++rank;
    return Number(of_claim[rank - 1]);
  };
  if (claim.what == "objective") return objective;
  if (claim.what == "smallest_distance") return of_claim.front();
  if (claim.what == "deepest_penetration") return std::max(0.0, -of_claim.front());
  if (claim.what == "points_within_limit") return count_if([&](double d) { return d >= -fit.terms.penetration_limit; });
  if (claim.what == "points_within_band") {
    const Enclosure& serves = fit.terms.fitness.serves;
    return count_if([&](double d) { return serves.lo <= d && d <= serves.hi; });
  }
  if (claim.what == "mean_distance") {
    Number sum = 0;
    for (const double d : of_claim) sum += d;
    return sum / of_claim.size();
  }
  return ranked(claim.what == "median_distance" ? 50 : 95);
}

bool contains(const Enclosure& value, const Number& exact) {
  return Number(value.lo) <= exact && exact <= Number(value.hi);
}

constexpr double width = 1e-9;

TEST(ClearanceClaims, AreTrueAndProved) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const KnownFit fit = known_fit(seed);
    const std::vector<ClearanceClaim> claims = claims_about(fit, width);
    const std::vector<Finding> found = check(claims, clearance_of(fit.terms, fit.enclosures(width)));
    ASSERT_EQ(found.size(), claims.size());
    for (std::size_t i = 0; i < claims.size(); ++i) {
      EXPECT_EQ(found[i].verdict, Verdict::proved) << claims[i].what;
      EXPECT_TRUE(contains(claims[i].value, truth(fit, claims[i]))) << claims[i].what << " " << claims[i].area;
    }
  }
}

TEST(ClearanceClaims, AreProvedByTighterDistancesAndOpenByWiderOnes) {
  const KnownFit fit = known_fit(1);
  const std::vector<ClearanceClaim> claims = claims_about(fit, width);
  for (const Finding& found : check(claims, clearance_of(fit.terms, fit.enclosures(width / 8))))
    EXPECT_EQ(found.verdict, Verdict::proved);
  const std::vector<Enclosure> nothing(fit.distances.size(), {-infinity, infinity});
  for (const Finding& found : check(claims, clearance_of(fit.terms, nothing)))
    EXPECT_EQ(found.verdict, Verdict::unproved);
  EXPECT_EQ(check(claims, clearance_of(fit.terms, fit.enclosures(8 * width))).front().verdict, Verdict::unproved);
}

TEST(ClearanceClaims, OfUnknownNamesAreUnproved) {
  const KnownFit fit = known_fit(2);
  const std::vector<ClearanceClaim> claims{{"sides", "", {-infinity, infinity}},
                                           {"mean_distance", "nowhere", {0.0, 0.0}},
                                           {"objective", "proximal", {0.0, 1e9}}};
  const std::vector<Finding> found = check(claims, clearance_of(fit.terms, fit.enclosures(width)));
  EXPECT_EQ(found[0].verdict, Verdict::unproved);
  EXPECT_EQ(found[1].verdict, Verdict::unproved);
  EXPECT_EQ(found[2].verdict, Verdict::unproved);
}

/// Claims that miss the truth by 10^-12, however wide, and claims of other terms where those have another truth.
TEST(ClearanceClaims, NeverProvesAForgery) {
  std::size_t forged = 0;
  const auto expect_not = [&](const KnownFit& fit, const ClearanceClaim& claim, double used) {
    const Finding found = check(std::vector{claim}, clearance_of(fit.terms, fit.enclosures(used))).front();
    EXPECT_NE(found.verdict, Verdict::proved) << claim.what << " " << claim.area;
    ++forged;
  };
  for (std::uint64_t seed = 0; seed < oracle::requested_count("VERISQ_FORGED_CLAIMS", 120); ++seed) {
    const KnownFit fit = known_fit(seed);
    KnownFit other = fit;
    other.terms.penetration_limit += 0.7;
    other.terms.areas[seed % 3].weight += 0.5;
    other.terms.area_of[seed % fit.distances.size()] = static_cast<std::uint32_t>((seed + 1) % 3);
    other.terms.fitness.scale *= 1.01;
    other.distances[(seed / 3) % fit.distances.size()] += 1e-3;
    for (const ClearanceClaim& claim : claims_about(fit, width)) {
      const Number exact = truth(fit, claim);
      const double off = 1e-12 * std::max(1.0, std::abs(static_cast<double>(exact)));
      const double below = static_cast<double>(Number(exact - off));
      const double above = static_cast<double>(Number(exact + off));
      for (const double used : {width, 1e-15, 0.0}) {
        expect_not(fit, {claim.what, claim.area, {above, infinity}}, used);
        expect_not(fit, {claim.what, claim.area, {-infinity, below}}, used);
      }
      const bool known = std::ranges::any_of(claims_about(other, width), [&](const auto& of_other) {
        return of_other.what == claim.what && of_other.area == claim.area;
      });
      if (!known || contains(claim.value, truth(other, claim))) continue;
      expect_not(other, claim, width);
    }
  }
  fmt::print("{} forgeries, none proved\n", forged);
  EXPECT_GT(forged, 100U);
}

}  // namespace
}  // namespace verisq
