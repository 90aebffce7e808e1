/// A file that appears under its name only when it is complete.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "host/files/byte_order.hpp"

namespace verisq {

/// Writes to a temporary file beside the target, which `finish` renames to the target (replacing an older file). The
/// destructor removes what is unfinished. All members throw Error(failure) naming the target and the reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);

  /// The numbers' bytes in little-endian order.
  template <class Number>
  void write_little_endian(std::span<const Number> numbers);

  void finish() { finish_as(target_); }
  /// Under another name than the target's.
  void finish_as(const std::filesystem::path& name);

  /// Throws Error(failure): "TARGET: cannot be written: reason".
  [[noreturn]] void fail(std::string_view reason) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  [[noreturn]] void fail_by_errno() const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::vector<char> buffer_;  // outlives file_, which writes through it
  std::unique_ptr<std::FILE, Close> file_;
};

template <class Number>
void OutputFile::write_little_endian(std::span<const Number> numbers) {
  if constexpr (std::endian::native == std::endian::little) {
    write({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});
  } else {
    for (const Number number : numbers) {
      const Number swapped = in_little_endian(number);
      write({reinterpret_cast<const char*>(&swapped), sizeof swapped});
    }
  }
}

}  // namespace verisq
