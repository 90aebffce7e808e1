/// Blocks of lines, split among processors.
#include "host/files/number_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <verisq/error.hpp>

#include "host/files/words.hpp"
#include "host/threads/parallel.hpp"

namespace verisq {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // some spreadsheets put it before the header

/// Fewer bytes are not worth a thread.
constexpr std::size_t smallest_piece = std::size_t{1} << 17;

/// Rows that there is room for at first.
constexpr std::size_t smallest_room = 64;

/// Cuts `lines` behind line ends into about equal pieces, as many as there are processors.
std::vector<std::string_view> cut(std::string_view lines) {
  const std::size_t most = std::max<std::size_t>(1, lines.size() / smallest_piece);
  const std::size_t count = std::min<std::size_t>(most, std::max(1U, std::thread::hardware_concurrency()));
  std::vector<std::string_view> pieces;
  for (std::size_t k = count; k > 0; --k) {
    const std::size_t end = k == 1 ? std::string_view::npos : lines.find('\n', lines.size() / k);
    const std::size_t length = end == std::string_view::npos ? lines.size() : end + 1;
    pieces.push_back(lines.substr(0, length));
    lines.remove_prefix(length);
  }
  return pieces;
}

}  // namespace

std::size_t NumberRows::read(std::span<double> numbers) {
  std::size_t count = 0;
  while (count < numbers.size()) {
    if (numbers_left_ == 0 && !read_more()) break;
    const Piece& source = pieces_[piece_];
    const std::size_t part = std::min(numbers.size() - count, source.count - next_);
    std::copy_n(source.numbers.begin() + static_cast<std::ptrdiff_t>(next_), part,
                numbers.begin() + static_cast<std::ptrdiff_t>(count));
    count += part;
    next_ += part;
    numbers_left_ -= part;
    if (next_ == source.count) {
      ++piece_;
      next_ = 0;
    }
  }
  return count;
}

/// Fills the pieces; false at the end of the file.
bool NumberRows::read_more() {
  block_start_ = file_.position();
  piece_ = 0;
  next_ = 0;
  if (!at_first_line_) {
    const std::vector<std::string_view> cuts = cut(file_.peek_lines());
    pieces_.resize(cuts.size());
    for (std::size_t k = 0; k < cuts.size(); ++k) pieces_[k].lines = cuts[k];
    in_parallel(pieces_.size(), [&](std::size_t k) { read_lines(pieces_[k]); });
    const auto stopped = std::ranges::find_if(pieces_, [](const Piece& p) { return p.bytes < p.lines.size(); });
    if (stopped != pieces_.end()) pieces_.erase(stopped + 1, pieces_.end());
    std::size_t bytes = 0;
    for (const Piece& piece : pieces_) {
      numbers_left_ += piece.count;
      bytes += piece.bytes;
    }
    file_.pass_lines(bytes, numbers_left_ / form_.numbers());
    std::erase_if(pieces_, [](const Piece& piece) { return piece.count == 0; });
  }
  if (numbers_left_ == 0) {  // the first line, one that needs a message, or the end
    std::optional<std::string_view> line = file_.next_line();
    if (at_first_line_ && line) {
      at_first_line_ = false;
      if (line->starts_with(byte_order_mark)) line->remove_prefix(byte_order_mark.size());
      if (form_.learn(file_, *line)) line = file_.next_line();
    }
    if (!line || !read_line(*line)) {
      if (!any_row_) file_.fail_whole(fmt::format("no {}s", form_.kind().item));
      return false;
    }
  }
  any_row_ = true;
  block_numbers_ = numbers_left_;
  return true;
}

/// Makes the line the only row at hand; false for the blank lines at the end of the file.
bool NumberRows::read_line(std::string_view line) {
  if (trimmed(line).empty()) {
    if (file_.next_line_with_text()) {
      file_.fail(fmt::format("a {} after a blank line: blank lines are fine at the end only", form_.kind().item));
    }
    return false;
  }
  pieces_.resize(1);
  Piece& piece = pieces_[0];
  if (piece.numbers.size() < form_.numbers()) piece.numbers.resize(form_.numbers());
  form_.read(file_, line, piece.numbers);
  piece.count = form_.numbers();
  numbers_left_ = form_.numbers();
  return true;
}

void NumberRows::read_lines(Piece& piece) const {
  piece.count = 0;
  std::string_view rest = piece.lines;
  while (!rest.empty()) {
    if (piece.numbers.size() - piece.count < form_.numbers()) {
      piece.numbers.resize(std::max(2 * piece.numbers.size(), smallest_room * form_.numbers()));
    }
    const std::span<double> row = std::span(piece.numbers).subspan(piece.count, form_.numbers());
    const char* after = form_.read_plain(rest, row);
    if (after == nullptr) {
      const std::string_view line = rest.substr(0, rest.find('\n'));
      if (trimmed(line).empty()) break;
      try {
        form_.read(file_, line.ends_with('\r') ? line.substr(0, line.size() - 1) : line, row);
      } catch (const Error&) {
        break;  // to be read again, for a message with the number of the line
      }
      after = line.data() + std::min(line.size() + 1, rest.size());
    }
    piece.count += row.size();
    rest.remove_prefix(static_cast<std::size_t>(after - rest.data()));
  }
  piece.bytes = piece.lines.size() - rest.size();
}

std::uint64_t NumberRows::rows_left() const {
  return numbers_left_ / form_.numbers();
}

std::uint64_t NumberRows::bytes_read() const {
  const std::uint64_t bytes = file_.position() - block_start_;
  if (block_numbers_ == 0) return file_.position();
  return block_start_ + bytes * (block_numbers_ - numbers_left_) / block_numbers_;
}

}  // namespace verisq
