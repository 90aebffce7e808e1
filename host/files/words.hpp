/// Splits a line of text into words and reads them as numbers, with messages that quote what was found.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <verisq/model.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

/// Removes blanks (space, tab, carriage return, vertical tab, form feed) from both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The blank-separated words of one line, front to back. Views into the line.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(trimmed(line)) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  [[nodiscard]] std::string_view rest() const { return rest_; }

  /// The next word; empty at the end.
  std::string_view next();

 private:
  std::string_view rest_;
};

/// ASCII lower case, for keywords and extensions.
[[nodiscard]] std::string lower_case(std::string_view text);

/// The text with everything but printable ASCII escaped as \xNN: safe in a one-line message.
[[nodiscard]] std::string printable(std::string_view text);

/// The printable text between single quotes, shortened.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// Fails at the file's position where there is another word.
void expect_end(const InputFile& file, const Words& words);

/// The nearest binary64 of a decimal number (a leading '+' is fine). Fails at the file's position with `what` and the
/// word for anything that is not a number as a whole, for NaN, infinity and numbers beyond binary64.
[[nodiscard]] double finite_number(const InputFile& file, std::string_view word, std::string_view what);

/// The next three words as the finite numbers x, y and z.
[[nodiscard]] Point coordinates(const InputFile& file, Words& words);

/// A decimal integer. Fails at the file's position like `finite_number`.
[[nodiscard]] std::int64_t integer(const InputFile& file, std::string_view word, std::string_view what);

}  // namespace verisq
