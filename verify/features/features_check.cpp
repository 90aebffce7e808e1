/// Encloses the features once more, and compares.
#include <algorithm>
#include <array>

#include "verify/features/precise_features.hpp"
#include "verify/proof/certificate.hpp"
#include "verify/proof/judgement.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/features_certificate.hpp"

namespace verisq {
namespace {

constexpr Finding nothing_known{Verdict::unproved, {-infinity, infinity}};

std::vector<Finding> judged(const std::vector<Feature>& claims, const FemurFeatures& proven) {
  std::vector<Finding> findings;
  for (const Feature& claim : claims) {
    const auto same = std::ranges::find_if(proven.features, [&](const Feature& known) {
      return known.name == claim.name && known.method == claim.method && known.unit == claim.unit;
    });
    const bool is_known = same != proven.features.end();
    findings.push_back(is_known ? verify::judged(claim.value, same->value, same->value) : nothing_known);
  }
  return findings;
}

/// Whose origin is the head's centre itself.
std::array<Finding, 3> judged(const FemurFrame& claim, const FeatureClaims& claims) {
  std::array<Finding, 3> findings{nothing_known, nothing_known, nothing_known};
  const std::array axes{&claim.x, &claim.y, &claim.z};
  const auto has_direction = [](const FrameAxis* axis) {
    const auto& [x, y, z] = axis->direction;
    return verify::usable({x, y, z});
  };
  if (claims.landmarks.head_centre != claim.origin || !std::ranges::all_of(axes, has_direction)) return findings;
  const auto tilts = verify::precise_tilts(claims.landmarks, claims.side, claims.landmark_radius,
                                           {claim.x.direction, claim.y.direction, claim.z.direction});
  for (std::size_t i = 0; tilts && i < axes.size(); ++i) {
    const double tilt = (*tilts)[i];
    findings[i] = {tilt <= axes[i]->tilt_degrees ? Verdict::proved : Verdict::unproved, {0.0, tilt}};
  }
  return findings;
}

}  // namespace

std::vector<Finding> FeatureFindings::all() const {
  std::vector<Finding> result = features;
  if (frame) result.insert(result.end(), frame->begin(), frame->end());
  result.insert(result.end(), changes.begin(), changes.end());
  return result;
}

FeatureFindings check(const FeatureClaims& claims) {
  const auto& [landmarks, side, radius, features, frame, implant, changes] = claims;
  const FemurFeatures proven = verify::precise_femur_features(landmarks, side, radius);
  FeatureFindings findings{judged(features, proven), {}, std::vector<Finding>(changes.size(), nothing_known)};
  if (frame) findings.frame = judged(*frame, claims);
  if (implant) {
    findings.changes = judged(changes, verify::precise_implant_changes(landmarks, side, radius, *implant));
  }
  return findings;
}

}  // namespace verisq
