/// The rotation matrix of a quaternion, for kernels that know how far it may be off.
#pragma once

#include <array>

namespace verisq::device {

/// Of q/|q|, row by row; each entry within 2^-53 of the exact one. Precondition: finite, not zero.
[[nodiscard]] std::array<double, 9> rotation_matrix(const std::array<double, 4>& quaternion);

}  // namespace verisq::device
