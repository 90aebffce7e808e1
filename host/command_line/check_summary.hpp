/// The summary of a checked map on the standard output: for people, or as one JSON object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/json_value.hpp"

namespace verisq::command_line {

/// An enclosure and what became of it.
struct CheckedRow {
  std::uint64_t index;
  std::variant<Point, Triangle> element;
  Enclosure claimed;
  Finding finding;
};

struct CheckReport {
  MapElements elements;
  std::string map;    ///< its file
  std::string units;  ///< of the model; empty when not given
  std::uint64_t proved = 0;
  std::uint64_t refuted = 0;
  std::uint64_t unproved = 0;
  std::uint64_t missing = 0;               ///< points or triangles without a row, in what an ended run left
  double largest_width = 0.0;              ///< of the proved enclosures
  Enclosure smallest{infinity, infinity};  ///< what all rows so far prove of the smallest distance
  std::optional<CheckedRow> first;         ///< the first refuted row; without one, the first unproved
  std::optional<MapDifference> falsified;  ///< something else that the map shows, and that is not so
  double seconds = 0.0;                    ///< wall time from the first row to the last
  bool interrupted = false;

  [[nodiscard]] std::uint64_t rows() const { return proved + refuted + unproved; }
  [[nodiscard]] bool all_proved() const { return refuted + unproved + missing == 0 && !falsified; }
};

/// Adds a row, in any order.
void count(const CheckedRow& row, CheckReport& report);

/// "proved", "refuted", "unproved".
[[nodiscard]] const char* name_of(Verdict verdict);

/// How many claims became what.
struct VerdictCounts {
  std::size_t proved = 0;
  std::size_t refuted = 0;
  std::size_t unproved = 0;

  [[nodiscard]] std::size_t all() const { return proved + refuted + unproved; }
  [[nodiscard]] bool are_all_proved() const { return refuted + unproved == 0; }
};

/// Of anything with findings.
template <class Claims, class FindingOf>
[[nodiscard]] VerdictCounts counted(const Claims& claims, const FindingOf& finding_of) {
  VerdictCounts counts;
  for (const auto& claim : claims) {
    switch (std::invoke(finding_of, claim).verdict) {
      case Verdict::proved: ++counts.proved; break;
      case Verdict::refuted: ++counts.refuted; break;
      case Verdict::unproved: ++counts.unproved; break;
    }
  }
  return counts;
}

/// A line each, under a line of all `claims`.
[[nodiscard]] std::string verdicts_in_words(std::string_view claims, const VerdictCounts& counts);

/// Which end is wrong or open, and why. Precondition: not proved.
[[nodiscard]] std::string reason(const Enclosure& claimed, const Finding& finding);

/// 17 significant digits give back the same binary64.
[[nodiscard]] std::string exact_text(const Enclosure& enclosure);

/// How many rows, and how many of each verdict: a line each.
[[nodiscard]] std::string verdicts_in_words(const CheckReport& report);

/// Of the first refuted or unproved row.
[[nodiscard]] std::string readable(const CheckedRow& row, MapElements elements);
[[nodiscard]] JsonObject object_of(const CheckedRow& row, MapElements elements);

[[nodiscard]] std::string readable(const CheckReport& report);

/// JSON has no infinity: an unbounded end of an enclosure is null.
[[nodiscard]] JsonObject object_of(const CheckReport& report);
/// One line.
[[nodiscard]] std::string json(const CheckReport& report);

}  // namespace verisq::command_line
