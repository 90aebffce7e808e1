/// Files as text: words, numbers, and rows of numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/model.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

// Splits a line of text into words and reads them as numbers, with messages that quote the found text.

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

/// Fails at the file's position if there is another word.
void expect_end(const InputFile& file, const Words& words);

/// The nearest binary64 of a decimal number (a leading '+' is allowed). Fails at the file's position with `what` and
/// the word for any text that is not a number as a whole, for NaN, infinity and numbers beyond binary64.
[[nodiscard]] double finite_number(const InputFile& file, std::string_view word, std::string_view what);

/// The next three words as the finite numbers x, y and z.
[[nodiscard]] Point coordinates(const InputFile& file, Words& words);

/// A decimal integer. Fails at the file's position like `finite_number`.
[[nodiscard]] std::int64_t integer(const InputFile& file, std::string_view word, std::string_view what);

// Decimal numbers of few digits, as most files have them.

/// The powers of ten that binary64 represents exactly and that a short number needs.
inline constexpr std::array<double, 20> powers_of_ten{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,
                                                      1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19};

/// Appends the digits at the beginning of the text to `number`; returns the end of them.
[[nodiscard]] inline const char* append_digits(const char* at, const char* end, std::uint64_t& number) {
  for (; at != end && '0' <= *at && *at <= '9'; ++at) number = 10 * number + static_cast<std::uint64_t>(*at - '0');
  return at;
}

/// Reads the number, such as "-12.345", at the beginning of the text, like std::from_chars: returns its end. Null if it
/// has many digits or an exponent, or is no number: then nothing is decided. Correctly rounded, because it is a
/// quotient of two numbers that binary64 represents exactly.
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

// The places of the numbers on the lines of a text file, which its first line determines, and the reading of numbers
// from there.

/// The contents of a file's lines, in the words of its messages.
struct RowKind {
  std::string_view item;    ///< the item of a line: "point"
  std::string_view count;   ///< of the numbers on a line: "three"
  std::string_view header;  ///< the numbers' names, lower case: "x,y,z"
  /// Lines may be separated by blanks instead of commas, and have other fields beside the numbers.
  bool free = false;
};

/// In a file that is not `free`, fields are separated by commas, and there are only numbers. In a `free` one, fields
/// are separated by commas if the first line has one, else by blanks. The numbers are those that a header names, else
/// the first fields. Other fields are skipped; each line has as many of them as the first.
class RowForm {
 public:
  /// The texts that `kind` views must outlive this.
  explicit RowForm(const RowKind& kind);

  /// Learns from the first line; returns whether it is a header. Throws Error(input) for a header with a name twice.
  bool learn(const InputFile& file, std::string_view line);

  [[nodiscard]] const RowKind& kind() const { return kind_; }
  [[nodiscard]] std::size_t numbers() const { return names_.size(); }

  /// Reads the line at the beginning of `text`, if it is in the plainest form, and returns the text after it: the end
  /// of the line is consumed, too. Null for any other line, valid or not: `read` decides. Precondition: as many numbers
  /// as a row has.
  [[nodiscard]] const char* read_plain(std::string_view text, std::span<double> numbers) const;

  /// Reads a line, without its end. Throws Error(input) at the position of `file` for an invalid line. Precondition: as
  /// many numbers as a row has.
  void read(const InputFile& file, std::string_view line, std::span<double> numbers) const;

 private:
  /// The role of a line's field: the index of a number, or `passed_over`.
  static constexpr std::size_t passed_over = static_cast<std::size_t>(-1);

  [[nodiscard]] std::string_view without_comment_mark(std::string_view line) const;
  [[nodiscard]] std::vector<std::string_view> split(std::string_view line) const;
  [[nodiscard]] const char* after_separator(const char* at, const char* end) const;
  [[nodiscard]] const char* after_other(const char* at, const char* end) const;
  bool learn_names(const InputFile& file, std::span<const std::string_view> fields);
  [[noreturn]] void refuse(const InputFile& file, std::string_view line) const;

  RowKind kind_;
  std::vector<std::string_view> names_;
  char separator_ = ',';             // or ' ' for any blanks
  std::vector<std::size_t> fields_;  // of a line
};

// A text file with the same few numbers on every line: the file as a whole, read by all processors, and its errors.

/// A header line is optional; blank lines are fine at the end of the file only.
class NumberRows {
 public:
  /// The texts that `kind` views must outlive this.
  NumberRows(InputFile file, const RowKind& kind) : file_(std::move(file)), form_(kind) {}

  /// Fills `numbers` row by row from the front; returns the number of them, less than requested only at the end of the
  /// file. Throws Error(input) naming file, line and value for anything but rows of `kind`, and for a file without
  /// rows. Precondition: a multiple of the numbers in a row.
  std::size_t read(std::span<double> numbers);

  /// Throws Error(input) naming file and the line of the row read last.
  [[noreturn]] void fail(std::string_view message) const {
    file_.fail_at_line(file_.lines_read() - rows_left(), message);
  }

  [[nodiscard]] std::uint64_t bytes_read() const;  ///< about, for progress
  [[nodiscard]] std::uint64_t bytes_total() const { return file_.size(); }

 private:
  /// The part of a block that one processor reads, and its progress: up to the first line that needs a message.
  struct Piece {
    std::string_view lines;
    std::vector<double> numbers;  ///< room, kept from block to block,
    std::size_t count = 0;        ///< of which these were read
    std::size_t bytes = 0;        ///< of the lines that were read
  };

  bool read_more();
  bool read_line(std::string_view line);
  void read_lines(Piece& piece) const;
  [[nodiscard]] std::uint64_t rows_left() const;

  InputFile file_;
  RowForm form_;
  std::vector<Piece> pieces_;  // of the block read last
  std::size_t piece_ = 0;      // the next number is [next_] of this one
  std::size_t next_ = 0;
  std::size_t numbers_left_ = 0;   // in the pieces
  std::uint64_t block_start_ = 0;  // where they begin in the file
  std::size_t block_numbers_ = 0;
  bool at_first_line_ = true;
  bool any_row_ = false;
};

}  // namespace verisq
