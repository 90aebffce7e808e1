/// The functions by which balls are proven to lie in bent superquadrics, half the square of the gauge and that of the
/// section's norm over its profile, and their derivatives (docs/mathematics.md §9), in extended precision.
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

  [[nodiscard]] Long value(const LongVector& x) const;

  /// Sizes of the gradient's components; x != 0.
  [[nodiscard]] LongVector gradient(const LongVector& x) const;

  /// With the signs of the octant of nonnegative coordinates; off the axis.
  [[nodiscard]] LongMatrix second_derivative(const LongVector& x) const;

 private:
  oracle::MixedNorm<Long> norm_;
};

/// (r² - h²)/2, r the norm of the section, h(z) = (1 - |z/a3|^p1)^(1/p1). Likewise, between the ends. With a taper
/// coordinates are about the focus, and h = S (1 - |Z|^p1)^(1/p1), S = 1 - k² + k z/a3, Z = z/(a3 S).
class SectionProfile {
 public:
  explicit SectionProfile(const Superquadric& superquadric)
      : section_(superquadric),
        end_(superquadric.semi_axes[2]),
        p_1_(2 / static_cast<Long>(superquadric.exponents[0])),
        taper_(static_cast<double>((static_cast<Long>(superquadric.taper) - 1) /
                                   (static_cast<Long>(superquadric.taper) + 1))) {}

  [[nodiscard]] Long value(const LongVector& x) const;

  /// The third component has its sign.
  [[nodiscard]] LongVector gradient(const LongVector& x) const;

  /// Infinite at the ends and beyond.
  [[nodiscard]] LongMatrix second_derivative(const LongVector& x) const;

 private:
  /// S, Z, h/S and its derivative by Z.
  struct Height {
    Long room, untapered, profile, slope;
  };
  [[nodiscard]] Height height(Long z) const;

  GaugeSquare section_;  // at z = 0
  Long end_;
  Long p_1_;
  Long taper_;  // k, as rounded for devices
};

/// A step of length 1 along which `second` is all but largest, and its value; z counts `stretch` times in the length.
struct LargestStep {
  LongVector step;
  Long value;
};
[[nodiscard]] LargestStep largest_step(const LongMatrix& second, Long stretch);

}  // namespace verisq::mutation
