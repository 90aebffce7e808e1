/// A file read once, front to back, in large blocks: by lines or by bytes, always able to say where it stands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace verisq {

/// Throws Error(input) that begins with the file's name.
[[noreturn]] void refuse_file(std::string_view name, std::string_view message);

/// Memory stays at one block (no larger than the file, grown to the longest line), whatever the size of the file. Not
/// memory-mapped: a file that shrinks while it is read must end in a message, not in a signal.
class InputFile {
 public:
  /// No line may be longer: a binary file taken for text ends in a message, not in memory.
  static constexpr std::size_t longest_line = std::size_t{1} << 24;

  /// Throws Error(input) when the file is missing, a directory, unreadable or empty.
  explicit InputFile(const std::filesystem::path& path);

  /// What is left of the standard input. Throws likewise.
  [[nodiscard]] static InputFile standard_input();

  /// As messages call it.
  [[nodiscard]] const std::string& name() const { return name_; }

  [[nodiscard]] std::uint64_t size() const { return size_; }  ///< in bytes; 0 when not known (a pipe)
  [[nodiscard]] std::uint64_t position() const { return block_start_ + next_; }  ///< bytes consumed
  [[nodiscard]] std::uint64_t remaining() const { return size_ < position() ? 0 : size_ - position(); }

  /// The next line without its end ("\n" or "\r\n"); valid until the next call. Nothing at the end of the file.
  std::optional<std::string_view> next_line();

  /// Whether the line read last has an end: only the last line of a file may have none.
  [[nodiscard]] bool line_has_end() const { return line_has_end_; }

  /// The next line that holds more than blanks.
  std::optional<std::string_view> next_line_with_text();

  /// Whole lines from the front of what is unread, as many as a block holds and at least one, without consuming them;
  /// valid until the next call. Nothing at the end of the file. Where `next_line` would fail for the first of them, so
  /// does this.
  std::string_view peek_lines();

  /// Consumes `count` lines, which are the first `bytes` of those that `peek_lines` returned last.
  void pass_lines(std::size_t bytes, std::uint64_t count);

  /// How many lines have been consumed.
  [[nodiscard]] std::uint64_t lines_read() const { return line_number_; }

  /// The next `count` bytes; valid until the next call. `what` names them in the message when the file ends before.
  std::string_view take(std::size_t count, std::string_view what);

  /// At most `count` bytes from the front of what is unread, without consuming them.
  std::string_view peek(std::size_t count);

  /// Goes on at `position`. Precondition: a file of known size that is no standard input.
  void go_to(std::uint64_t position);

  /// Throws Error(input): "FILE: line N: message" or "FILE: byte N: message", at the line or bytes read last.
  [[noreturn]] void fail(std::string_view message) const;

  /// Throws Error(input): "FILE: line N: message".
  [[noreturn]] void fail_at_line(std::uint64_t line, std::string_view message) const;

  /// Throws Error(input): "FILE: message", for what concerns the file as a whole.
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
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
  std::vector<char> buffer_;
  std::size_t next_ = 0;  // unread bytes are [next_, end_) of the buffer
  std::size_t end_ = 0;
  std::uint64_t block_start_ = 0;  // position in the file of the buffer's first byte
  std::uint64_t line_number_ = 0;  // of the line read last, from 1
  bool line_has_end_ = false;
  std::uint64_t bytes_start_ = 0;  // of the bytes taken last, from 0
  Unit last_read_ = Unit::nothing;
};

}  // namespace verisq
