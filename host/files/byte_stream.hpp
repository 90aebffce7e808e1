/// The bytes of a file from where it stands, as they are or unpacked by zlib.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <span>
#include <string_view>

#include "host/files/input_file.hpp"

namespace verisq {

class ByteStream {
 public:
  enum class Packing { none, gzip };

  /// `file`, which must outlive the stream, has a known size.
  ByteStream(InputFile& file, Packing packing);
  ~ByteStream();
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// No file can unpack to more: a wrong header must not ask for all memory.
  [[nodiscard]] std::uint64_t most_bytes() const;

  /// Fills `bytes`. Throws Error(input) where the file ends before, inside `what`, or cannot be unpacked.
  void read(std::span<char> bytes, std::string_view what);

  /// Throws Error(input) where there are more bytes.
  void expect_end(std::string_view what);

 private:
  /// As many bytes as there are, at most `bytes.size()`.
  std::size_t unpack(std::span<char> bytes);
  void next_member();

  InputFile& file_;
  Packing packing_;
  std::uint64_t packed_size_;
  z_stream zlib_{};
  bool between_members_ = true;
};

}  // namespace verisq
