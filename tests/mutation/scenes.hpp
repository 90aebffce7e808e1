/// Models and points on which a flaw of the kernels shows.
#pragma once

#include <vector>

#include "tests/mutation/map_judge.hpp"

namespace verisq::mutation {

/// Single solids and unions, smooth and sharp, flat and far from the origin, with points outside, inside, on the
/// surface, on faces that solids share, and at the limits of binary64. The same at every call.
[[nodiscard]] std::vector<Scene> scenes();

}  // namespace verisq::mutation
