/// Numbers as the shortest text that gives back the same binary64.
#pragma once

#include <cstddef>

namespace verisq {

/// Room for the longest: "-2.2250738585072014e-308".
inline constexpr std::size_t most_shortest_digits = 24;

/// Writes the number from `at` on, or "inf", "-inf", "nan"; returns the end of it. Precondition: room for
/// `most_shortest_digits`.
[[nodiscard]] char* put_shortest_digits(double number, char* at);

}  // namespace verisq
