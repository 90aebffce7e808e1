/// Exponential and logarithm without branches, so that compilers make them for many numbers at once.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace verisq::recovery {

/// e^x to about 1e-16 of it, for -700 <= x <= 700: by Taylor's series about the nearest multiple of ln 2.
[[gnu::always_inline]] inline double fast_exponential(double x) {
  constexpr double rounder =
      0x1.8p52;  // its sum with a number below 2^51 has that number's nearest integer as its bits
  const double shifted = x * 1.4426950408889634 + rounder;
  const double multiple = shifted - rounder;
  const double r = (x - multiple * 0x1.62e42fefap-1) - multiple * 0x1.cf79abc9e3b39p-40;
  double sum = 1.0 / 6227020800.0;
  sum = sum * r + 1.0 / 479001600.0;
  sum = sum * r + 1.0 / 39916800.0;
  sum = sum * r + 1.0 / 3628800.0;
  sum = sum * r + 1.0 / 362880.0;
  sum = sum * r + 1.0 / 40320.0;
  sum = sum * r + 1.0 / 5040.0;
  sum = sum * r + 1.0 / 720.0;
  sum = sum * r + 1.0 / 120.0;
  sum = sum * r + 1.0 / 24.0;
  sum = sum * r + 1.0 / 6.0;
  sum = sum * r + 0.5;
  sum = sum * r + 1.0;
  sum = sum * r + 1.0;
  // The exponent's field: 1023 + the multiple, whose low bits are those of `shifted`.
  return sum * std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023U) << 52U);
}

/// ln x to about 1e-16 + 1e-16 |ln x|, for normal x > 0: x = 2^k m with m from sqrt 1/2 to sqrt 2, and the series of
/// ln m = 2 artanh((m - 1)/(m + 1)).
[[gnu::always_inline]] inline double fast_logarithm(double x) {
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcdULL;  // the bits of sqrt 1/2
  constexpr std::uint64_t mantissa = 0x000fffffffffffffULL;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t above = bits - root_half + (1023ULL << 52U);
  const auto power = std::bit_cast<double>((above >> 52U) | 0x4330000000000000ULL) - (0x1p52 + 1023.0);
  const auto m = std::bit_cast<double>((above & mantissa) + root_half);
  const double s = (m - 1.0) / (m + 1.0);
  const double square = s * s;
  double sum = 1.0 / 21.0;
  sum = sum * square + 1.0 / 19.0;
  sum = sum * square + 1.0 / 17.0;
  sum = sum * square + 1.0 / 15.0;
  sum = sum * square + 1.0 / 13.0;
  sum = sum * square + 1.0 / 11.0;
  sum = sum * square + 1.0 / 9.0;
  sum = sum * square + 1.0 / 7.0;
  sum = sum * square + 1.0 / 5.0;
  sum = sum * square + 1.0 / 3.0;
  sum = sum * square + 1.0;
  return power * 0x1.62e42fefa39efp-1 + 2.0 * s * sum;
}

}  // namespace verisq::recovery
