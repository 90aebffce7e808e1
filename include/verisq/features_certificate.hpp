/// What is claimed of a femur's features, and what 127-bit intervals prove of it: the landmarks are all the proof.
#pragma once

#include <array>
#include <optional>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/features.hpp>

namespace verisq {

/// As `femur_features` and `implant_changes` say of the same landmarks.
struct FeatureClaims {
  FemurLandmarks landmarks;
  std::optional<Side> side;
  double landmark_radius;
  std::vector<Feature> features;
  std::optional<FemurFrame> frame = {};
  std::optional<FemurLandmarks> implant = {};  ///< the points that count; nothing: no changes are claimed
  std::vector<Feature> changes = {};
};

/// In the order of the claims. Those of another name, method or unit, or that the landmarks do not tell, are unproved.
struct FeatureFindings {
  std::vector<Finding> features;
  /// Of x, y, z: how far each true axis tilts from the claimed direction, in degrees, claimed no more than its tilt.
  std::optional<std::array<Finding, 3>> frame;
  std::vector<Finding> changes;

  [[nodiscard]] std::vector<Finding> all() const;
};

/// Throws Error(input) as `femur_features`. Precondition: the claims hold no NaN.
[[nodiscard]] FeatureFindings check(const FeatureClaims& claims);

}  // namespace verisq
