/// One shape for a cloud: many starts on a part of the points, the best of them polished on all.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "host/recovery/mixture_fit.hpp"

namespace verisq::recovery {

struct SingleOptions {
  Family family = Family::plain;
  std::uint64_t seed = 1;
};

/// Precondition: at least four points, not all in a plane.
[[nodiscard]] MixtureFit recover_single(std::span<const Eigen::Vector3d> points, const SingleOptions& options);

}  // namespace verisq::recovery
