/// A file that appears under its name only when it is complete.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "host/files/input_file.hpp"

namespace verisq {

/// Writes to a temporary file beside the target, which `finish` renames to the target (replacing an older file, whose
/// permissions it takes over). The target is the file to which `name` leads, through any symbolic links. The destructor
/// removes an unfinished file; a run that is killed leaves it as TARGET.1a2b3c4d.partial, with other digits for every
/// run. An existing target that is no regular file (a pipe, a terminal, /dev/null) cannot be replaced: it is written to
/// directly. All members throw Error(failure) that gives the name and the reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path name);
  /// The standard output, written to directly whatever it is.
  [[nodiscard]] static OutputFile standard_output() { return OutputFile(); }
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);

  /// The numbers' bytes in little-endian order.
  template <class Number>
  void write_little_endian(std::span<const Number> numbers);

  /// Writes out the buffer: from then on its bytes outlive even a killed process.
  void flush();

  /// Returns whether `write_at` may be called: not for a target that is written to directly.
  [[nodiscard]] bool can_be_rewritten() const { return !temporary_.empty(); }

  /// Writes at `position` of the file, independently of `write`; before, `flush` must have written the bytes there.
  void write_at(std::uint64_t position, std::string_view bytes);
  template <class Number>
  void write_little_endian_at(std::uint64_t position, std::span<const Number> numbers);

  void finish();
  /// Keeps a part under the target's name with `.partial` added; returns that name. A target that is written to
  /// directly stays where it is.
  [[nodiscard]] std::filesystem::path finish_as_partial();

  /// Throws Error(failure): "NAME: cannot be written: reason".
  [[noreturn]] void fail(std::string_view reason) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  OutputFile();

  void open(const std::filesystem::path& path, const char* mode);
  void close();
  void rename_to(const std::filesystem::path& path);
  [[noreturn]] void fail_by_errno() const;

  std::filesystem::path name_;       // as given: what messages speak of
  std::filesystem::path target_;     // where it leads to; empty for the standard output
  std::filesystem::path temporary_;  // empty when nothing is to be renamed or removed
  std::vector<char> buffer_;         // outlives file_, which writes through it
  std::unique_ptr<std::FILE, Close> file_;
};

/// The numbers' bytes in little-endian order; `swapped` stores them if this machine has another order.
template <class Number>
[[nodiscard]] std::string_view little_endian_bytes(std::span<const Number> numbers, std::vector<Number>& swapped) {
  if constexpr (std::endian::native != std::endian::little) {
    swapped.resize(numbers.size());
    std::ranges::transform(numbers, swapped.begin(), in_little_endian<Number>);
    numbers = swapped;
  }
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

template <class Number>
void OutputFile::write_little_endian(std::span<const Number> numbers) {
  std::vector<Number> swapped;
  write(little_endian_bytes(numbers, swapped));
}

template <class Number>
void OutputFile::write_little_endian_at(std::uint64_t position, std::span<const Number> numbers) {
  std::vector<Number> swapped;
  write_at(position, little_endian_bytes(numbers, swapped));
}

}  // namespace verisq
