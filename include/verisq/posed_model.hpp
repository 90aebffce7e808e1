/// Moves a whole model.
#pragma once

#include <verisq/features.hpp>
#include <verisq/model.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq {

/// The model moved by x -> R x + t after its primitives' own poses: these are composed and rounded to nearest, so that
/// the moved model is a model of its own, exactly as its numbers state, within a few units in the last place of the
/// rigid motion. Quaternions come out with length 1 to rounding. Precondition: as for Pose. Throws Error(input) where
/// places overflow.
[[nodiscard]] Model posed(const Model& model, const Pose& pose);

/// Likewise with semi-axes and exponents known within bounds, which no motion changes. Throws Error(input) where a
/// translation is: a turned box of places is no box.
[[nodiscard]] UncertainModel posed(const UncertainModel& model, const Pose& pose);

/// A point moved likewise, each coordinate to nearest.
[[nodiscard]] Point posed(const Point& point, const Pose& pose);

/// Points that the model's file names, moved with it: each coordinate to nearest.
[[nodiscard]] FemurLandmarks posed(const FemurLandmarks& landmarks, const Pose& pose);

}  // namespace verisq
