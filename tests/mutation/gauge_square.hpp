/// Half the square of a superquadric's gauge, and its derivatives (docs/mathematics.md §9), in extended precision.
#pragma once

#include <array>
#include <verisq/model.hpp>

#include "tests/oracle/mixed_norm.hpp"

namespace verisq::mutation {

using Long = long double;
using LongVector = std::array<Long, 3>;
using LongMatrix = std::array<LongVector, 3>;

/// Exponents at most 1, for which the second derivative is bounded.
class GaugeSquare {
 public:
  explicit GaugeSquare(const Superquadric& superquadric) : norm_(superquadric) {}

  [[nodiscard]] Long half_square(const LongVector& x) const;

  /// Sizes of the gradient's components; x != 0.
  [[nodiscard]] LongVector gradient(const LongVector& x) const;

  /// With the signs of the octant of nonnegative coordinates; off the axis.
  [[nodiscard]] LongMatrix second_derivative(const LongVector& x) const;

 private:
  oracle::MixedNorm<Long> norm_;
};

/// A step of length 1 along which `second` is all but largest, and its value; z counts `stretch` times in the length.
struct LargestStep {
  LongVector step;
  Long value;
};
[[nodiscard]] LargestStep largest_step(const LongMatrix& second, Long stretch);

}  // namespace verisq::mutation
