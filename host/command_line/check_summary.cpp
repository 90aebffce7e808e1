/// The two forms of the summary.
#include "host/command_line/check_summary.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/command_line/element_words.hpp"
#include "host/command_line/progress_bar.hpp"

namespace verisq::command_line {
namespace {

double rows_per_second(const CheckReport& report) {
  return report.seconds > 0.0 ? static_cast<double>(report.rows()) / report.seconds : 0.0;
}

std::string digits_of(const Point& point) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g})", point[0], point[1], point[2]);
}

std::string digits_of(const Triangle& triangle) {
  return fmt::format("{}, {}, {}", digits_of(triangle[0]), digits_of(triangle[1]), digits_of(triangle[2]));
}

std::string readable(const MapDifference& falsified) {
  const auto place = falsified.index ? fmt::format(", index {}", *falsified.index) : std::string();
  return fmt::format("falsified {}{}\n  shown              {}\n  expected           {}\n", falsified.array, place,
                     falsified.shown, falsified.expected);
}

JsonObject object_of(const MapDifference& falsified) {
  return {{"array", falsified.array},
          {"index", falsified.index},
          {"shown", falsified.shown},
          {"expected", falsified.expected}};
}

/// Of all rows, or of none; and not of a map that is another one's.
bool tells_smallest(const CheckReport& report) {
  return report.missing == 0 && report.refuted == 0 && !report.interrupted && std::isfinite(report.smallest.width());
}

bool comes_first(const CheckedRow& a, const CheckedRow& b) {
  const bool a_refuted = a.finding.verdict == Verdict::refuted;
  const bool b_refuted = b.finding.verdict == Verdict::refuted;
  return a_refuted != b_refuted ? a_refuted : a.index < b.index;
}

}  // namespace

void count(const CheckedRow& row, CheckReport& report) {
  report.smallest = {std::min(report.smallest.lo, row.finding.proven.lo),
                     std::min(report.smallest.hi, row.finding.proven.hi)};
  switch (row.finding.verdict) {
    case Verdict::proved: ++report.proved; break;
    case Verdict::refuted: ++report.refuted; break;
    case Verdict::unproved: ++report.unproved; break;
  }
  if (row.finding.verdict == Verdict::proved) {
    report.largest_width = std::max(report.largest_width, row.claimed.width());
  } else if (!report.first || comes_first(row, *report.first)) {
    report.first = row;
  }
}

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::proved: return "proved";
    case Verdict::refuted: return "refuted";
    case Verdict::unproved: break;
  }
  return "unproved";
}

std::string verdicts_in_words(std::string_view claims, const VerdictCounts& counts) {
  std::string text = fmt::format("{:<21}{}\n", claims, counts.all());
  text += fmt::format("  {:<19}{}\n", name_of(Verdict::proved), counts.proved);
  text += fmt::format("  {:<19}{}\n", name_of(Verdict::refuted), counts.refuted);
  return text + fmt::format("  {:<19}{}\n", name_of(Verdict::unproved), counts.unproved);
}

std::string reason(const Enclosure& claimed, const Finding& finding) {
  const Enclosure& proven = finding.proven;
  if (finding.verdict == Verdict::refuted) {
    if (claimed.lo > claimed.hi) return "lo is above hi: no number lies between them";
    if (proven.lo > claimed.hi) return fmt::format("hi is wrong: the exact distance is at least {:.17g}", proven.lo);
    return fmt::format("lo is wrong: the exact distance is at most {:.17g}", proven.hi);
  }
  const bool lo_open = proven.lo < claimed.lo;
  const bool hi_open = proven.hi > claimed.hi;
  if (lo_open && hi_open) return "the certificate proves neither lo nor hi";
  return fmt::format("the certificate does not prove {}", lo_open ? "lo" : "hi");
}

std::string exact_text(const Enclosure& enclosure) {
  return fmt::format("[{:.17g}, {:.17g}]", enclosure.lo, enclosure.hi);
}

std::string verdicts_in_words(const CheckReport& report) {
  return fmt::format("{:<21}{}\n", plural(report.elements), report.rows()) +
         fmt::format("  proved             {}\n", report.proved) +
         fmt::format("  refuted            {}\n", report.refuted) +
         fmt::format("  unproved           {}\n", report.unproved);
}

std::string readable(const CheckedRow& row, MapElements elements) {
  const auto position = std::visit([](const auto& element) { return digits_of(element); }, row.element);
  auto text = fmt::format("first {} {}, index {}, at {}: {}\n", name_of(row.finding.verdict), singular(elements),
                          row.index, position, reason(row.claimed, row.finding));
  text += fmt::format("  claimed            {}\n", exact_text(row.claimed));
  text += fmt::format("  proven             {}\n", exact_text(row.finding.proven));
  return text;
}

JsonObject object_of(const CheckedRow& row, MapElements elements) {
  return {{"verdict", name_of(row.finding.verdict)},
          {"index", row.index},
          {singular(elements), std::visit([](const auto& element) { return JsonValue(element); }, row.element)},
          {"claimed", row.claimed},
          {"proven", row.finding.proven},
          {"reason", reason(row.claimed, row.finding)}};
}

std::string readable(const CheckReport& report) {
  const auto units = report.units.empty() ? std::string() : " " + report.units;
  std::string text = verdicts_in_words(report);
  if (report.missing > 0) text += fmt::format("  missing            {} (the map ends before)\n", report.missing);
  if (report.proved > 0) text += fmt::format("largest width proved {:.3g}{}\n", report.largest_width, units);
  if (tells_smallest(report)) {
    const bool meets = report.elements == MapElements::triangles && report.smallest.hi == 0.0;
    text += fmt::format("smallest distance    {}{} of these {}{}, proved\n", exact_text(report.smallest), units,
                        plural(report.elements), meets ? ", of which one meets the model" : "");
  }
  text += fmt::format("time                 {:.3g} s, {} {}/s\n", report.seconds, with_prefix(rows_per_second(report)),
                      plural(report.elements));
  text += fmt::format("map                  {}{}\n", report.map, report.interrupted ? " (interrupted)" : "");
  if (report.first) text += readable(*report.first, report.elements);
  if (report.falsified) text += readable(*report.falsified);
  return text;
}

JsonObject object_of(const CheckReport& report) {
  return {
      {plural(report.elements), report.rows()},
      {"proved", report.proved},
      {"refuted", report.refuted},
      {"unproved", report.unproved},
      {"missing", report.missing},
      {"largest_width_proved", report.largest_width},
      {"smallest_distance_proved", tells_smallest(report) ? JsonValue(report.smallest) : JsonValue()},
      {"units", report.units},
      {"seconds", report.seconds},
      {fmt::format("{}_per_second", plural(report.elements)), rows_per_second(report)},
      {"interrupted", report.interrupted},
      {"map", report.map},
      {"first", report.first ? object_of(*report.first, report.elements) : JsonValue()},
      {"falsified", report.falsified ? object_of(*report.falsified) : JsonValue()},
  };
}

std::string json(const CheckReport& report) {
  return object_of(report).text() + "\n";
}

}  // namespace verisq::command_line
