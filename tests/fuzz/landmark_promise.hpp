/// What every reader of landmarks promises of the points that it delivers.
#pragma once

#include <verisq/features.hpp>

namespace verisq::fuzz {

/// Throws BrokenPromise.
void check_landmarks(const FemurLandmarks& landmarks);

}  // namespace verisq::fuzz
