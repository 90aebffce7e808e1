/// This file implements words.hpp.
#include "host/files/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string>
#include <system_error>
#include <thread>
#include <verisq/error.hpp>
#include <verisq/files.hpp>

#include "host/threads/parallel.hpp"

namespace verisq {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return plus ? word.substr(1) : word;
}

/// from_chars does not change the value for 1e999 or for 1e-999. The nearest binary64 of the latter is zero; the wider
/// range of long double distinguishes them. Nothing if even that does not suffice.
std::optional<double> underflowed(std::string_view word) {
  long double wide = 1.0L;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), wide);
  if (error != std::errc{} || std::abs(wide) >= 1.0L) return std::nullopt;
  return std::copysign(0.0, static_cast<double>(wide));
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view Words::next() {
  const std::size_t length = std::min(rest_.find_first_of(blanks), rest_.size());
  const std::string_view word = rest_.substr(0, length);
  rest_.remove_prefix(length);
  rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
  return word;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return result;
}

std::string printable(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code >= 0x7f) {
      result += fmt::format("\\x{:02x}", code);
    } else {
      result += c;
    }
  }
  return result;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  return fmt::format("'{}{}'", printable(text.substr(0, longest)), text.size() > longest ? "..." : "");
}

void expect_end(const InputFile& file, const Words& words) {
  if (!words.empty()) file.fail(fmt::format("unexpected {}", in_quotes(words.rest())));
}

double finite_number(const InputFile& file, std::string_view word, std::string_view what) {
  const std::string_view digits = without_plus(word);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole_word = end == digits.data() + digits.size();
  if (error == std::errc{} && whole_word && std::isfinite(value)) return value;
  if (word.empty()) file.fail(fmt::format("{} is missing", what));
  if (error == std::errc::invalid_argument || !whole_word) {
    file.fail(fmt::format("{} = {}: not a number", what, in_quotes(word)));
  }
  if (error == std::errc::result_out_of_range) {
    if (const std::optional<double> zero = underflowed(digits)) return *zero;
    file.fail(fmt::format("{} = {}: beyond the range of binary64", what, in_quotes(word)));
  }
  file.fail(fmt::format("{} = {}: not a finite number", what, in_quotes(word)));
}

Point coordinates(const InputFile& file, Words& words) {
  const double x = finite_number(file, words.next(), "x");
  const double y = finite_number(file, words.next(), "y");
  const double z = finite_number(file, words.next(), "z");
  return {x, y, z};
}

std::int64_t integer(const InputFile& file, std::string_view word, std::string_view what) {
  const std::string_view digits = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc{} && end == digits.data() + digits.size()) return value;
  if (word.empty()) file.fail(fmt::format("{} is missing", what));
  file.fail(fmt::format("{} = {}: not an integer", what, in_quotes(word)));
}

namespace {

/// Takes the first field from the front of `line`, and the comma after it.
std::string_view take_field(std::string_view& line) {
  const std::string_view field = line.substr(0, line.find(','));
  line.remove_prefix(std::min(field.size() + 1, line.size()));
  return field;
}

std::vector<std::string_view> split_at_commas(std::string_view line) {
  std::vector<std::string_view> fields(static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1);
  for (std::string_view& field : fields) field = trimmed(take_field(line));
  return fields;
}

std::vector<std::string_view> split_at_blanks(std::string_view line) {
  std::vector<std::string_view> fields;
  for (Words words(line); !words.empty();) fields.push_back(words.next());
  return fields;
}

/// The name in a field of a header: any case, with or without quotes and blanks.
std::string name_in(std::string_view field) {
  std::string name = lower_case(field);
  std::erase_if(name, [](char c) { return c == ' ' || c == '\t' || c == '"'; });
  return name;
}

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

const char* after_blanks(const char* at, const char* end) {
  while (at != end && is_blank(*at)) ++at;
  return at;
}

const char* after_number(const char* at, const char* end, double& number) {
  if (const char* const after = read_short_decimal(at, end, number)) return after;
  const auto [after, error] = std::from_chars(at, end, number);
  return error == std::errc{} && std::isfinite(number) ? after : nullptr;
}

}  // namespace

RowForm::RowForm(const RowKind& kind) : kind_(kind), names_(split_at_commas(kind.header)), fields_(names_.size()) {
  std::iota(fields_.begin(), fields_.end(), std::size_t{0});
}

std::vector<std::string_view> RowForm::split(std::string_view line) const {
  return separator_ == ',' ? split_at_commas(line) : split_at_blanks(line);
}

/// "//X Y Z" of CloudCompare and "# x y z" of NumPy are headers all the same.
std::string_view RowForm::without_comment_mark(std::string_view line) const {
  const std::string_view text = trimmed(line);
  if (kind_.free && text.starts_with("//")) return text.substr(2);
  return kind_.free && text.starts_with('#') ? text.substr(1) : line;
}

bool RowForm::learn(const InputFile& file, std::string_view line) {
  if (kind_.free && line.find(',') == std::string_view::npos) separator_ = ' ';
  if (learn_names(file, split(without_comment_mark(line)))) return true;
  const std::vector<std::string_view> fields = split(line);
  if (kind_.free && fields.size() > names_.size()) fields_.resize(fields.size(), passed_over);
  return false;
}

/// False where the fields are not names.
bool RowForm::learn_names(const InputFile& file, std::span<const std::string_view> fields) {
  std::vector<std::size_t> named(fields.size(), passed_over);
  std::size_t found = 0;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const auto name = std::ranges::find(names_, name_in(fields[k]));
    if (name == names_.end()) continue;
    named[k] = static_cast<std::size_t>(name - names_.begin());
    ++found;
  }
  for (std::size_t n = 0; n < names_.size(); ++n) {
    const auto times = std::ranges::count(named, n);
    if (times == 0) return false;
    if (times > 1 && kind_.free) file.fail(fmt::format("column {} is there {} times", names_[n], times));
  }
  if (kind_.free) {
    fields_ = named;
    return true;
  }
  return named == fields_;
}

const char* RowForm::read_plain(std::string_view text, std::span<double> numbers) const {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    if (k > 0) at = after_separator(at, end);
    if (at == nullptr) return nullptr;
    at = after_blanks(at, end);
    at = fields_[k] == passed_over ? after_other(at, end) : after_number(at, end, numbers[fields_[k]]);
    if (at == nullptr) return nullptr;
    at = after_blanks(at, end);
  }
  if (at == end) return at;
  return *at == '\n' ? at + 1 : nullptr;
}

/// Precondition: a field and the blanks behind it are before `at`.
const char* RowForm::after_separator(const char* at, const char* end) const {
  if (separator_ == ' ') return is_blank(at[-1]) ? at : nullptr;
  return at != end && *at == ',' ? at + 1 : nullptr;
}

/// Behind a field that is passed over, which may be empty between commas.
const char* RowForm::after_other(const char* at, const char* end) const {
  const auto ends = [this](char c) { return c == '\n' || (separator_ == ' ' ? is_blank(c) : c == ','); };
  const char* const after = std::find_if(at, end, ends);
  return after == at && separator_ == ' ' ? nullptr : after;
}

void RowForm::read(const InputFile& file, std::string_view line, std::span<double> numbers) const {
  const std::vector<std::string_view> fields = split(line);
  if (fields.size() != fields_.size()) refuse(file, line);
  for (std::size_t k = 0; k < fields.size(); ++k) {
    if (fields_[k] != passed_over) numbers[fields_[k]] = finite_number(file, fields[k], names_[fields_[k]]);
  }
}

void RowForm::refuse(const InputFile& file, std::string_view line) const {
  const std::string text = in_quotes(trimmed(line));
  if (fields_.size() == names_.size()) {
    const bool mesh = kind_.item == "point" && is_mesh_name(file.name());
    file.fail(fmt::format("{}: expected {} numbers {}{}", text, kind_.count, kind_.header,
                          mesh ? "; the file's name is that of a mesh, which is no list of points" : ""));
  }
  file.fail(
      fmt::format("{}: expected {} fields as in the first line, found {}", text, fields_.size(), split(line).size()));
}

namespace {

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
