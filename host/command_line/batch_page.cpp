/// The overview of a cohort as a page: rendered here, without a script.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "host/command_line/batch_tables.hpp"
#include "host/command_line/directed_digits.hpp"
#include "host/files/output_file.hpp"
#include "report/page_template.hpp"

namespace verisq::command_line {
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
  for (const char c : text) {
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
  return result.units.empty() ? std::string() : fmt::format(" {}", escaped(result.units));
}

/// Failures first, then the nearest: what has to be looked at stands on top.
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
