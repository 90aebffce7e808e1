/// What is asked of every path of poses.
#pragma once

#include <span>
#include <verisq/model.hpp>

namespace verisq {

/// Throws Error(input) for a path without poses, and for poses that are not finite or have a zero quaternion.
void check_path(std::span<const Pose> path);

/// Throws Error(input) for half a turn from one pose to the next: it has two ways of the same angle, and rounding would
/// choose one. Precondition: `check_path` has passed.
void check_turns(std::span<const Pose> path);

}  // namespace verisq
