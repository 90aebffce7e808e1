/// Files as bytes: read once, front to back, in large blocks; numbers of a stated byte order, SHA-256, links.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace verisq {

// A file read once, front to back, in large blocks: by lines or by bytes, always with a known position.

/// Throws Error(input) that begins with the file's name.
[[noreturn]] void refuse_file(std::string_view name, std::string_view message);

/// Memory stays at one block (no larger than the file, grown to the longest line), for files of any size. Not
/// memory-mapped: a file that shrinks while it is read must cause a message, not a signal.
class InputFile {
 public:
  /// The limit of a line's length: a binary file that is read as text ends in a message instead of using up memory.
  static constexpr std::size_t longest_line = std::size_t{1} << 24;

  /// Throws Error(input) when the file is missing, a directory, unreadable or empty.
  explicit InputFile(const std::filesystem::path& path);

  /// A file of this name whose bytes were read before. Throws the same error if there are none.
  InputFile(std::string name, std::string_view bytes);

  /// The rest of the standard input. Throws the same error.
  [[nodiscard]] static InputFile standard_input();

  /// The name in messages.
  [[nodiscard]] const std::string& name() const { return name_; }

  [[nodiscard]] std::uint64_t size() const { return size_; }  ///< in bytes; 0 when not known (a pipe)
  [[nodiscard]] std::uint64_t position() const { return block_start_ + next_; }  ///< bytes consumed
  [[nodiscard]] std::uint64_t remaining() const { return size_ < position() ? 0 : size_ - position(); }

  /// Begins to read text: passes over the byte order mark of UTF-8 where the file begins with one. Throws Error(input)
  /// for text in UTF-16 or UTF-32. The functions that read lines or text begin by it.
  void begin_text();

  /// The next line without its end ("\n" or "\r\n"); valid until the next call. Nothing at the end of the file.
  std::optional<std::string_view> next_line();

  /// Returns whether the line read last has an end: only the last line of a file may have none.
  [[nodiscard]] bool line_has_end() const { return line_has_end_; }

  /// The next line with more than blanks.
  std::optional<std::string_view> next_line_with_text();

  /// Whole lines from the front of the unread part, as many as a block can have and at least one, without consuming
  /// them. Valid until the next call. Nothing at the end of the file. Fails if `next_line` would fail for the first of
  /// them.
  std::string_view peek_lines();

  /// Consumes `count` lines, which are the first `bytes` of those that `peek_lines` returned last.
  void pass_lines(std::size_t bytes, std::uint64_t count);

  /// The number of consumed lines.
  [[nodiscard]] std::uint64_t lines_read() const { return line_number_; }

  /// The next `count` bytes; valid until the next call. `what` names them in the message if the file ends before.
  std::string_view take(std::size_t count, std::string_view what);

  /// At most `count` bytes from the front of the unread part, without consuming them.
  std::string_view peek(std::size_t count);

  /// The same for a text.
  std::string_view peek_text(std::size_t count);

  /// True if nothing is left but a line end, which some writers put behind binary data.
  [[nodiscard]] bool is_at_end() {
    const std::string_view rest = peek(3);
    return rest.empty() || rest == "\n" || rest == "\r\n";
  }

  /// Goes on at `position`. Precondition: a file of known size that is no standard input.
  void go_to(std::uint64_t position);

  /// Throws Error(input): "FILE: line N: message" or "FILE: byte N: message", at the line or bytes read last.
  [[noreturn]] void fail(std::string_view message) const;

  /// Throws Error(input): "FILE: line N: message".
  [[noreturn]] void fail_at_line(std::uint64_t line, std::string_view message) const;

  /// Throws Error(input): "FILE: message", for errors that concern the file as a whole.
  [[noreturn]] void fail_whole(std::string_view message) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  enum class Unit { nothing, line, bytes };

  explicit InputFile(std::string name) : name_(std::move(name)) {}

  void begin();
  bool read_more();
  [[nodiscard]] std::string_view unread() const { return {buffer_.data() + next_, end_ - next_}; }

  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;  ///< null: all bytes are in the buffer
  std::uint64_t size_ = 0;
  std::vector<char> buffer_;
  std::size_t next_ = 0;  // unread bytes are [next_, end_) of the buffer
  std::size_t end_ = 0;
  std::uint64_t block_start_ = 0;  // position in the file of the buffer's first byte
  std::uint64_t line_number_ = 0;  // of the line read last, from 1
  bool line_has_end_ = false;
  bool text_has_begun_ = false;
  std::uint64_t bytes_start_ = 0;  // of the bytes taken last, from 0
  Unit last_read_ = Unit::nothing;
};

// The target of an output's name.

/// Resolves all symbolic links, whether the file exists or not. Precondition: they do not form a circle.
[[nodiscard]] std::filesystem::path through_links(std::filesystem::path name);

// Numbers from and to bytes of a stated order, whatever the order of this machine.

template <class Number>
requires std::is_arithmetic_v<Number>
[[nodiscard]] Number reversed_bytes(Number value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(Number)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Number>(bytes);
}

/// The number stored in `order` at `bytes`, which need not be aligned.
template <class Number>
[[nodiscard]] Number number_from(const char* bytes, std::endian order) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return order == std::endian::native ? value : reversed_bytes(value);
}

enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

[[nodiscard]] constexpr std::size_t size_of(NumberType type) {
  constexpr std::array<std::size_t, 10> sizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

[[nodiscard]] constexpr bool is_integer(NumberType type) {
  return type != NumberType::float32 && type != NumberType::float64;
}

/// The number of that type at `bytes`, converted. Exact for double from all types but integers of 64 bits, and for
/// std::int64_t from all integers but those from 2^63 on, which become negative. Precondition: one of these two.
template <class Number>
[[nodiscard]] Number converted_from(const char* bytes, NumberType type, std::endian order) {
  switch (type) {
    case NumberType::int8: return static_cast<Number>(number_from<std::int8_t>(bytes, order));
    case NumberType::uint8: return static_cast<Number>(number_from<std::uint8_t>(bytes, order));
    case NumberType::int16: return static_cast<Number>(number_from<std::int16_t>(bytes, order));
    case NumberType::uint16: return static_cast<Number>(number_from<std::uint16_t>(bytes, order));
    case NumberType::int32: return static_cast<Number>(number_from<std::int32_t>(bytes, order));
    case NumberType::uint32: return static_cast<Number>(number_from<std::uint32_t>(bytes, order));
    case NumberType::int64: return static_cast<Number>(number_from<std::int64_t>(bytes, order));
    case NumberType::uint64: return static_cast<Number>(number_from<std::uint64_t>(bytes, order));
    case NumberType::float32: return static_cast<Number>(number_from<float>(bytes, order));
    case NumberType::float64: break;
  }
  return static_cast<Number>(number_from<double>(bytes, order));
}

/// The value whose bytes on this machine are those of `value` in little-endian order.
template <class Number>
[[nodiscard]] Number in_little_endian(Number value) {
  return std::endian::native == std::endian::little ? value : reversed_bytes(value);
}

/// Deflate codes at most 258 bytes by two bits (RFC 1951, section 3.2.5): zlib's manual says 1032:1.
inline constexpr std::uint64_t most_unpacked_of_one = 1032;

// SHA-256 (FIPS 180-4): people and certificates identify by it the file that an answer is about.

/// Own code and no library: a program that checks certificates would otherwise be linked to one that is twenty times
/// its size. No proof rests on it: proofs are about the model that was read, whatever its digest.
class Sha256 {
 public:
  /// Takes the next bytes.
  void add(std::span<const std::byte> bytes);

  /// The digest of all bytes so far, 64 hexadecimal digits in small letters. Nothing may be added after it.
  [[nodiscard]] std::string digest();

 private:
  static constexpr std::size_t block_size = 64;

  void take_block();

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, block_size> block_{};
  std::uint64_t bytes_ = 0;
};

/// The digest of all these bytes.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace verisq
