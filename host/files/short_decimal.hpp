/// Decimal numbers of few digits, as most files have them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace verisq {

/// Those that binary64 holds exactly and that a short number asks for.
inline constexpr std::array<double, 20> powers_of_ten{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,
                                                      1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19};

/// Appends the digits that the text begins with to `number`; returns the end of them.
[[nodiscard]] inline const char* append_digits(const char* at, const char* end, std::uint64_t& number) {
  for (; at != end && '0' <= *at && *at <= '9'; ++at) number = 10 * number + static_cast<std::uint64_t>(*at - '0');
  return at;
}

/// Reads the number, "-12.345" for instance, that the text begins with, as std::from_chars does: returns its end. Null
/// where it has many digits or an exponent, or is none: then nothing is said of it. Correctly rounded, for it is a
/// quotient of two numbers that binary64 holds.
[[nodiscard]] inline const char* read_short_decimal(const char* at, const char* end, double& number) {
  constexpr std::ptrdiff_t most_digits = 19;                        // which 64 bits hold
  constexpr std::uint64_t largest_exact = std::uint64_t{1} << 53U;  // and all integers below
  const bool negative = at != end && *at == '-';
  const char* const whole = negative ? at + 1 : at;
  std::uint64_t significand = 0;
  const char* after = append_digits(whole, end, significand);
  std::ptrdiff_t digits = after - whole;
  std::ptrdiff_t places = 0;
  if (after != end && *after == '.') {
    const char* const fraction = after + 1;
    after = append_digits(fraction, end, significand);
    places = after - fraction;
    digits += places;
  }
  if (digits == 0 || digits > most_digits || significand > largest_exact) return nullptr;
  if (after != end && (*after == 'e' || *after == 'E')) return nullptr;
  const double quotient = static_cast<double>(significand) / powers_of_ten[static_cast<std::size_t>(places)];
  constexpr std::array signs{1.0, -1.0};  // a branch would be mispredicted half of the time
  number = signs[negative ? 1 : 0] * quotient;
  return after;
}

}  // namespace verisq
