/// Fields, headers and numbers of lines.
#include "host/files/row_form.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string>
#include <system_error>

#include "host/files/short_decimal.hpp"
#include "host/files/words.hpp"

namespace verisq {
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

bool RowForm::learn(const InputFile& file, std::string_view line) {
  if (kind_.free && line.find(',') == std::string_view::npos) separator_ = ' ';
  const std::vector<std::string_view> fields = split(line);
  if (learn_names(file, fields)) return true;
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
    file.fail(fmt::format("{}: expected {} numbers {}", text, kind_.count, kind_.header));
  }
  file.fail(
      fmt::format("{}: expected {} fields as in the first line, found {}", text, fields_.size(), split(line).size()));
}

}  // namespace verisq
