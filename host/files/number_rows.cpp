/// Splits lines at their commas.
#include "host/files/number_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/files/words.hpp"

namespace verisq {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // some spreadsheets put it before the header

/// Takes the first field from the front of `line`, and the comma after it.
std::string_view take_field(std::string_view& line) {
  const std::string_view field = line.substr(0, line.find(','));
  line.remove_prefix(std::min(field.size() + 1, line.size()));
  return field;
}

std::size_t fields_of(std::string_view line) {
  return static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
}

bool is_header(std::string_view line, std::string_view header) {
  std::string text = lower_case(line);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '"'; });
  return text == header;
}

}  // namespace

NumberRows::NumberRows(const std::filesystem::path& path, const RowKind& kind)
    : file_(path), kind_(kind), names_(fields_of(kind.header)) {
  std::string_view header = kind.header;
  for (std::string_view& name : names_) name = take_field(header);
}

/// Without the byte order mark and the header.
std::optional<std::string_view> NumberRows::next_line() {
  std::optional<std::string_view> line = file_.next_line();
  if (at_first_line_ && line) {
    at_first_line_ = false;
    if (line->starts_with(byte_order_mark)) line->remove_prefix(byte_order_mark.size());
    if (is_header(*line, kind_.header)) line = file_.next_line();
  }
  if (line && trimmed(*line).empty()) {
    if (file_.next_line_with_text()) {
      fail(fmt::format("a {} after a blank line: blank lines are fine at the end only", kind_.item));
    }
    return std::nullopt;
  }
  return line;
}

bool NumberRows::next(std::span<double> numbers) {
  std::optional<std::string_view> line = next_line();
  if (!line) {
    if (!any_row_) file_.fail_whole(fmt::format("no {}s", kind_.item));
    return false;
  }
  if (fields_of(*line) != names_.size()) {
    fail(fmt::format("{}: expected {} numbers {}", in_quotes(trimmed(*line)), kind_.count, kind_.header));
  }
  for (std::size_t k = 0; k < names_.size(); ++k) {
    numbers[k] = finite_number(file_, trimmed(take_field(*line)), names_[k]);
  }
  any_row_ = true;
  return true;
}

}  // namespace verisq
