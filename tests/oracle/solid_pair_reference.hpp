/// The reference for the distance of two models: between two proofs that share nothing with verify/ and kernels/.
#pragma once

#include <cstddef>
#include <verisq/model.hpp>

#include "tests/oracle/real.hpp"

namespace verisq::oracle {

/// `lower <= distance <= upper`, whatever the search found; `upper` is 0 where MPFR proves a common point.
struct SolidPairFacts {
  Real lower;
  Real upper;
};

/// From above by points of both models that MPFR proves to be in them, found by alternating projections between dense
/// samples; from below by pairs of octree cubes, best first, as many as `budget`.
[[nodiscard]] SolidPairFacts pair_facts(const Model& first, const Model& second, std::size_t budget);

}  // namespace verisq::oracle
