/// Features of a femur in 127-bit intervals: what claims of them are compared with.
#pragma once

#include <array>
#include <optional>

#include "verisq/features.hpp"

namespace verisq::verify {

/// As the functions of verisq/features.hpp, each end rounded outward to binary64.
[[nodiscard]] FemurFeatures precise_femur_features(const FemurLandmarks& landmarks, std::optional<Side> side,
                                                   double landmark_radius);
[[nodiscard]] FemurFeatures precise_implant_changes(const FemurLandmarks& bone, std::optional<Side> side,
                                                    double landmark_radius, const FemurLandmarks& implant);

/// Of the frame's axes x, y, z: how far in degrees each tilts at most from a direction; nothing where the landmarks
/// make no frame. Precondition: finite, not 0.
[[nodiscard]] std::optional<std::array<double, 3>> precise_tilts(const FemurLandmarks& landmarks,
                                                                 std::optional<Side> side, double landmark_radius,
                                                                 const std::array<Point, 3>& directions);

}  // namespace verisq::verify
