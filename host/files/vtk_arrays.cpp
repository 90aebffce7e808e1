/// This file implements vtk_arrays.hpp.
#include "host/files/vtk_arrays.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/files/words.hpp"

namespace verisq {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 16U;

}  // namespace

bool is_blank(std::string_view text) {
  return text.find_first_not_of(blanks_and_ends) == std::string_view::npos;
}

void pass_blanks(InputFile& file) {
  for (std::size_t passed = block_size; passed == block_size;) {
    const std::string_view start = file.peek(block_size);
    passed = file.take(std::min(start.find_first_not_of(blanks_and_ends), start.size()), "blanks").size();
  }
}

std::string_view next_word(InputFile& file) {
  constexpr std::size_t longest_word = 4096;
  pass_blanks(file);
  const std::string_view start = file.peek(longest_word);
  const std::size_t length = std::min(start.find_first_of(" \t\r\n\v\f<"), start.size());
  if (length == longest_word) file.fail(fmt::format("a word longer than {} characters", longest_word));
  return file.take(length, "a word");
}

std::string_view take_line(InputFile& file, std::string_view what) {
  const std::string_view start = file.peek(block_size);
  const std::size_t end = start.find('\n');
  if (end != std::string_view::npos) return file.take(end + 1, what);
  if (start.size() == block_size) file.fail(fmt::format("{}: a line longer than {} bytes", what, block_size));
  return file.take(std::max<std::size_t>(1, start.size()), what);
}

std::uint64_t count_from(const InputFile& file, std::string_view word, std::string_view what) {
  const std::int64_t count = integer(file, word, what);
  if (count < 0) file.fail(fmt::format("{} = {}: must not be negative", what, count));
  return static_cast<std::uint64_t>(count);
}

namespace {

constexpr std::int8_t no_digit = -1;

constexpr auto base64_digits = [] {
  std::array<std::int8_t, 256> digits{};
  for (std::int8_t& digit : digits) digit = no_digit;
  std::int8_t next = 0;
  for (const char letter : std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/")) {
    digits[static_cast<unsigned char>(letter)] = next++;
  }
  return digits;
}();

}  // namespace

void FileBytes::read(std::span<char> bytes, std::string_view what) {
  if (!base64_) {
    std::ranges::copy(file_.take(bytes.size(), what), bytes.begin());
    return;
  }
  for (char& byte : bytes) {
    if (waiting_ == 0) decode(what);
    byte = static_cast<char>(group_ >> 8U * --waiting_);
  }
}

/// A group of four letters: three bytes, or fewer before padding.
void FileBytes::decode(std::string_view what) {
  std::uint32_t bits = 0;
  std::size_t padding = 0;
  for (std::size_t letters = 0; letters < 4;) {
    const char letter = file_.take(1, what)[0];
    if (is_blank({&letter, 1})) continue;
    const std::int8_t digit = base64_digits[static_cast<unsigned char>(letter)];
    const bool pads = letter == '=' && letters >= 2;
    if (!pads && (digit == no_digit || padding > 0)) {
      file_.fail(fmt::format("{}: {} is no letter of base64 here", what, in_quotes({&letter, 1})));
    }
    bits = bits << 6U | (pads ? 0U : static_cast<std::uint32_t>(digit));
    padding += pads ? 1 : 0;
    ++letters;
  }
  waiting_ = 3 - padding;
  group_ = bits >> 8U * padding;
}

void ArrayBytes::begin(std::uint64_t tuples, std::size_t size, std::string_view what) {
  const std::uint64_t bytes = coding_.packed ? blocks_header(what) : header_number(what);
  if (bytes % size != 0 || bytes / size != tuples) {
    file_.fail_whole(fmt::format("{}: {} bytes, expected {} times {}", what, bytes, tuples, size));
  }
  if (!coding_.packed && bytes > source_.most()) {
    file_.fail_whole(fmt::format("{}: truncated: {} bytes, the file has {} more", what, bytes, file_.remaining()));
  }
}

void ArrayBytes::read(std::span<char> bytes, std::string_view what) {
  if (!coding_.packed) return source_.read(bytes, what);
  while (!bytes.empty()) {
    if (next_ == block_.size()) unpack(what);
    const std::size_t count = std::min(bytes.size(), block_.size() - next_);
    std::copy_n(block_.begin() + static_cast<std::ptrdiff_t>(next_), count, bytes.begin());
    next_ += count;
    bytes = bytes.subspan(count);
  }
}

std::uint64_t ArrayBytes::header_number(std::string_view what) {
  std::array<char, sizeof(std::uint64_t)> bytes{};
  source_.read(std::span(bytes).first(size_of(coding_.header)), what);
  const auto number = converted_from<std::int64_t>(bytes.data(), coding_.header, coding_.order);
  if (number < 0) file_.fail(fmt::format("{}: its header has {}", what, static_cast<std::uint64_t>(number)));
  return static_cast<std::uint64_t>(number);
}

/// The number of blocks, the size of each when unpacked, that of a last smaller one or 0, and the packed sizes. Returns
/// the size of all when unpacked.
std::uint64_t ArrayBytes::blocks_header(std::string_view what) {
  const std::uint64_t blocks = header_number(what);
  const std::uint64_t size = header_number(what);
  const std::uint64_t last = header_number(what);
  constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();  // so that no product overflows
  if (blocks > most || size > most || last > size || (size == 0 && blocks > 0)) {
    file_.fail(fmt::format("{}: {} packed blocks of {} bytes, the last one of {}", what, blocks, size, last));
  }
  for (std::uint64_t k = 0; k < blocks; ++k) packed_sizes_.push_back(header_number(what));
  full_size_ = size;
  last_size_ = last == 0 ? size : last;
  return blocks == 0 ? 0 : (blocks - 1) * size + last_size_;
}

/// The next block. No memory is taken for bytes that the file cannot hold.
void ArrayBytes::unpack(std::string_view what) {
  const std::uint64_t packed_size = packed_sizes_.at(blocks_read_);
  const std::uint64_t size = ++blocks_read_ == packed_sizes_.size() ? last_size_ : full_size_;
  if (packed_size > source_.most() || size / most_unpacked_of_one > packed_size) {
    file_.fail(fmt::format("{}: truncated: {} bytes packed into {}", what, size, packed_size));
  }
  packed_.resize(packed_size);
  source_.read(packed_, what);
  block_.resize(size);
  next_ = 0;
  uLongf unpacked = size;
  uLong used = packed_size;
  const int outcome = uncompress2(reinterpret_cast<Bytef*>(block_.data()), &unpacked,
                                  reinterpret_cast<const Bytef*>(packed_.data()), &used);
  if (outcome != Z_OK || unpacked != size || used != packed_size) {
    file_.fail(fmt::format("{}: packed block {} does not unpack to {} bytes", what, blocks_read_, size));
  }
}

template <class Number>
Number Numbers::next(std::string_view what) {
  std::array<char, sizeof(std::uint64_t)> bytes{};
  bytes_->read(std::span(bytes).first(size_of(type_)), what);
  return converted_from<Number>(bytes.data(), type_, order_);
}

double Numbers::finite(std::string_view what) {
  if (!bytes_) return finite_number(file_, next_word(file_), what);
  const auto value = next<double>(what);
  if (!std::isfinite(value)) file_.fail(fmt::format("{} = {}: not a finite number", what, value));
  return value;
}

std::int64_t Numbers::whole(std::string_view what) {
  return bytes_ ? next<std::int64_t>(what) : integer(file_, next_word(file_), what);
}

void Numbers::pass(std::uint64_t count, std::string_view what) {
  for (std::uint64_t k = 0; k < count; ++k) {
    if (bytes_) {
      (void)next<double>(what);
    } else if (next_word(file_).empty()) {
      file_.fail(fmt::format("truncated: the file ends inside {}", what));
    }
  }
}

void read_points(Numbers& numbers, std::uint64_t count, MeshBuilder& builder) {
  for (std::uint64_t k = 0; k < count; ++k) {
    builder.add_vertex({numbers.finite("x"), numbers.finite("y"), numbers.finite("z")});
  }
}

std::vector<std::int64_t> Cells::read_ends(Numbers& numbers, std::uint64_t count) const {
  std::vector<std::int64_t> ends;
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::int64_t start = ends.empty() ? 0 : ends.back();
    ends.push_back(numbers.whole("offset"));
    if (ends.back() < start) file_.fail(fmt::format("offset {} behind offset {}", ends.back(), start));
  }
  return ends;
}

void Cells::read_cells(Numbers& connectivity, std::span<const std::int64_t> ends) {
  std::int64_t start = 0;
  for (const std::int64_t end : ends) read_cell(connectivity, end - std::exchange(start, end));
}

void Cells::read_cell(Numbers& connectivity, std::int64_t corners) {
  builder_.check_corner_count(corners);
  corners_.clear();
  for (std::int64_t k = 0; k < corners; ++k) {
    corners_.push_back(builder_.checked_index(connectivity.whole("vertex index"), first_));
  }
  if (kind_ == Kind::polygons) return builder_.add_polygon(corners_);
  // Each corner from the third on makes a triangle with the two before it; every second triangle is turned over.
  for (std::size_t k = 2; k < corners_.size(); ++k) {
    const std::size_t odd = k % 2;
    builder_.add_polygon(std::array{corners_[k - 2 + odd], corners_[k - 1 - odd], corners_[k]});
  }
}

}  // namespace verisq
