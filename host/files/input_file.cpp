/// Blocks, lines and positions of a file that is read front to back.
#include "host/files/input_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <verisq/error.hpp>

namespace verisq {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 20;

/// A file of known size needs no more than its size, and one byte by which a single read finds its end.
std::size_t first_block(std::uint64_t size) {
  return size == 0 ? block_size : std::min<std::uint64_t>(block_size, size + 1);
}

}  // namespace

void refuse_file(std::string_view name, std::string_view message) {
  throw Error(ErrorKind::input, fmt::format("{}: {}", name, message));
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
}

/// Moves what is unread to the front of the buffer and appends to it; false at the end of the file.
bool InputFile::read_more() {
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

void InputFile::go_to(std::uint64_t position) {
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

}  // namespace verisq
