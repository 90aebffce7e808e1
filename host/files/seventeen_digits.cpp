/// Exact integer arithmetic for numbers of ordinary size; fmt for the others.
#include "host/files/seventeen_digits.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

namespace verisq {
namespace {

__extension__ using Wide = unsigned __int128;

constexpr int digits = 17;
constexpr std::uint64_t smallest_with_18_digits = 100'000'000'000'000'000;
constexpr int largest_power = 55;  // 5^55 < 2^128

constexpr std::array<Wide, largest_power + 1> powers_of_five = [] {
  std::array<Wide, largest_power + 1> powers{1};
  for (std::size_t k = 1; k < powers.size(); ++k) powers[k] = 5 * powers[k - 1];
  return powers;
}();

/// An integer of 17 digits and the power of ten of the first of them.
struct Decimal {
  std::uint64_t digits;
  int exponent;
};

/// Whole part, and where the rest is: 0 none, 1 below a half, 2 a half, 3 above.
struct Quotient {
  std::uint64_t whole;
  int rest;
};

/// mantissa * power / 2^shift. Precondition: the quotient is below 2^64, 0 <= shift < 128.
Quotient scaled(std::uint64_t mantissa, Wide power, int shift) {
  // All bits of the product, in two overlapping halves: high * 2^64 + low, low below 2^64.
  const Wide first = Wide{mantissa} * static_cast<std::uint64_t>(power);
  const Wide high = Wide{mantissa} * static_cast<std::uint64_t>(power >> 64U) + (first >> 64U);
  const auto low = static_cast<std::uint64_t>(first);
  if (shift == 0) return {low, 0};
  Wide fraction{};  // the rest of the division, as a part of 2^shift
  std::uint64_t whole = 0;
  bool more = false;  // bits below those of `fraction`
  if (shift < 64) {
    whole =
        static_cast<std::uint64_t>(high << static_cast<unsigned>(64 - shift)) | (low >> static_cast<unsigned>(shift));
    fraction = low & ((std::uint64_t{1} << static_cast<unsigned>(shift)) - 1);
  } else {
    const int left = shift - 64;
    whole = static_cast<std::uint64_t>(high >> static_cast<unsigned>(left));
    fraction = high & ((Wide{1} << static_cast<unsigned>(left)) - 1);
    if (left == 0) {
      fraction = low;
      shift = 64;
    } else {
      more = low != 0;
      shift = left;
    }
  }
  const Wide half = Wide{1} << static_cast<unsigned>(shift - 1);
  if (fraction == 0 && !more) return {whole, 0};
  if (fraction < half) return {whole, 1};
  return {whole, fraction == half && !more ? 2 : 3};
}

/// Of the positive number mantissa * 2^exponent. Precondition: the power of five that it takes is in the table.
Decimal decimal_of(std::uint64_t mantissa, int exponent, int power) {
  auto [whole, rest] = scaled(mantissa, powers_of_five[static_cast<std::size_t>(power)], -(exponent + power));
  int first_digit = digits - 1 - power;
  if (whole >= smallest_with_18_digits) {  // the last digit belongs to the rest
    const std::uint64_t last = whole % 10;
    whole /= 10;
    rest = last == 5 && rest == 0 ? 2 : last >= 5 ? 3 : last > 0 || rest > 0 ? 1 : 0;
    ++first_digit;
  }
  if (rest == 3 || (rest == 2 && whole % 2 == 1)) ++whole;
  if (whole == smallest_with_18_digits) {
    whole /= 10;
    ++first_digit;
  }
  return {whole, first_digit};
}

/// In the form that "%g" chooses. Returns the end.
char* write(const Decimal& decimal, char* at) {
  std::array<char, digits> all{};
  std::to_chars(all.data(), all.data() + digits, decimal.digits);
  int count = digits;
  while (count > 1 && all[static_cast<std::size_t>(count - 1)] == '0') --count;
  const char* const from = all.data();
  const int exponent = decimal.exponent;
  if (exponent < -4 || exponent >= digits) {
    *at++ = from[0];
    if (count > 1) *at++ = '.';
    at = std::copy(from + 1, from + count, at);
    *at++ = 'e';
    *at++ = exponent < 0 ? '-' : '+';
    const int size = std::abs(exponent);  // below 100: the numbers are of ordinary size
    *at++ = static_cast<char>('0' + size / 10);
    *at++ = static_cast<char>('0' + size % 10);
    return at;
  }
  if (exponent < 0) {
    at = std::copy_n("0.0000", 1 - exponent, at);
    return std::copy(from, from + count, at);
  }
  const int whole = exponent + 1;
  at = std::copy(from, from + std::min(whole, count), at);
  if (count <= whole) return std::fill_n(at, whole - count, '0');
  *at++ = '.';
  return std::copy(from + whole, from + count, at);
}

}  // namespace

std::string_view seventeen_digits(double number, DigitBuffer& buffer) {
  constexpr int stored_bits = std::numeric_limits<double>::digits - 1;
  constexpr int bias = std::numeric_limits<double>::max_exponent - 1;
  const auto bits = std::bit_cast<std::uint64_t>(number);
  const auto biased = static_cast<int>((bits >> static_cast<unsigned>(stored_bits)) & 0x7ffU);
  const int magnitude = biased - bias;  // 2^magnitude <= |number| < 2^(magnitude + 1), unless subnormal
  // 78913 / 2^18 is log10(2) from below, closely enough for all binary64; shifted right: rounded down.
  const int decimal_magnitude = (magnitude * 78913) >> 18;
  const int power = digits - 1 - decimal_magnitude;
  // Above, the product is not divided by a power of two but multiplied.
  if (magnitude >= stored_bits || power > largest_power) {
    return {buffer.data(),
            static_cast<std::size_t>(fmt::format_to(buffer.data(), FMT_COMPILE("{:.17g}"), number) - buffer.data())};
  }
  const std::uint64_t hidden = std::uint64_t{1} << static_cast<unsigned>(stored_bits);
  const std::uint64_t mantissa = (bits & (hidden - 1)) | hidden;
  char* at = buffer.data();
  if (std::signbit(number)) *at++ = '-';
  char* const end = write(decimal_of(mantissa, magnitude - stored_bits, power), at);
  return {buffer.data(), static_cast<std::size_t>(end - buffer.data())};
}

}  // namespace verisq
