/// CSV and JSON of a cohort.
#include "host/command_line/batch_tables.hpp"

#include <fmt/core.h>

#include "host/command_line/json_value.hpp"
#include "host/files/output_file.hpp"

namespace verisq::command_line {
namespace {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' || c == '\r' ? ' ' : c;
  }
  return quoted + "\"";
}

/// Empty where there is none.
template <class Number>
std::string text_of(const std::optional<Number>& number) {
  return number ? fmt::format("{}", *number) : std::string();
}

JsonValue json_of(const BatchCase& of, const CaseResult& result) {
  JsonObject object{{"case", of.name}, {"command", of.command}, {"outcome", to_string(result.outcome)}};
  if (result.smallest) object.set("smallest_distance", *result.smallest);
  if (result.rows) object.set("rows", *result.rows);
  if (result.wide_rows) object.set("wide_rows", *result.wide_rows);
  if (result.largest_width) object.set("largest_width", *result.largest_width);
  if (!result.units.empty()) object.set("units", result.units);
  if (!result.message.empty()) object.set("message", result.message);
  object.set("seconds", result.seconds);
  return object;
}

}  // namespace

BatchTotals totals_of(std::span<const CaseResult> results) {
  BatchTotals totals;
  for (std::size_t i = 0; i < results.size(); ++i) {
    switch (results[i].outcome) {
      case CaseOutcome::verified: ++totals.verified; break;
      case CaseOutcome::wide: ++totals.wide; break;
      case CaseOutcome::failed: ++totals.failed; break;
      case CaseOutcome::not_run: ++totals.not_run; break;
    }
    if (!results[i].smallest) continue;
    if (totals.nearest && results[i].units != results[*totals.nearest].units) totals.same_units = false;
    if (!totals.nearest || results[i].smallest->hi < results[*totals.nearest].smallest->hi) totals.nearest = i;
  }
  if (!totals.same_units) totals.nearest.reset();
  return totals;
}

void write_csv_table(const std::filesystem::path& path, std::span<const BatchCase> cases,
                     std::span<const CaseResult> results) {
  OutputFile file(path);
  file.write("case,command,outcome,lo,hi,rows,wide_rows,largest_width,units,message\n");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const CaseResult& result = results[i];
    std::string ends = ",";
    if (result.smallest) ends = fmt::format("{},{}", result.smallest->lo, result.smallest->hi);
    file.write(fmt::format("{},{},{},{},{},{},{},{},{}\n", cases[i].name, cases[i].command, to_string(result.outcome),
                           ends, text_of(result.rows), text_of(result.wide_rows), text_of(result.largest_width),
                           csv_field(result.units), csv_field(result.message)));
  }
  file.finish();
}

std::string json_table(std::span<const BatchCase> cases, std::span<const CaseResult> results, bool interrupted) {
  const BatchTotals totals = totals_of(results);
  JsonValue::Array rows;
  for (std::size_t i = 0; i < cases.size(); ++i) rows.push_back(json_of(cases[i], results[i]));
  JsonObject object{{"format", "verisq-batch/1"}, {"cases", cases.size()},     {"verified", totals.verified},
                    {"wide", totals.wide},        {"failed", totals.failed},   {"not_run", totals.not_run},
                    {"interrupted", interrupted}, {"results", JsonValue(rows)}};
  if (totals.nearest) object.set("nearest", cases[*totals.nearest].name);
  return object.text() + "\n";
}

void write_json_table(const std::filesystem::path& path, const std::string& json) {
  OutputFile file(path);
  file.write(json);
  file.finish();
}

}  // namespace verisq::command_line
