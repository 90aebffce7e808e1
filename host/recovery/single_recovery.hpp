/// One shape for a cloud: from many starts on a part of its points, the best of them on all.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

#include "host/recovery/mixture_fit.hpp"

namespace verisq::recovery {

struct SingleOptions {
  Family family = Family::plain;
  std::uint64_t seed = 1;
  std::optional<double> most_outliers;  ///< share of the points; nothing: 0.6
};

/// The same seed gives the same bits. Precondition: at least four points, not all in a plane.
[[nodiscard]] MixtureFit recover_single(std::span<const Eigen::Vector3d> points, const SingleOptions& options);

}  // namespace verisq::recovery
