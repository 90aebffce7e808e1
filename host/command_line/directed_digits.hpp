/// Decimal digits of enclosures, rounded outward: what is printed contains what is proven.
#pragma once

#include <string>
#include <verisq/enclosure.hpp>

namespace verisq::command_line {

/// "[lo, hi]", so many significant digits each, lo rounded down and hi up; a single number where they hold it.
[[nodiscard]] std::string outward_digits(const Enclosure& enclosure, int digits = 10);

/// Significant digits of a number that is no larger.
[[nodiscard]] std::string lower_digits(double x, int digits = 10);

/// Significant digits of a number that is no smaller.
[[nodiscard]] std::string upper_digits(double x, int digits = 10);

}  // namespace verisq::command_line
