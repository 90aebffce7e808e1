/// Solutions of x = z + C x, by intervals that are mapped into their inside.
#pragma once

#include <optional>
#include <vector>

#include "verify/equilibrium/precise_box.hpp"

namespace verisq::verify {

/// Rows of a matrix in floating point.
using ApproximateMatrix = std::vector<std::vector<double>>;

/// Of a square matrix, by Gauss and Jordan, about: whatever it is, is sound where it serves. Nothing where the matrix
/// seems singular.
[[nodiscard]] std::optional<ApproximateMatrix> approximate_inverse(ApproximateMatrix m);

/// Of x = z + C x for all matrices of `c`: where there is exactly one for each, and where it lies (Rump 1999, theorem
/// 10.2: z + C W inside W proves that the spectral radius of |C| is below 1).
struct FixedPoints {
  PreciseBox tried;  ///< the operator maps it into its inside
  PreciseBox found;
};

/// Of a square matrix by its rows. Nothing where that is not proven.
[[nodiscard]] std::optional<FixedPoints> fixed_points(const PreciseBox& z, const std::vector<PreciseBox>& c);

}  // namespace verisq::verify
