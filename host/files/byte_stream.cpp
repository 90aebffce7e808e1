/// zlib is handed blocks of the file; members of gzip may follow each other (RFC 1952, section 2.2).
#include "host/files/byte_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "host/files/words.hpp"

namespace verisq {
namespace {

constexpr std::size_t block = std::size_t{1} << 16;
constexpr int gzip_only = 16 + MAX_WBITS;

/// Deflate codes at most 258 bytes by two bits (RFC 1951, section 3.2.5): zlib's manual says 1032:1.
constexpr std::uint64_t most_bytes_of_one = 1032;

}  // namespace

ByteStream::ByteStream(InputFile& file, Packing packing)
    : file_(file), packing_(packing), packed_size_(file.remaining()) {
  if (packing_ == Packing::gzip && inflateInit2(&zlib_, gzip_only) != Z_OK) throw std::bad_alloc();
}

ByteStream::~ByteStream() {
  if (packing_ == Packing::gzip) inflateEnd(&zlib_);
}

std::uint64_t ByteStream::most_bytes() const {
  return packing_ == Packing::none ? packed_size_ : most_bytes_of_one * packed_size_;
}

void ByteStream::next_member() {
  if (inflateReset(&zlib_) != Z_OK) file_.fail_whole("cannot be unpacked");
  between_members_ = false;
}

std::size_t ByteStream::unpack(std::span<char> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const std::string_view packed = file_.peek(block);
    if (packed.empty()) {
      if (!between_members_) file_.fail_whole("truncated: the file ends inside its gzip data");
      break;
    }
    if (between_members_) next_member();
    const std::size_t room = std::min(bytes.size() - done, block);
    // zlib reads through a pointer that is not const, and does not write there.
    zlib_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    zlib_.avail_in = static_cast<uInt>(packed.size());
    zlib_.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
    zlib_.avail_out = static_cast<uInt>(room);
    const int outcome = inflate(&zlib_, Z_NO_FLUSH);
    if (outcome != Z_OK && outcome != Z_STREAM_END) {
      const char* why = zlib_.msg != nullptr ? zlib_.msg : "data are missing";
      file_.fail_whole(fmt::format("gzip data near byte {}: {}", file_.position(), printable(why)));
    }
    between_members_ = outcome == Z_STREAM_END;
    (void)file_.take(packed.size() - zlib_.avail_in, "gzip data");
    done += room - zlib_.avail_out;
  }
  return done;
}

void ByteStream::read(std::span<char> bytes, std::string_view what) {
  if (packing_ == Packing::none) {
    for (std::size_t done = 0; done < bytes.size(); done += std::min(block, bytes.size() - done)) {
      const auto part = bytes.subspan(done, std::min(block, bytes.size() - done));
      std::ranges::copy(file_.take(part.size(), what), part.begin());
    }
    return;
  }
  const std::size_t unpacked = unpack(bytes);
  if (unpacked < bytes.size())
    file_.fail_whole(
        fmt::format("truncated: its gzip data end {} bytes early, inside {}", bytes.size() - unpacked, what));
}

void ByteStream::expect_end(std::string_view what) {
  const bool more = packing_ == Packing::none ? !file_.peek(1).empty() : [&] {
    char byte = 0;
    return unpack({&byte, 1}) > 0;
  }();
  if (more) file_.fail_whole(fmt::format("there are more bytes after {}", what));
}

}  // namespace verisq
