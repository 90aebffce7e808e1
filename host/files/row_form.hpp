/// Where on the lines of a text file the numbers stand, which its first line says, and how they are read from there.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "host/files/input_file.hpp"

namespace verisq {

/// What the lines of a file hold, in the words of its messages.
struct RowKind {
  std::string_view item;    ///< what a line describes: "point"
  std::string_view count;   ///< of the numbers on a line: "three"
  std::string_view header;  ///< the numbers' names, lower case: "x,y,z"
  /// Lines may be separated by blanks instead of commas, and have other fields beside the numbers.
  bool free = false;
};

/// Of a file that is not `free`: fields are separated by commas, numbers are all there is. Of one that is: by commas if
/// the first line has one, else by blanks; the numbers are those that a header names, else the first fields; other
/// fields are passed over, of which each line has as many as the first.
class RowForm {
 public:
  /// What `kind` views must outlive this.
  explicit RowForm(const RowKind& kind);

  /// Learns from the first line; returns whether it is a header. Throws Error(input) for a header with a name twice.
  bool learn(const InputFile& file, std::string_view line);

  [[nodiscard]] const RowKind& kind() const { return kind_; }
  [[nodiscard]] std::size_t numbers() const { return names_.size(); }

  /// Reads the line that `text` begins with, if it is in the plainest form, and returns the text after it: the end of
  /// the line is consumed, too. Null for any other line, be it sound or not: `read` knows. Precondition: as
  /// many numbers as a row has.
  [[nodiscard]] const char* read_plain(std::string_view text, std::span<double> numbers) const;

  /// Reads a line, without its end. Throws Error(input) at the position of `file` for what is not as it should be.
  /// Precondition: as many numbers as a row has.
  void read(const InputFile& file, std::string_view line, std::span<double> numbers) const;

 private:
  /// What a field of a line is: the index of a number, or `passed_over`.
  static constexpr std::size_t passed_over = static_cast<std::size_t>(-1);

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

}  // namespace verisq
