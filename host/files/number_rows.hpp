/// A text file with the same few numbers on every line: the file as a whole, read by all processors, and its errors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "host/files/input_file.hpp"
#include "host/files/row_form.hpp"

namespace verisq {

/// A header line is optional; blank lines are fine at the end of the file only.
class NumberRows {
 public:
  /// What `kind` views must outlive this.
  NumberRows(InputFile file, const RowKind& kind) : file_(std::move(file)), form_(kind) {}

  /// Fills `numbers` row by row from the front; returns how many of them, fewer than asked only at the end of the file.
  /// Throws Error(input) naming file, line and value for anything but rows of `kind`, and for a file without rows.
  /// Precondition: a multiple of the numbers in a row.
  std::size_t read(std::span<double> numbers);

  /// Throws Error(input) naming file and the line of the row read last.
  [[noreturn]] void fail(std::string_view message) const {
    file_.fail_at_line(file_.lines_read() - rows_left(), message);
  }

  [[nodiscard]] std::uint64_t bytes_read() const;  ///< about, for progress
  [[nodiscard]] std::uint64_t bytes_total() const { return file_.size(); }

 private:
  /// What one processor reads of a block, and how far it came: to the first line that needs a message.
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
