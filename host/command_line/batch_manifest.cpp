/// CSV with quotes, and what its columns stand for.
#include "host/command_line/batch_manifest.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

#include "host/files/input_file.hpp"
#include "host/files/words.hpp"

namespace verisq::command_line {
namespace {

/// Nothing where a quote does not end, or text follows one.
std::optional<std::vector<std::string>> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  for (bool more = true; more;) {
    std::string field;
    if (line.starts_with('"')) {
      line.remove_prefix(1);
      for (;;) {
        const std::size_t quote = line.find('"');
        if (quote == std::string_view::npos) return std::nullopt;
        field += line.substr(0, quote);
        line.remove_prefix(quote + 1);
        if (!line.starts_with('"')) break;
        field += '"';  // two of them are one
        line.remove_prefix(1);
      }
      if (!line.empty() && line.front() != ',') return std::nullopt;
    } else {
      field = line.substr(0, line.find(','));
      line.remove_prefix(field.size());
    }
    more = !line.empty();
    if (more) line.remove_prefix(1);
    fields.push_back(std::move(field));
  }
  return fields;
}

bool consists_of(std::string_view text, std::string_view further) {
  return !text.empty() && std::ranges::all_of(text, [&](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') ||
           further.find(c) != std::string_view::npos;
  });
}

/// Options that this program gives its cases itself, or that would take rows elsewhere.
bool is_reserved(std::string_view column) {
  return column == "json" || column == "no-progress" || column == "help" || column == "part";
}

std::vector<std::string> read_header(const InputFile& file, std::string_view line) {
  const auto columns = fields_of(line);
  if (!columns) file.fail("a quote that does not end");
  for (auto column = columns->begin(); column != columns->end(); ++column) {
    if (!consists_of(*column, "-")) file.fail(fmt::format("{}: not a name of a column", in_quotes(*column)));
    if (is_reserved(*column)) file.fail(fmt::format("{}: not an option of cases", in_quotes(*column)));
    if (std::find(columns->begin(), column, *column) != column) {
      file.fail(fmt::format("column {} twice", in_quotes(*column)));
    }
  }
  if (std::ranges::find(*columns, "case") == columns->end()) file.fail("no column case");
  return *columns;
}

void add_argument(BatchCase& added, const std::string& column, const std::string& value) {
  if (column == "case") {
    added.name = value;
  } else if (column == "command") {
    if (!value.empty()) added.command = value;
  } else if (!value.empty() && value != "no") {
    if (column == "output") added.has_output = true;
    if (column == "a" || column == "b") {
      added.arguments.push_back(value);
    } else if (value == "yes") {
      added.arguments.push_back("--" + column);
    } else {
      added.arguments.push_back("--" + column + "=" + value);
    }
  }
}

}  // namespace

std::vector<BatchCase> read_manifest(const std::filesystem::path& path) {
  InputFile file(path);
  const auto first = file.next_line_with_text();
  if (!first) file.fail_whole("no header");
  const std::vector<std::string> columns = read_header(file, *first);
  std::vector<BatchCase> cases;
  std::map<std::string, std::uint64_t, std::less<>> line_of;
  while (const auto line = file.next_line_with_text()) {
    const auto fields = fields_of(*line);
    if (!fields) file.fail("a quote that does not end");
    if (fields->size() != columns.size()) {
      file.fail(fmt::format("{} fields, and {} columns", fields->size(), columns.size()));
    }
    BatchCase added{.name = {}, .command = "map", .arguments = {}};
    for (std::size_t i = 0; i < columns.size(); ++i) add_argument(added, columns[i], (*fields)[i]);
    if (!consists_of(added.name, "._-") || added.name.starts_with('.')) {
      file.fail(
          fmt::format("case = {}: letters, digits, '_', '-' and '.', not at the beginning", in_quotes(added.name)));
    }
    if (!consists_of(added.command, "")) file.fail(fmt::format("command = {}: no command", in_quotes(added.command)));
    const auto [place, is_new] = line_of.try_emplace(added.name, file.lines_read());
    if (!is_new) file.fail(fmt::format("case {} is that of line {}, too", added.name, place->second));
    cases.push_back(std::move(added));
  }
  if (cases.empty()) file.fail_whole("no cases");
  return cases;
}

}  // namespace verisq::command_line
