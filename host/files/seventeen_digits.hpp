/// Numbers as text of 17 significant digits, which give back the same binary64: what printf writes by "%.17g".
#pragma once

#include <array>
#include <charconv>
#include <string_view>

namespace verisq {

/// Room for the longest: "-1.2345678901234567e-308".
using DigitBuffer = std::array<char, 32>;

/// The number to 17 significant digits, rounded to nearest, ties to even, without trailing zeros; "inf", "-inf", "nan".
/// A view into `buffer`.
[[nodiscard]] inline std::string_view seventeen_digits(double number, DigitBuffer& buffer) {
  const auto written =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::general, 17);
  return {buffer.data(), written.ptr};
}

}  // namespace verisq
