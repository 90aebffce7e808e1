/// The tables of a cohort: one for programs, one with all that is known, and a page for people.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "host/command_line/batch_manifest.hpp"
#include "host/command_line/batch_record.hpp"

namespace verisq::command_line {

/// How many cases there are of each outcome, and the least of all proven minima.
struct BatchTotals {
  std::size_t verified = 0;
  std::size_t wide = 0;
  std::size_t failed = 0;
  std::size_t not_run = 0;
  bool same_units = true;                   ///< of all cases with a smallest distance: only then they are compared
  std::optional<std::size_t> nearest = {};  ///< the case with the smallest upper end
};

[[nodiscard]] BatchTotals totals_of(std::span<const CaseResult> results);

/// `case,command,outcome,lo,hi,rows,wide_rows,largest_width,units,message`: the same bytes whenever the answers are.
void write_csv_table(const std::filesystem::path& path, std::span<const BatchCase> cases,
                     std::span<const CaseResult> results);

/// The same and times, as `verisq-batch/1`.
[[nodiscard]] std::string json_table(std::span<const BatchCase> cases, std::span<const CaseResult> results,
                                     bool interrupted);
void write_json_table(const std::filesystem::path& path, const std::string& json);

/// One file that any browser opens without a network.
void write_page(const std::filesystem::path& path, const std::string& title, std::span<const BatchCase> cases,
                std::span<const CaseResult> results);

}  // namespace verisq::command_line
