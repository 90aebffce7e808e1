/// The cases of a cohort as files: manifest, records, tables, page.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>
#include <verisq/version.hpp>

#include "host/command_line/batch_command.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/input_file.hpp"
#include "host/files/output_file.hpp"
#include "host/files/words.hpp"
#include "report/page_template.hpp"

namespace verisq::command_line {
namespace {

/// Nothing if a quote does not end, or if text follows a closing quote.
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

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view record_format = "verisq-batch-case/1";

Json json_of(const std::vector<SubjectFile>& files) {
  Json list = Json::array();
  for (const SubjectFile& file : files) list.push_back({{"file", file.name}, {"sha256", file.sha256}});
  return list;
}

/// The members that identify the record of this case.
Json identity(const BatchCase& of, const std::vector<SubjectFile>& inputs) {
  return {{"format", record_format}, {"version", VERISQ_VERSION}, {"case", of.name},
          {"command", of.command},   {"arguments", of.arguments}, {"inputs", json_of(inputs)}};
}

std::optional<std::uint64_t> count_in(const Json& object, std::initializer_list<const char*> names) {
  for (const char* const name : names) {
    const auto found = object.find(name);
    if (found != object.end() && found->is_number_unsigned()) return found->get<std::uint64_t>();
  }
  return std::nullopt;
}

/// JSON has no infinity: summaries give null.
double end_in(const Json& object, const char* name, double unbounded) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number() ? found->get<double>() : unbounded;
}

std::optional<Enclosure> enclosure_in(const Json& object) {
  if (!object.is_object() || !object.contains("lo") || !object.contains("hi")) return std::nullopt;
  return Enclosure{end_in(object, "lo", -infinity), end_in(object, "hi", infinity)};
}

/// The distance of `map`, `fit`, `insert`; for `distance` and `path` it is the answer itself.
std::optional<Enclosure> smallest_in(const Json& summary) {
  const auto found = summary.find("smallest_distance");
  return found != summary.end() ? enclosure_in(*found) : enclosure_in(summary);
}

CaseResult result_in(const Json& summary, CaseOutcome outcome) {
  CaseResult result{.outcome = outcome};
  result.smallest = smallest_in(summary);
  result.rows = count_in(summary, {"points", "triangles", "poses"});
  result.wide_rows = count_in(summary, {"wide"});
  if (const auto units = summary.find("units"); units != summary.end() && units->is_string()) {
    result.units = units->get<std::string>();
  }
  if (const auto width = summary.find("largest_width"); width != summary.end() && width->is_number()) {
    result.largest_width = width->get<double>();
  }
  return result;
}

std::string text_of_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::string_view to_string(CaseOutcome outcome) {
  switch (outcome) {
    case CaseOutcome::verified: return "verified";
    case CaseOutcome::wide: return "wide";
    case CaseOutcome::failed: return "failed";
    case CaseOutcome::not_run: break;
  }
  return "not-run";
}

CaseResult result_of(std::string_view json, CaseOutcome outcome, std::string_view name) {
  const Json summary = Json::parse(json, nullptr, false);
  if (!summary.is_object()) refuse(fmt::format("{}: printed no summary", name));
  return result_in(summary, outcome);
}

std::string text_of(const CaseResult& result) {
  const auto end = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  Json summary{{"outcome", to_string(result.outcome)}, {"message", result.message}, {"seconds", result.seconds}};
  if (result.smallest)
    summary["smallest_distance"] = {{"lo", end(result.smallest->lo)}, {"hi", end(result.smallest->hi)}};
  if (result.rows) summary["points"] = *result.rows;
  if (result.wide_rows) summary["wide"] = *result.wide_rows;
  if (result.largest_width) summary["largest_width"] = *result.largest_width;
  summary["units"] = result.units;
  return summary.dump(-1, ' ', false, Json::error_handler_t::replace);
}

CaseResult result_from(std::string_view text) {
  const Json summary = Json::parse(text);
  CaseResult result = result_in(summary, CaseOutcome::not_run);
  for (const CaseOutcome outcome : {CaseOutcome::verified, CaseOutcome::wide, CaseOutcome::failed}) {
    if (summary.at("outcome") == to_string(outcome)) result.outcome = outcome;
  }
  result.message = summary.at("message").get<std::string>();
  result.seconds = summary.at("seconds").get<double>();
  return result;
}

std::vector<std::filesystem::path> inputs_of(const BatchCase& of, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const std::string& argument : of.arguments) {
    if (argument.starts_with("--output=")) continue;
    const std::size_t equals = argument.starts_with("--") ? argument.find('=') : std::string::npos;
    const std::filesystem::path named = equals == std::string::npos ? argument : argument.substr(equals + 1);
    std::error_code none;
    if (std::filesystem::is_regular_file(folder / named, none)) files.push_back(folder / named);
  }
  return files;
}

void write_record(const std::filesystem::path& path, const BatchCase& of, const std::vector<SubjectFile>& inputs,
                  CaseOutcome outcome, double seconds, std::string_view json) {
  Json record = identity(of, inputs);
  record["outcome"] = to_string(outcome);
  record["seconds"] = seconds;
  record["summary"] = Json::parse(json);
  OutputFile file(path);
  file.write(record.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  file.finish();
}

std::optional<CaseResult> read_record(const std::filesystem::path& path, const BatchCase& of,
                                      const std::vector<SubjectFile>& inputs) {
  const Json record = Json::parse(text_of_file(path), nullptr, false);
  if (!record.is_object()) return std::nullopt;
  const Json expected = identity(of, inputs);
  for (const auto& [key, value] : expected.items()) {
    if (!record.contains(key) || record[key] != value) return std::nullopt;
  }
  if (!record.contains("outcome") || !record.contains("summary") || !record["summary"].is_object()) return std::nullopt;
  for (const CaseOutcome outcome : {CaseOutcome::verified, CaseOutcome::wide}) {
    if (record["outcome"] != std::string(to_string(outcome))) continue;
    CaseResult result = result_in(record["summary"], outcome);
    result.seconds = end_in(record, "seconds", 0.0);
    return result;
  }
  return std::nullopt;
}

namespace {

/// A text of others: spreadsheets take one that begins with certain signs for a formula, which a quote before it ends.
std::string csv_field(const std::string& text) {
  const bool is_formula = text.find_first_of("=+-@\t\r") == 0;
  const std::string line = std::string(is_formula ? "'" : "") + on_one_line(text);
  if (line.find_first_of(",\"") == std::string::npos) return line;
  std::string field = "\"";
  for (const char c : line) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
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

namespace {

constexpr std::string_view style = R"(
body{margin:0 auto;max-width:1240px;background:var(--paper);color:var(--ink);
font:15px/1.45 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans","DejaVu Sans",sans-serif}
header,main{padding:14px 20px 4px}
h1{margin:0 0 2px;font-size:22px;overflow-wrap:anywhere}
h2{margin:0 0 6px;font-size:18px}
header p{margin:0;color:var(--muted);max-width:110ch}
section{background:var(--panel);border-radius:10px;box-shadow:var(--shadow);padding:14px 16px;margin-bottom:14px;overflow-x:auto}
table{border-collapse:collapse;width:100%}
th,td{text-align:left;padding:3px 10px 3px 0;border-bottom:1px solid var(--line);vertical-align:top}
th{color:var(--muted);font-weight:600}
td.number,th.number{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.failed{color:var(--warn);font-weight:600}.wide{color:var(--warn)}.verified{color:var(--good)}
svg{display:block;width:100%;height:auto;max-height:260px}
svg line{stroke:var(--line)}svg rect,svg circle{fill:var(--accent)}svg .failed{fill:var(--warn)}svg text{fill:var(--muted);font-size:12px}
)";

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : on_one_line(text)) {
    switch (c) {
      case '<': html += "&lt;"; break;
      case '>': html += "&gt;"; break;
      case '&': html += "&amp;"; break;
      case '"': html += "&quot;"; break;
      default: html += c;
    }
  }
  return html;
}

std::string units_of(const CaseResult& result) {
  return escaped(units_behind(result.units));
}

/// Failures first, then the nearest: the cases that need attention stand on top.
std::vector<std::size_t> order_of(std::span<const CaseResult> results) {
  std::vector<std::size_t> order(results.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto rank = [&](std::size_t i) {
    const CaseResult& result = results[i];
    if (result.outcome == CaseOutcome::failed) return std::tuple(0, std::string(), 0.0);
    if (result.outcome == CaseOutcome::not_run) return std::tuple(3, std::string(), 0.0);
    return result.smallest ? std::tuple(1, result.units, result.smallest->lo) : std::tuple(2, std::string(), 0.0);
  };
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  return order;
}

/// The proven minima of all cases with bounded ones, from the smallest to the largest: a bar from lo to hi each.
std::string chart_of(std::span<const BatchCase> cases, std::span<const CaseResult> results,
                     const std::vector<std::size_t>& order) {
  constexpr double width = 1180.0;
  constexpr double height = 220.0;
  constexpr double margin = 60.0;
  std::vector<std::size_t> shown;
  for (const std::size_t i : order) {
    const auto& smallest = results[i].smallest;
    if (smallest && std::isfinite(smallest->lo) && std::isfinite(smallest->hi)) shown.push_back(i);
  }
  if (shown.empty()) return "<p>There are none.</p>";
  if (!totals_of(results).same_units) return "<p>Not drawn: the cases have several units.</p>";
  double least = 0.0;  // contact belongs into every such picture
  double most = 0.0;
  for (const std::size_t i : shown) {
    least = std::min(least, results[i].smallest->lo);
    most = std::max(most, results[i].smallest->hi);
  }
  const double span = most > least ? most - least : 1.0;
  const auto y = [&](double value) { return height - 10.0 - (value - least) / span * (height - 20.0); };
  const double step = (width - margin) / static_cast<double>(shown.size());
  std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"Proven minima\">", width, height);
  for (const double value : {least, 0.0, most}) {
    svg += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", margin, width, y(value), y(value));
    svg += fmt::format("<text x=\"0\" y=\"{:.1f}\">{:.4g}</text>", y(value) + 4.0, value);
  }
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const Enclosure& smallest = *results[shown[k]].smallest;
    const double top = y(smallest.hi);
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"><title>{}: {}</title></rect>",
        margin + static_cast<double>(k) * step, top - 1.5, std::max(1.0, 0.7 * step),
        std::max(3.0, y(smallest.lo) - top + 3.0), escaped(cases[shown[k]].name), escaped(outward_digits(smallest)));
  }
  return svg + "</svg>";
}

std::string row_of(const BatchCase& of, const CaseResult& result) {
  std::string row = fmt::format("<tr><td>{}</td><td>{}</td><td class=\"{}\">{}</td>", escaped(of.name),
                                escaped(of.command), to_string(result.outcome), to_string(result.outcome));
  row += fmt::format("<td class=\"number\">{}</td>",
                     result.smallest ? escaped(outward_digits(*result.smallest)) + units_of(result) : std::string());
  row += fmt::format("<td class=\"number\">{}</td><td class=\"number\">{}</td>",
                     result.rows ? std::to_string(*result.rows) : "",
                     result.wide_rows ? std::to_string(*result.wide_rows) : "");
  row += fmt::format("<td class=\"number\">{:.3g}</td><td>{}</td></tr>\n", result.seconds, escaped(result.message));
  return row;
}

std::string statement_of(std::span<const CaseResult> results) {
  const BatchTotals totals = totals_of(results);
  std::string text = fmt::format("{} cases: {} verified, {} wide, {} failed", results.size(), totals.verified,
                                 totals.wide, totals.failed);
  if (totals.not_run > 0) text += fmt::format(", {} not run", totals.not_run);
  return text + ". The smallest distances are proven: each interval contains the exact one of its case.";
}

}  // namespace

void write_page(const std::filesystem::path& path, const std::string& title, std::span<const BatchCase> cases,
                std::span<const CaseResult> results) {
  const std::vector<std::size_t> order = order_of(results);
  OutputFile file(path);
  file.write("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
  // Nothing is fetched, and nothing runs.
  file.write(R"(<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">)");
  file.write(R"(<meta name="viewport" content="width=device-width, initial-scale=1">)");
  file.write("\n<meta name=\"generator\" content=\"verisq\">\n");
  file.write(fmt::format("<title>{}</title>\n<style>", escaped(title)));
  file.write(report::theme_style());
  file.write(style);
  file.write(fmt::format("</style>\n</head>\n<body>\n<header><h1>{}</h1>\n<p>{}</p></header>\n<main>\n", escaped(title),
                         statement_of(results)));
  file.write(fmt::format("<section><h2>Proven minima</h2>{}</section>\n", chart_of(cases, results, order)));
  file.write(
      "<section><h2>Cases</h2><p>Failures first, then from the nearest on, units by "
      "units.</p>\n<table><thead><tr><th>case</th>"
      "<th>command</th><th>outcome</th><th class=\"number\">smallest distance</th><th class=\"number\">rows</th>"
      "<th class=\"number\">wide</th><th class=\"number\">seconds</th><th>message</th></tr></thead>\n<tbody>\n");
  for (const std::size_t i : order) file.write(row_of(cases[i], results[i]));
  file.write("</tbody></table></section>\n</main>\n</body>\n</html>\n");
  file.finish();
}

}  // namespace verisq::command_line
