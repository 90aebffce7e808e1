/// This file implements input_file.hpp.
#include "host/files/input_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <span>
#include <system_error>
#include <verisq/error.hpp>

#include "host/errors/refusal.hpp"

namespace verisq {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 20;

/// For a file of known size its size is enough, and one byte by which a single read finds its end.
std::size_t first_block(std::uint64_t size) {
  return size == 0 ? block_size : std::min<std::uint64_t>(block_size, size + 1);
}

constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";

/// The first bytes of git's placeholder for a large file that was not fetched.
constexpr std::string_view git_lfs_pointer = "version https://git-lfs.github.com/spec/";

/// Returns whether in all units of `bytes` bytes only the byte at `place` is not zero: ASCII characters, in UTF-16 and
/// UTF-32.
bool is_ascii_in_units(std::string_view start, std::size_t bytes, std::size_t place) {
  for (std::size_t k = 0; k < start.size(); ++k) {
    if ((start[k] != '\0') != (k % bytes == place)) return false;
  }
  return start.size() >= 2 * bytes;
}

/// The encoding of Unicode of a file that is not in UTF-8, by its byte order mark. Without a mark it is found by the
/// zero bytes of ASCII characters, of which a text has some at its beginning. Empty if it is none.
std::string_view wide_encoding(std::string_view start) {
  using std::string_view_literals::operator""sv;
  if (start.starts_with("\xFF\xFE\0\0"sv)) return "UTF-32 (little-endian)";
  if (start.starts_with("\0\0\xFE\xFF"sv)) return "UTF-32 (big-endian)";
  if (start.starts_with("\xFF\xFE")) return "UTF-16 (little-endian)";
  if (start.starts_with("\xFE\xFF")) return "UTF-16 (big-endian)";
  start = start.substr(0, start.size() / 4 * 4);
  if (is_ascii_in_units(start, 4, 0)) return "UTF-32 (little-endian)";
  if (is_ascii_in_units(start, 4, 3)) return "UTF-32 (big-endian)";
  if (is_ascii_in_units(start, 2, 0)) return "UTF-16 (little-endian)";
  if (is_ascii_in_units(start, 2, 1)) return "UTF-16 (big-endian)";
  return {};
}

}  // namespace

void refuse_file(std::string_view name, std::string_view message) {
  throw Error(ErrorKind::input, fmt::format("{}: {}", on_one_line(name), message));
}

InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) refuse_file(name_, "no such file");
  if (std::filesystem::is_directory(status)) refuse_file(name_, "is a directory, not a file");
  file_.reset(std::fopen(name_.c_str(), "rb"));
  if (!file_) refuse_file(name_, fmt::format("cannot be read: {}", std::strerror(errno)));
  if (std::filesystem::is_regular_file(status)) size_ = std::filesystem::file_size(path, error);
  if (error) refuse_file(name_, fmt::format("cannot be read: {}", error.message()));
  begin();
}

InputFile::InputFile(std::string name, std::string_view bytes)
    : name_(std::move(name)), size_(bytes.size()), buffer_(bytes.begin(), bytes.end()), end_(bytes.size()) {
  if (bytes.empty()) refuse_file(name_, "the file is empty");
}

InputFile InputFile::standard_input() {
  InputFile input(std::string("standard input"));
  const int descriptor = dup(STDIN_FILENO);  // whose end closes no other's
  if (descriptor >= 0) input.file_.reset(fdopen(descriptor, "rb"));
  struct stat status = {};
  if (!input.file_ || fstat(descriptor, &status) != 0) {
    refuse_file(input.name_, fmt::format("cannot be read: {}", std::strerror(errno)));
  }
  const off_t start = lseek(descriptor, 0, SEEK_CUR);  // others may have read from it
  if (S_ISREG(status.st_mode) && start >= 0 && start < status.st_size) {
    input.size_ = static_cast<std::uint64_t>(status.st_size - start);
  }
  input.begin();
  return input;
}

void InputFile::begin() {
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);  // the block is the buffer
  buffer_.resize(first_block(size_));
  if (!read_more()) refuse_file(name_, "the file is empty");
  if (unread().starts_with(git_lfs_pointer)) {
    refuse_file(name_, "is a pointer of Git LFS, not the file that it stands for: fetch that by `git lfs pull`");
  }
}

void InputFile::begin_text() {
  if (text_has_begun_) return;
  text_has_begun_ = true;
  if (position() > 0) return;  // behind a binary part
  constexpr std::size_t enough = 32;
  const std::string_view start = peek(enough);
  if (const std::string_view encoding = wide_encoding(start); !encoding.empty()) {
    refuse_file(name_, fmt::format("is text in {}: save it as UTF-8 or ASCII", encoding));
  }
  if (start.starts_with(utf8_mark)) next_ += utf8_mark.size();
}

/// Moves the unread bytes to the front of the buffer and appends to them; false at the end of the file.
bool InputFile::read_more() {
  if (!file_) return false;
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(next_), buffer_.begin() + static_cast<std::ptrdiff_t>(end_),
            buffer_.begin());
  block_start_ += next_;
  end_ -= next_;
  next_ = 0;
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  const std::size_t count = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  if (count == 0 && std::ferror(file_.get()) != 0) {
    throw Error(ErrorKind::failure,
                fmt::format("{}: byte {}: cannot be read: {}", name_, block_start_ + end_, std::strerror(errno)));
  }
  end_ += count;
  return count > 0;
}

std::optional<std::string_view> InputFile::next_line() {
  begin_text();
  std::size_t searched = 0;
  std::size_t line_end = std::string_view::npos;
  while ((line_end = unread().find('\n', searched)) == std::string_view::npos) {
    searched = unread().size();
    if (searched > longest_line || !read_more()) break;
  }
  const std::string_view rest = unread();
  if (rest.empty()) return std::nullopt;
  ++line_number_;
  last_read_ = Unit::line;
  std::string_view line = rest.substr(0, line_end);
  if (line.size() > longest_line) fail(fmt::format("longer than {} characters", longest_line));
  line_has_end_ = line.size() < rest.size();
  next_ += std::min(line.size() + 1, rest.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::optional<std::string_view> InputFile::next_line_with_text() {
  while (const std::optional<std::string_view> line = next_line()) {
    if (line->find_first_not_of(" \t\r\v\f") != std::string_view::npos) return line;
  }
  return std::nullopt;
}

std::string_view InputFile::peek_lines() {
  begin_text();
  if (unread().size() < buffer_.size() / 2) read_more();
  std::size_t last_end = std::string_view::npos;
  while ((last_end = unread().rfind('\n')) == std::string_view::npos) {
    if (unread().size() > longest_line) next_line();  // which fails
    if (!read_more()) return unread();
  }
  return unread().substr(0, last_end + 1);
}

void InputFile::pass_lines(std::size_t bytes, std::uint64_t count) {
  next_ += bytes;
  line_number_ += count;
  last_read_ = Unit::line;
}

std::string_view InputFile::take(std::size_t count, std::string_view what) {
  bytes_start_ = position();
  last_read_ = Unit::bytes;
  while (end_ - next_ < count) {
    if (!read_more())
      fail(fmt::format("truncated: the file ends after {} bytes, inside {}", block_start_ + end_, what));
  }
  next_ += count;
  return {buffer_.data() + next_ - count, count};
}

std::string_view InputFile::peek(std::size_t count) {
  while (end_ - next_ < count && read_more()) {
  }
  return unread().substr(0, count);
}

std::string_view InputFile::peek_text(std::size_t count) {
  begin_text();
  return peek(count);
}

void InputFile::go_to(std::uint64_t position) {
  if (position >= block_start_ && position - block_start_ <= end_) {  // no need to read the block again
    next_ = position - block_start_;
    return;
  }
  if (!file_) {
    next_ = end_;
    return;
  }
  if (fseeko(file_.get(), static_cast<off_t>(position), SEEK_SET) != 0) {
    throw Error(ErrorKind::failure,
                fmt::format("{}: byte {}: cannot be read: {}", name_, position, std::strerror(errno)));
  }
  block_start_ = position;
  next_ = end_ = 0;
}

void InputFile::fail_at_line(std::uint64_t line, std::string_view message) const {
  refuse_file(name_, fmt::format("line {}: {}", line, message));
}

void InputFile::fail(std::string_view message) const {
  switch (last_read_) {
    case Unit::line: fail_at_line(line_number_, message);
    case Unit::bytes: refuse_file(name_, fmt::format("byte {}: {}", bytes_start_, message));
    case Unit::nothing: break;
  }
  refuse_file(name_, message);
}

void InputFile::fail_whole(std::string_view message) const {
  refuse_file(name_, message);
}

std::filesystem::path through_links(std::filesystem::path name) {
  while (std::filesystem::is_symlink(name)) {
    const std::filesystem::path next = std::filesystem::read_symlink(name);
    name = name.parent_path() / next;  // `next` alone where it is absolute
  }
  return name;
}

namespace {

/// FIPS 180-4, section 4.2.2.
constexpr std::array<std::uint32_t, 64> round_constants{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

using Schedule = std::array<std::uint32_t, 64>;

Schedule schedule_of(std::span<const std::uint8_t, 64> block) {
  Schedule w{};
  for (std::size_t i = 0; i < 64; ++i) w[i / 4] = w[i / 4] << 8U | block[i];
  for (std::size_t t = 16; t < w.size(); ++t) {
    const std::uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ w[t - 15] >> 3U;
    const std::uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ w[t - 2] >> 10U;
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }
  return w;
}

}  // namespace

void Sha256::take_block() {
  const Schedule w = schedule_of(block_);
  auto [a, b, c, d, e, f, g, h] = state_;
  for (std::size_t t = 0; t < w.size(); ++t) {
    const std::uint32_t s1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t first = h + s1 + ((e & f) ^ (~e & g)) + round_constants[t] + w[t];
    const std::uint32_t s0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t second = s0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + first;
    d = c;
    c = b;
    b = a;
    a = first + second;
  }
  const std::array<std::uint32_t, 8> change{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < state_.size(); ++i) state_[i] += change[i];
}

void Sha256::add(std::span<const std::byte> bytes) {
  for (const std::byte byte : bytes) {
    block_[bytes_ % block_size] = std::to_integer<std::uint8_t>(byte);
    if (++bytes_ % block_size == 0) take_block();
  }
}

std::string Sha256::digest() {
  const std::uint64_t bits = 8 * bytes_;
  constexpr std::array<std::byte, 1> one{std::byte{0x80}};
  constexpr std::array<std::byte, 1> zero{};
  add(one);
  while (bytes_ % block_size != block_size - sizeof bits) add(zero);
  for (unsigned shift = 64; shift > 0; shift -= 8) {
    const std::array<std::byte, 1> next{static_cast<std::byte>(bits >> (shift - 8))};
    add(next);
  }
  std::string text;
  for (const std::uint32_t word : state_) {
    for (unsigned shift = 32; shift > 0; shift -= 4) text += "0123456789abcdef"[word >> (shift - 4) & 15U];
  }
  return text;
}

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(std::as_bytes(std::span(bytes)));
  return hash.digest();
}

}  // namespace verisq
