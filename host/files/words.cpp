/// Words and numbers of text files; numbers by std::from_chars: correctly rounded, no locale.
#include "host/files/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace verisq {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return plus ? word.substr(1) : word;
}

/// from_chars leaves the value alone both for 1e999 and for 1e-999. The nearest binary64 of the latter is zero; the
/// wider range of long double tells them apart. Nothing when even that does not suffice.
std::optional<double> underflowed(std::string_view word) {
  long double wide = 1.0L;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), wide);
  if (error != std::errc{} || std::abs(wide) >= 1.0L) return std::nullopt;
  return std::copysign(0.0, static_cast<double>(wide));
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view Words::next() {
  const std::size_t length = std::min(rest_.find_first_of(blanks), rest_.size());
  const std::string_view word = rest_.substr(0, length);
  rest_.remove_prefix(length);
  rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
  return word;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return result;
}

std::string printable(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code >= 0x7f) {
      result += fmt::format("\\x{:02x}", code);
    } else {
      result += c;
    }
  }
  return result;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  return fmt::format("'{}{}'", printable(text.substr(0, longest)), text.size() > longest ? "..." : "");
}

void expect_end(const InputFile& file, const Words& words) {
  if (!words.empty()) file.fail(fmt::format("unexpected {}", in_quotes(words.rest())));
}

double finite_number(const InputFile& file, std::string_view word, std::string_view what) {
  const std::string_view digits = without_plus(word);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole_word = end == digits.data() + digits.size();
  if (error == std::errc{} && whole_word && std::isfinite(value)) return value;
  if (word.empty()) file.fail(fmt::format("{} is missing", what));
  if (error == std::errc::invalid_argument || !whole_word) {
    file.fail(fmt::format("{} = {}: not a number", what, in_quotes(word)));
  }
  if (error == std::errc::result_out_of_range) {
    if (const std::optional<double> zero = underflowed(digits)) return *zero;
    file.fail(fmt::format("{} = {}: beyond the range of binary64", what, in_quotes(word)));
  }
  file.fail(fmt::format("{} = {}: not a finite number", what, in_quotes(word)));
}

Point coordinates(const InputFile& file, Words& words) {
  const double x = finite_number(file, words.next(), "x");
  const double y = finite_number(file, words.next(), "y");
  const double z = finite_number(file, words.next(), "z");
  return {x, y, z};
}

std::int64_t integer(const InputFile& file, std::string_view word, std::string_view what) {
  const std::string_view digits = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc{} && end == digits.data() + digits.size()) return value;
  if (word.empty()) file.fail(fmt::format("{} is missing", what));
  file.fail(fmt::format("{} = {}: not an integer", what, in_quotes(word)));
}

}  // namespace verisq
