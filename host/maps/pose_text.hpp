/// Poses as maps of them ask for and name them.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "verisq/error.hpp"
#include "verisq/model.hpp"

namespace verisq {

[[nodiscard]] inline std::string text_of(const Pose& pose) {
  const auto& [t, q] = pose;
  return fmt::format("({}, {}, {}), quaternion ({}, {}, {}, {})", t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
}

/// Throws Error(input) unless all numbers are finite and the quaternion is not zero.
inline void require_pose(const Pose& pose) {
  const auto finite = [](double c) { return std::isfinite(c); };
  if (!std::ranges::all_of(pose.translation, finite) || !std::ranges::all_of(pose.quaternion, finite))
    throw Error(ErrorKind::input, fmt::format("pose {} is not finite", text_of(pose)));
  if (std::ranges::all_of(pose.quaternion, [](double q) { return q == 0.0; }))
    throw Error(ErrorKind::input, fmt::format("pose {} has a zero quaternion", text_of(pose)));
}

}  // namespace verisq
