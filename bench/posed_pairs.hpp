/// Reproducible random poses of a superquadric B beside a superquadric A that stays in its own frame: separated, in
/// generic rotations, near and far.
#pragma once

#include <vector>
#include <verisq/model.hpp>

namespace verisq::bench {

/// B lies beyond a supporting plane of A by 0.01, 0.1, 1 or 10 times the larger of the two sizes, in turn: their
/// distance is at least that. Directions and rotations are uniform; the sequence depends on the arguments alone.
[[nodiscard]] std::vector<Pose> separated_poses(const Superquadric& a, const Superquadric& b, std::size_t count);

}  // namespace verisq::bench
