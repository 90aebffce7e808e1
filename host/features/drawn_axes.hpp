/// Head, axes and lines of a femur as a model of thin rods, for pictures.
#pragma once

#include <verisq/features.hpp>
#include <verisq/model.hpp>

namespace verisq::features {

/// The name of the head's sphere.
inline constexpr const char* drawn_head = "head";

/// The head's sphere, and a rod along each axis that the landmarks make: no primitives where there is none of these.
[[nodiscard]] Model drawn_axes(const FemurLandmarks& landmarks);

}  // namespace verisq::features
