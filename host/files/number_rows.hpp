/// A text file with the same few numbers on every line, separated by commas (CSV): the lines' form and its errors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
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
};

/// A header line is optional; blank lines are fine at the end of the file only.
class NumberRows {
 public:
  /// What `kind` views must outlive this. Throws Error(input) for a file that cannot be read.
  NumberRows(const std::filesystem::path& path, const RowKind& kind);

  /// Fills `numbers` from the next line; false at the end of the file. Throws Error(input) naming file, line and value
  /// for anything but that many finite numbers a line, and for a file without rows. Precondition: as many numbers as
  /// the header has names.
  bool next(std::span<double> numbers);

  /// Throws Error(input) naming file and the line read last.
  [[noreturn]] void fail(std::string_view message) const { file_.fail(message); }

  [[nodiscard]] std::uint64_t bytes_read() const { return file_.position(); }
  [[nodiscard]] std::uint64_t bytes_total() const { return file_.size(); }

 private:
  std::optional<std::string_view> next_line();

  InputFile file_;
  RowKind kind_;
  std::vector<std::string_view> names_;
  bool at_first_line_ = true;
  bool any_row_ = false;
};

}  // namespace verisq
