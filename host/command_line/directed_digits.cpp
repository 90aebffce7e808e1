/// MPFR's formatted output, which rounds in a given direction.
#include "host/command_line/directed_digits.hpp"

#include <fmt/format.h>
// After <cstdio>, which makes MPFR declare its formatted output.
#include <mpfr.h>

#include <array>

namespace verisq::command_line {
namespace {

std::string formatted(const char* format, int digits, double x) {
  mpfr_t number;
  mpfr_init2(number, 53);
  mpfr_set_d(number, x + 0.0, MPFR_RNDN);  // -0 + 0 is 0
  std::array<char, 64> text{};
  mpfr_snprintf(text.data(), text.size(), format, digits, number);
  mpfr_clear(number);
  return text.data();
}

}  // namespace

std::string outward_digits(const Enclosure& enclosure, int digits) {
  const std::string lower = lower_digits(enclosure.lo, digits);
  const std::string upper = upper_digits(enclosure.hi, digits);
  return lower == upper ? lower : fmt::format("[{}, {}]", lower, upper);
}

std::string lower_digits(double x, int digits) {
  return formatted("%.*RDg", digits, x);
}

std::string upper_digits(double x, int digits) {
  return formatted("%.*RUg", digits, x);
}

}  // namespace verisq::command_line
