/// Claims of features are proved where they contain what 127-bit intervals give, and never else. VERISQ_FORGED_FEATURES
/// says how many femora are tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verisq/features.hpp"

namespace verisq {
namespace {

using oracle::moved;
using oracle::RandomCases;
using oracle::with_wrong_digit;

Point near(RandomCases& random, const Point& x) {
  return {x[0] + random.uniform(-5.0, 5.0), x[1] + random.uniform(-5.0, 5.0), x[2] + random.uniform(-5.0, 5.0)};
}

/// Of a femur about so large, with an implant in it.
FeatureClaims random_claims(RandomCases& random) {
  FeatureClaims claims{.landmarks = {.head_centre = near(random, {45, 0, 40}),
                                     .head_radius = random.uniform(20.0, 28.0),
                                     .neck_centre = near(random, {25, 0, 20}),
                                     .shaft_proximal = near(random, {0, 0, -20}),
                                     .shaft_distal = near(random, {0, 0, -250}),
                                     .medial_posterior_condyle = near(random, {20, -25, -380}),
                                     .lateral_posterior_condyle = near(random, {-25, -25, -380}),
                                     .medial_epicondyle = near(random, {40, 0, -370}),
                                     .lateral_epicondyle = near(random, {-40, 0, -370})},
                       .side = random.choice(2) == 0 ? Side::left : Side::right,
                       .landmark_radius = std::array{0.0, 1e-9, 0.5, 2.0}[random.choice(4)],
                       .features = {}};
  claims.implant = FemurLandmarks{.head_centre = near(random, {45, 0, 40}),
                                  .neck_centre = near(random, {25, 0, 20}),
                                  .shaft_proximal = near(random, {0, 0, -20}),
                                  .shaft_distal = near(random, {0, 0, -150})};
  const FemurFeatures bone = femur_features(claims.landmarks, claims.side, claims.landmark_radius);
  claims.features = bone.features;
  claims.frame = bone.frame;
  claims.changes = implant_changes(claims.landmarks, claims.side, claims.landmark_radius, *claims.implant).features;
  return claims;
}

std::size_t proved(const FeatureClaims& claims) {
  return static_cast<std::size_t>(std::ranges::count(check(claims).all(), Verdict::proved, &Finding::verdict));
}

TEST(FeaturesCertificateTest, ProvesWhatIsSaid) {
  RandomCases random(1);
  for (int i = 0; i < 100; ++i) {
    const FeatureClaims claims = random_claims(random);
    ASSERT_TRUE(claims.frame.has_value());
    EXPECT_GE(claims.features.size(), 8U);
    EXPECT_GE(claims.changes.size(), 6U);
    EXPECT_EQ(proved(claims), claims.features.size() + claims.changes.size() + 3) << i;
  }
}

TEST(FeaturesCertificateTest, NeverProvesAForgery) {
  RandomCases random(2);
  oracle::Forgeries forgeries;
  const auto expect_unproved = [&](const Finding& finding) {
    forgeries.expect_not_proved(finding, finding.proven, "what is proven of it");
  };
  for (std::size_t i = 0; i < oracle::requested_count("VERISQ_FORGED_FEATURES", 30); ++i) {
    const FeatureClaims honest = random_claims(random);
    for (const auto list : {&FeatureClaims::features, &FeatureClaims::changes}) {
      for (std::size_t k = 0; k < (honest.*list).size(); ++k) {
        const auto forge = [&](const auto& make) {
          FeatureClaims claims = honest;
          make((claims.*list)[k]);
          const FeatureFindings findings = check(claims);
          expect_unproved((list == &FeatureClaims::features ? findings.features : findings.changes)[k]);
        };
        const Enclosure& value = (honest.*list)[k].value;
        // By more than both enclosures of one value differ.
        const double far = 1e-9 * (1.0 + std::abs(value.hi));
        forge([&](Feature& claim) { claim.value = {moved(value.hi + far, infinity), infinity}; });
        forge([&](Feature& claim) { claim.value = {-infinity, moved(value.lo - far, -infinity)}; });
        forge([&](Feature& claim) { claim.name += "_"; });
        forge([&](Feature& claim) { claim.method = "another"; });
        forge([&](Feature& claim) {
          claim.unit = claim.unit == FeatureUnit::length ? FeatureUnit::degrees : FeatureUnit::length;
        });
      }
    }
    const auto forge_axis = [&](const auto& make) {
      FeatureClaims claims = honest;
      make(claims.frame->y);
      expect_unproved((*check(claims).frame)[1]);
    };
    forge_axis([](FrameAxis& axis) { axis.tilt_degrees = 0.999 * axis.tilt_degrees - 1e-6; });
    forge_axis([](FrameAxis& axis) { axis.direction = {}; });
    forge_axis([](FrameAxis& axis) { axis.direction = {-axis.direction[0], -axis.direction[1], -axis.direction[2]}; });
    FeatureClaims elsewhere = honest;
    elsewhere.frame->origin[0] = with_wrong_digit(elsewhere.frame->origin[0], random);
    if (elsewhere.frame->origin != honest.frame->origin) expect_unproved((*check(elsewhere).frame)[1]);
  }
  EXPECT_GT(forgeries.told(), 2000U);
}

/// Landmarks that are moved farther than their radius give other features: honest claims of the ones are none of the
/// others.
TEST(FeaturesCertificateTest, ClaimsAreOfTheirLandmarks) {
  RandomCases random(3);
  for (int i = 0; i < 100; ++i) {
    FeatureClaims claims = random_claims(random);
    claims.landmark_radius = 0.0;
    claims.features = femur_features(claims.landmarks, claims.side, 0.0).features;
    (*claims.landmarks.head_centre)[0] += 1.0;
    const FeatureFindings findings = check(claims);
    const auto length = std::ranges::find(claims.features, "offset", &Feature::name);
    ASSERT_NE(length, claims.features.end());
    EXPECT_EQ(findings.features[static_cast<std::size_t>(length - claims.features.begin())].verdict, Verdict::refuted);
  }
}

}  // namespace
}  // namespace verisq
