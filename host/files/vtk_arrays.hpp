/// The parts of VTK's files: text among bytes, arrays of numbers in every encoding, points and cells.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "host/files/input_file.hpp"
#include "host/files/mesh_file.hpp"

namespace verisq {

// Text among bytes: all of it is taken as bytes, so that every message can name one.

inline constexpr std::string_view blanks_and_ends = " \t\r\n\v\f";  ///< the ends of lines are blanks, too

[[nodiscard]] bool is_blank(std::string_view text);

void pass_blanks(InputFile& file);

/// Up to a blank or a tag; empty at a tag and at the end of the file. Valid until the file is read again.
[[nodiscard]] std::string_view next_word(InputFile& file);

/// The rest of the line, with its end. Fails at the end of the file.
std::string_view take_line(InputFile& file, std::string_view what);

/// `word` as a number that is not negative.
[[nodiscard]] std::uint64_t count_from(const InputFile& file, std::string_view word, std::string_view what);

// Arrays of numbers: text, or bytes that may be packed by zlib and coded as letters.

struct Coding {
  std::endian order = std::endian::little;
  bool base64 = false;
  bool packed = false;
  NumberType header = NumberType::uint32;  ///< the numbers before an array in XML: its size, or those of its blocks
};

/// Bytes as they are in the file, or decoded from letters (RFC 4648, section 4). Padding may stand anywhere: some
/// writers code the header of an array and its data as one text, others as two.
class FileBytes {
 public:
  FileBytes(InputFile& file, bool base64) : file_(file), base64_(base64) {}

  void read(std::span<char> bytes, std::string_view what);

  /// No more bytes than these are left.
  [[nodiscard]] std::uint64_t most() const { return file_.remaining() + waiting_; }

 private:
  void decode(std::string_view what);

  InputFile& file_;
  bool base64_;
  std::uint32_t group_ = 0;  // decoded; not yet read are its last
  std::size_t waiting_ = 0;  // so many bytes
};

/// The bytes of an array, from where the file stands. Every failure is an Error(input) that begins with `what`.
class ArrayBytes {
 public:
  ArrayBytes(InputFile& file, const Coding& coding) : file_(file), coding_(coding), source_(file, coding.base64) {}

  /// Reads the header of an array in XML, which must announce `tuples` times `size` bytes.
  void begin(std::uint64_t tuples, std::size_t size, std::string_view what);

  /// Fills `bytes` with the next ones.
  void read(std::span<char> bytes, std::string_view what);

 private:
  std::uint64_t header_number(std::string_view what);
  std::uint64_t blocks_header(std::string_view what);
  void unpack(std::string_view what);

  InputFile& file_;
  Coding coding_;
  FileBytes source_;
  std::vector<std::uint64_t> packed_sizes_;
  std::uint64_t full_size_ = 0;
  std::uint64_t last_size_ = 0;
  std::size_t blocks_read_ = 0;
  std::vector<char> packed_;  // the block read last,
  std::vector<char> block_;   // unpacked,
  std::size_t next_ = 0;      // of which this byte is next
};

/// The numbers of an array, front to back.
class Numbers {
 public:
  /// As text.
  explicit Numbers(InputFile& file) : file_(file) {}
  /// As bytes of this type.
  Numbers(InputFile& file, NumberType type, const Coding& coding)
      : file_(file), type_(type), order_(coding.order), bytes_(std::in_place, file, coding) {}

  /// Reads the header of an array in XML; text has none.
  void begin(std::uint64_t tuples, std::size_t components, std::string_view what) {
    if (bytes_) bytes_->begin(tuples, components * size_of(type_), what);
  }

  /// Precondition: of text, or of floating-point numbers.
  double finite(std::string_view what);
  /// Precondition: of text, or of integers.
  std::int64_t whole(std::string_view what);
  void pass(std::uint64_t count, std::string_view what);

 private:
  template <class Number>
  Number next(std::string_view what);

  InputFile& file_;
  NumberType type_ = NumberType::float64;
  std::endian order_ = std::endian::native;
  std::optional<ArrayBytes> bytes_;  // none: text
};

// The points and cells of PolyData.

void read_points(Numbers& numbers, std::uint64_t count, MeshBuilder& builder);

/// Faces of one kind. The indices of their corners are counted from the vertex `first`.
class Cells {
 public:
  enum class Kind { polygons, strips };

  Cells(const InputFile& file, MeshBuilder& builder, Kind kind, std::size_t first)
      : file_(file), builder_(builder), kind_(kind), first_(first) {}

  /// For each of `count` cells the number of corners up to its end.
  [[nodiscard]] std::vector<std::int64_t> read_ends(Numbers& numbers, std::uint64_t count) const;

  void read_cells(Numbers& connectivity, std::span<const std::int64_t> ends);
  void read_cell(Numbers& connectivity, std::int64_t corners);

 private:
  const InputFile& file_;
  MeshBuilder& builder_;
  Kind kind_;
  std::size_t first_;
  std::vector<std::uint32_t> corners_;  // of the cell read last
};

}  // namespace verisq
