/// Head, axes and lines of a femur as a model of thin rods, for pictures.
#pragma once

#include <verisq/features.hpp>
#include <verisq/model.hpp>

namespace verisq::features {

/// The head's sphere, and a rod along each axis that the landmarks make. Precondition: at least one of these.
[[nodiscard]] Model drawn_axes(const FemurLandmarks& landmarks);

/// Whether there is anything to draw.
[[nodiscard]] bool has_axes(const FemurLandmarks& landmarks);

}  // namespace verisq::features
