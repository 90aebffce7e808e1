/// Errors that the caller can correct end the work in one line; foreign texts in it are quoted.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <verisq/error.hpp>

namespace verisq {

// Foreign texts within the program's own sentences: in quotation marks, on one line, never longer than a name.
//
// Files are made by others, and so are names in them and of them. Printed as they stand, a line break or an escape
// would begin a sentence of its own, blanks would push the truth away, and signs that print from right to left would
// turn numbers round. Everything that prints such a text, or puts it into a message, calls `quotation`.

/// The largest number of columns that a quoted text takes, without its marks.
constexpr std::size_t longest_quotation = 60;

/// The text between marks, "stem". Only signs that print from left to right, in a place of their own, are shown
/// unchanged. These are ASCII and the letters and digits of Latin, Greek, Cyrillic, Japanese, Chinese and Korean
/// script, with at most two accents each, and single blanks between them. All else is escaped: \x1b (a byte), \u{202e}
/// (a character), \" and \\. A text that takes more than `longest_quotation` columns keeps its two ends, with an
/// ellipsis between.
[[nodiscard]] std::string quotation(std::string_view text, char mark = '"');

/// Several texts, with commas between: at most eight, and the number of the others.
[[nodiscard]] std::string quotation(std::span<const std::string> texts);

/// True where `quotation` shows the text as it is.
[[nodiscard]] bool is_plain(std::string_view text);

/// A sentence that contains foreign texts already, quoted or not. All signs that `quotation` escapes are escaped here,
/// but for marks, backslashes and blanks, and up to some thousand columns. The last guard before a terminal.
[[nodiscard]] std::string on_one_line(std::string_view sentence);

/// The text behind a number: empty if units are not given, " mm" if they are units of length, else their text in
/// quotation marks; " mm^3" for the third power.
[[nodiscard]] std::string units_behind(std::string_view units, int power = 1);

// Errors that the caller can correct end the work in one line.

/// Throws Error(input).
[[noreturn]] inline void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

}  // namespace verisq
